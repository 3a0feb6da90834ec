#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <titop/blocks/fe/coordinate_systems.hpp>

namespace titop::fe::detail {

namespace {

constexpr std::size_t kMostNested = 1000;  ///< the search is recursive

}  // namespace

const Axes* CoordinateSystems::find(int id, std::string& why) {
  if (const auto known = found_.find(id); known != found_.end()) return &known->second;
  const auto at = rectangular.find(id);
  if (at == rectangular.end()) {
    const auto other = others.find(id);
    why = other == others.end() ? fmt::format("coordinate system {}, which is not there", id)
                                : fmt::format("coordinate system {}, a {}", id, other->second);
    return nullptr;
  }
  const Cord2r& card = at->second;
  if (!open_.insert(id).second) {
    why = fmt::format("coordinate system {}, which refers to itself", id);
    return nullptr;
  }
  if (open_.size() > kMostNested) {
    open_.erase(id);
    why = fmt::format("coordinate system {}, behind {} others in each other", id, kMostNested);
    return nullptr;
  }
  const Axes* in = find(card.in, why);
  open_.erase(id);
  if (!in) return nullptr;
  const Vector3d z = (card.B - card.A).normalized(), y = z.cross(card.C - card.A).normalized();
  if (!(std::abs(y.norm() - 1) < 1e-6 && std::abs(z.norm() - 1) < 1e-6)) {
    why = fmt::format("coordinate system {}, whose three points are on a line", id);
    return nullptr;
  }
  Axes axes;
  axes.origin = in->origin + in->columns * card.A;
  axes.columns << in->columns * y.cross(z), in->columns * y, in->columns * z;
  return &(found_[id] = axes);
}

Grid placed_grid(int id, const Vector3d& point, const Axes& in, const Axes& moves) {
  const bool turned = moves.columns != Matrix3d::Identity();
  return {id,
          in.origin + in.columns * point,
          turned ? Rotation::matrix(moves.columns) : Rotation(),
          {}};
}

}  // namespace titop::fe::detail
