#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <titop/blocks/fe/coordinate_systems.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::fe::detail {

namespace {

constexpr std::size_t kMostNested = 1000;          ///< the search is recursive
constexpr double kOnAxis = 16 * linalg::kEpsilon;  ///< of a position's terms

/// x, y, z of coordinates of a kind.
Vector3d rectangular(SystemKind kind, const Vector3d& p) {
  constexpr double degree = std::numbers::pi / 180;
  const double r = p.x(), theta = degree * p.y(), phi = degree * p.z();
  switch (kind) {
    case SystemKind::rectangular: return p;
    case SystemKind::cylindrical: return {r * std::cos(theta), r * std::sin(theta), p.z()};
    case SystemKind::spherical:
      return r * Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                          std::cos(theta));
  }
  return p;
}

}  // namespace

Vector3d CoordinateSystems::Axes::position(const Vector3d& coordinates) const {
  return origin + columns * rectangular(kind, coordinates);
}

/// Unit vectors along growing coordinates, as columns.
Matrix3d CoordinateSystems::Axes::directions(const Vector3d& position) const {
  const Vector3d local = columns.transpose() * (position - origin);
  const double radius = local.head<2>().norm();
  if (kind == SystemKind::rectangular || radius <= kOnAxis * (position.norm() + origin.norm()))
    return columns;
  const Vector3d around(-local.y() / radius, local.x() / radius, 0);
  Matrix3d own;
  if (kind == SystemKind::cylindrical)
    own << around.cross(Vector3d::UnitZ()), around, Vector3d::UnitZ();
  else
    own << local.normalized(), around.cross(local.normalized()), around;
  return columns * own;
}

/// Differences are taken in the system of the points, where they are exact.
std::optional<CoordinateSystems::Corner> CoordinateSystems::by_points(const SystemCard& card,
                                                                      std::string& why) {
  const Axes* axes = find(card.in, why);
  if (!axes) return std::nullopt;
  std::array<Vector3d, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p.at(i) = rectangular(axes->kind, card.points.at(i));
  return Corner{axes->origin + axes->columns * p[0], axes->columns * (p[1] - p[0]),
                axes->columns * (p[2] - p[0])};
}

std::optional<CoordinateSystems::Corner> CoordinateSystems::by_grids(
    int id, const std::array<int, 3>& numbers, std::string& why) {
  std::array<Vector3d, 3> p;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto grid = grids.find(numbers.at(i));
    if (grid == grids.end()) {
      why = fmt::format("grid {} of coordinate system {}, which is not there", numbers.at(i), id);
      return std::nullopt;
    }
    const Axes* axes = find(grid->second.in, why);
    if (!axes) return std::nullopt;
    p.at(i) = axes->position(grid->second.point);
  }
  return Corner{p[0], p[1] - p[0], p[2] - p[0]};
}

const CoordinateSystems::Axes* CoordinateSystems::find(int id, std::string& why) {
  if (const auto known = found_.find(id); known != found_.end()) return &known->second;
  const auto at = systems.find(id);
  if (at == systems.end()) {
    const auto other = others.find(id);
    why = other == others.end() ? fmt::format("coordinate system {}, which is not there", id)
                                : fmt::format("coordinate system {}, a {}", id, other->second);
    return nullptr;
  }
  if (!open_.insert(id).second) {
    why = fmt::format("coordinate system {}, which refers to itself", id);
    return nullptr;
  }
  if (open_.size() > kMostNested) {
    open_.erase(id);
    why = fmt::format("coordinate system {}, behind {} others in each other", id, kMostNested);
    return nullptr;
  }
  const SystemCard& card = at->second;
  const auto corner = card.grids ? by_grids(id, *card.grids, why) : by_points(card, why);
  open_.erase(id);
  if (!corner) return nullptr;
  const Vector3d z = corner->AB.normalized(), normal = z.cross(corner->AC.normalized());
  if (!(normal.norm() > linalg::kTextDigits)) {
    why = fmt::format("coordinate system {}, whose three points are on a line", id);
    return nullptr;
  }
  const Vector3d y = normal.normalized();
  Axes axes{card.kind, corner->A, Matrix3d()};
  axes.columns << y.cross(z), y, z;
  return &(found_[id] = axes);
}

std::optional<Grid> CoordinateSystems::place(int id, std::string& why) {
  const auto card = grids.find(id);
  if (card == grids.end()) {
    why = fmt::format("grid {}, which is not there", id);
    return std::nullopt;
  }
  const Axes* in = find(card->second.in, why);
  const Axes* moves = in ? find(card->second.moves, why) : nullptr;
  if (!moves) return std::nullopt;
  const Vector3d position = in->position(card->second.point);
  const Matrix3d frame = moves->directions(position);
  const bool turned = frame != Matrix3d::Identity();
  return Grid{.id = id,
              .position = position,
              .frame = turned ? Rotation::matrix(frame) : Rotation(),
              .name = {}};
}

}  // namespace titop::fe::detail
