#pragma once

#include <map>
#include <set>
#include <string>
#include <titop/blocks/fe/grids.hpp>

/// Coordinate systems of Nastran. For the folder's own files.
namespace titop::fe::detail {

/// A coordinate system: its origin, and its axes as columns, in the basic frame.
struct Axes {
  Vector3d origin = Vector3d::Zero();
  Matrix3d columns = Matrix3d::Identity();
};

/// CORD2R, points in the system `in`: A the origin, B on z, C in the x-z plane.
struct Cord2r {
  int in = 0;
  Vector3d A, B, C;
};

/// Rectangular systems, each relative to another or to the basic one, 0.
class CoordinateSystems {
 public:
  std::map<int, Cord2r> rectangular;
  std::map<int, std::string> others;  ///< names of cards of other kinds, "CORD2C"

  /// Null, and the reason in `why`, for one that is not there, of another kind, that refers to
  /// itself or over more than 1000 others to the basic one, or whose points are on a line.
  const Axes* find(int id, std::string& why);

 private:
  std::map<int, Axes> found_ = {{0, Axes{}}};
  std::set<int> open_;  ///< systems that are being defined
};

/// The grid at this point of the system `in`, with displacements in the system `moves`.
Grid placed_grid(int id, const Vector3d& point, const Axes& in, const Axes& moves);

}  // namespace titop::fe::detail
