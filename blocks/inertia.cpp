#include <fmt/format.h>

#include <algorithm>
#include <titop/blocks/inertia.hpp>
#include <titop/graph/error.hpp>

namespace titop {
namespace {

using InertiaEntries = std::array<Value, 6>;

/// The symmetric matrix of these entries; number(value) converts a value.
template <class Number>
Matrix3d matrix_of(const InertiaEntries& entries, Number number) {
  const auto& [xx, yy, zz, xy, xz, yz] = entries;
  Matrix3d I;
  I << number(xx), number(xy), number(xz), number(xy), number(yy), number(yz), number(xz),
      number(yz), number(zz);
  return I;
}

}  // namespace

void Inertia::check_size(Eigen::Index rows, Eigen::Index cols) {
  if (rows != 3 || cols != 3)
    throw Error(Code::size, fmt::format("an inertia of {} x {}", rows, cols),
                "give a 3 x 3 matrix, or {xx, yy, zz, xy, xz, yz}");
}

Inertia::Inertia(Value xx, Value yy, Value zz, Value xy, Value xz, Value yz) {
  const InertiaEntries entries{xx, yy, zz, xy, xz, yz};
  matrix_ = matrix_of(entries, [](const Value& v) { return v.nominal(); });
  const auto is_parameter = [](const Value& v) { return v.is_parameter(); };
  if (std::any_of(entries.begin(), entries.end(), is_parameter))
    entries_ = std::make_shared<const InertiaEntries>(entries);
}

Matrix3d Inertia::at(ParameterValues values) const {
  if (!entries_) return matrix_;
  return matrix_of(*entries_, [&](const Value& v) { return v.at(values); });
}

std::vector<Value> Inertia::values() const {
  return entries_ ? std::vector<Value>(entries_->begin(), entries_->end()) : std::vector<Value>{};
}

}  // namespace titop
