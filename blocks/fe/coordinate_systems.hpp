#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <titop/blocks/fe/grids.hpp>

/// Coordinate systems of Nastran. For the folder's own files.
namespace titop::fe::detail {

/// Coordinates of a point: x, y, z; or r, theta, z; or r, theta (from the z axis), phi. Angles are
/// in degrees.
enum class SystemKind { rectangular, cylindrical, spherical };

/// CORD2R, CORD2C, CORD2S: `points` A (the origin), B (on the z axis) and C (in the x-z plane).
/// CORD1R, CORD1C, CORD1S: `grids` at these three points.
struct SystemCard {
  SystemKind kind = SystemKind::rectangular;
  int in = 0;                           ///< the system of the points' coordinates
  std::array<Vector3d, 3> points = {};  ///< A, B, C
  std::optional<std::array<int, 3>> grids = {};
};

/// A card GRID.
struct GridCard {
  int in = 0;  ///< the system of its coordinates
  Vector3d point = Vector3d::Zero();
  int moves = 0;  ///< the system of its displacements
};

/// Grids and the systems that they refer to; 0 is the basic system. The displacement frame of a
/// grid in a cylindrical or spherical system has the directions of its coordinates at the grid, and
/// those of the system's x, y, z on the z axis.
class CoordinateSystems {
 public:
  std::map<int, SystemCard> systems;
  std::map<int, GridCard> grids;
  std::map<int, std::string> others;  ///< names of cards of other kinds, "CORD3G"

  /// Position and displacement frame of the grid. None, with the reason in `why`, if the grid or a
  /// system is missing, is of another kind, refers to itself, or to the basic one through more than
  /// 1000 others, or if its three points are on a line.
  std::optional<Grid> place(int id, std::string& why);

 private:
  /// Origin, and axes as columns, in the basic frame.
  struct Axes {
    SystemKind kind = SystemKind::rectangular;
    Vector3d origin = Vector3d::Zero();
    Matrix3d columns = Matrix3d::Identity();

    Vector3d position(const Vector3d& coordinates) const;
    Matrix3d directions(const Vector3d& position) const;
  };
  const Axes* find(int id, std::string& why);
  /// A, and the vectors from it to B and C, in the basic frame.
  struct Corner {
    Vector3d A, AB, AC;
  };
  std::optional<Corner> by_points(const SystemCard& card, std::string& why);
  std::optional<Corner> by_grids(int id, const std::array<int, 3>& numbers, std::string& why);

  std::map<int, Axes> found_ = {{0, Axes{}}};
  std::set<int> open_;  ///< systems that are being defined
};

}  // namespace titop::fe::detail
