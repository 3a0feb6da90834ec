#pragma once

#include "generate/plan.hpp"
#include "generate/table.hpp"

/// The data of a plan as tables of any exact scalar.
namespace titop::generate {

template <class S>
Table<S> table(const RatioMatrix& rows, std::size_t cols) {
  Table<S> t(rows.size(), cols);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < cols; ++j) t(i, j) = exactly<S>(rows[i][j]);
  return t;
}

template <class S>
Table<S> table(const Mat3& M) {
  Table<S> t(3, 3);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) t(i, j) = exactly<S>(M[i][j]);
  return t;
}

template <class S>
Table<S> row(const Vec3& v) {
  Table<S> t(1, 3);
  for (std::size_t j = 0; j < 3; ++j) t(0, j) = exactly<S>(v[j]);
  return t;
}

/// diag(T, T).
template <class S>
Table<S> dual(const Mat3& T) {
  Table<S> t(6, 6);
  t.add(table<S>(T));
  t.add(table<S>(T), 3, 3);
  return t;
}

/// tau_CP: motion of a rigid body at C per unit motion of P; PC from P to C.
template <class S>
Table<S> tau(const Vec3& PC) {
  Table<S> t = identity<S>(6);
  t.add(table<S>(cross(-PC)), 0, 3);
  return t;
}

/// The rows of a part, part x size of the point.
template <class S>
Table<S> part_rows(const PlannedPart& part, std::size_t size) {
  if (size == 1 || part.kind == PlannedPart::Kind::all) return identity<S>(size);
  Table<S> t(part.kind == PlannedPart::Kind::linear ? 3 : 1, 6);
  t.add(part.kind == PlannedPart::Kind::linear ? identity<S>(3) : row<S>(part.direction));
  return t;
}

}  // namespace titop::generate
