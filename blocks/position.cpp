#include <fmt/format.h>

#include <algorithm>
#include <titop/blocks/position.hpp>
#include <titop/graph/error.hpp>

namespace titop {

void Position::check_size(Eigen::Index rows, Eigen::Index cols) {
  if (rows != 3 || cols != 1)
    throw Error(Code::size, fmt::format("a position of {} x {}", rows, cols),
                "give a vector of 3, or {x, y, z}");
}

Position::Position(Value x, Value y, Value z) : vector_(x.nominal(), y.nominal(), z.nominal()) {
  if (x.is_parameter() || y.is_parameter() || z.is_parameter())
    components_ = std::make_shared<const std::array<Value, 3>>(std::array{x, y, z});
}

Vector3d Position::at(ParameterValues values) const {
  if (!components_) return vector_;
  const auto& [x, y, z] = *components_;
  return {x.at(values), y.at(values), z.at(values)};
}

std::vector<Value> Position::values() const {
  return components_ ? std::vector<Value>(components_->begin(), components_->end())
                     : std::vector<Value>{};
}

}  // namespace titop
