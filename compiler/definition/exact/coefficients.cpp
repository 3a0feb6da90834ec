#include <fmt/format.h>

#include <cmath>
#include <titop/compiler/definition/exact/coefficients.hpp>

namespace titop::exact {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kLargestDenominator = 1000;
/// Fractions up to this denominator lie 1e-6 apart: none is as close as this by accident.
constexpr double kRounding = 4e-16;

/// The fraction of smallest denominator that rounds to x; its own value if there is none.
bool simple_fraction(double x, Residue& result) {
  for (int q = 1; q <= kLargestDenominator; ++q) {
    const double p = std::round(x * q);
    if (std::abs(x - p / q) > kRounding) continue;
    result = Residue(p) * Residue(q).inverse();
    return true;
  }
  return false;
}

}  // namespace

ExactMatrix ExactMatrix::identity(Index n) {
  ExactMatrix m(n, n);
  for (Index i = 0; i < n; ++i) m(i, i) = 1;
  return m;
}

ExactMatrix ExactMatrix::transposed() const {
  ExactMatrix m(cols, rows);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < cols; ++j) m(j, i) = (*this)(i, j);
  return m;
}

ExactMatrix operator*(const ExactMatrix& a, const ExactMatrix& b) {
  ExactMatrix m(a.rows, b.cols);
  for (Index i = 0; i < a.rows; ++i)
    for (Index k = 0; k < a.cols; ++k) {
      if (a(i, k) == 0) continue;
      for (Index j = 0; j < b.cols; ++j)
        if (b(k, j) != 0) m(i, j) += a(i, k) * b(k, j);
    }
  return m;
}

ExactMatrix operator*(const Residue& k, ExactMatrix m) {
  for (Residue& entry : m.entries) entry *= k;
  return m;
}

ExactMatrix exact_matrix(const MatrixXd& m) {
  if (!m.allFinite()) throw Undecided{"a number is not finite"};
  ExactMatrix result(m.rows(), m.cols());
  for (Index i = 0; i < m.rows(); ++i)
    for (Index j = 0; j < m.cols(); ++j) result(i, j) = Residue(m(i, j));
  return result;
}

ExactMatrix orthonormal_fractions(const MatrixXd& rows, const std::string& subject) {
  ExactMatrix m(rows.rows(), rows.cols());
  bool found = true;
  for (Index i = 0; i < rows.rows(); ++i)
    for (Index j = 0; j < rows.cols(); ++j) found = found && simple_fraction(rows(i, j), m(i, j));
  if (found) {
    const ExactMatrix product = m * m.transposed(), one = ExactMatrix::identity(rows.rows());
    found = product.entries == one.entries;
  }
  if (!found)
    throw Undecided{
        fmt::format("{} has no exact fractions up to a denominator of {}: take turns of 90 degrees "
                    "or of 3-4-5 triangles",
                    subject, kLargestDenominator)};
  return m;
}

ExactMatrix nearest_rotation(const Matrix3d& T) {
  // Four times the squares of w, x, y, z; the largest is at least 1.
  const Eigen::Vector4d square(1 + T.trace(), 1 + 2 * T(0, 0) - T.trace(),
                               1 + 2 * T(1, 1) - T.trace(), 1 + 2 * T(2, 2) - T.trace());
  Index largest = 0;
  square.maxCoeff(&largest);
  Eigen::Vector4d q;  // times four times its largest entry
  if (largest == 0) {
    q << square(0), T(2, 1) - T(1, 2), T(0, 2) - T(2, 0), T(1, 0) - T(0, 1);
  } else {
    const Index i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    q(0) = T(k, j) - T(j, k);
    q(1 + i) = square(largest);
    q(1 + j) = T(i, j) + T(j, i);
    q(1 + k) = T(i, k) + T(k, i);
  }
  const Residue w(q(0)), v[3] = {Residue(q(1)), Residue(q(2)), Residue(q(3))}, two = 2;
  const Residue vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2], ww = w * w,
                inverse = (ww + vv).inverse();
  ExactMatrix R(3, 3);
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) {
      R(i, j) = two * v[i] * v[j];
      if (i == j) R(i, j) += ww - vv;
    }
  for (Index i = 0; i < 3; ++i) {  // 2 w (v x)
    const Index j = (i + 1) % 3, k = (i + 2) % 3;
    R(k, j) += two * w * v[i];
    R(j, k) -= two * w * v[i];
  }
  return inverse * std::move(R);
}

namespace {

ExactMatrix exact_rotation(const Matrix3d& T, ExactRotations rotations, const Graph& graph,
                           const Term& term) {
  try {
    return orthonormal_fractions(T, "the rotation in " + print(graph, term));
  } catch (const Undecided&) {
    if (rotations == ExactRotations::fractions) throw;
    return nearest_rotation(T);
  }
}

}  // namespace

ExactMatrix exact_coefficient(const Graph& graph, const Term& term, ParameterValues values,
                              ExactRotations rotations) {
  ExactMatrix result =
      ExactMatrix::identity(graph.signals[static_cast<std::size_t>(term.signal)].size);
  Residue scale(term.sign);
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f) {
    if (const auto* k = std::get_if<Value>(&*f)) {
      scale *= Residue(k->at(values));
    } else if (const auto* m = std::get_if<titop::Matrix>(&*f)) {
      result = exact_matrix(*m->value) * result;
    } else if (const auto* p = std::get_if<Part>(&*f)) {
      if (!p->whole()) result = orthonormal_fractions(p->rows(), p->name()) * result;
    } else if (const auto& T = std::get<Rotation>(*f); !T.is_identity()) {
      const ExactMatrix turn = exact_rotation(T.at(values), rotations, graph, term);
      ExactMatrix both(result.rows, result.rows);
      for (Index i = 0; i < result.rows; ++i)
        for (Index j = i / 3 * 3; j < i / 3 * 3 + 3; ++j) both(i, j) = turn(i % 3, j % 3);
      result = both * result;
    }
  }
  return scale * std::move(result);
}

}  // namespace titop::exact
