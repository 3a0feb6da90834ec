#include <fmt/format.h>

#include <cmath>
#include <titop/compiler/definition/exact/fractions.hpp>

namespace titop::exact {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kLargestDenominator = 1000;
/// Fractions up to this denominator lie 1e-6 apart: none is as close as this by accident.
constexpr double kRounding = 4e-16;

/// The fraction of smallest denominator that rounds to x; its own value if there is none.
bool simple_fraction(double x, Fraction& result) {
  for (int q = 1; q <= kLargestDenominator; ++q) {
    const double p = std::round(x * q);
    if (std::abs(x - p / q) > kRounding) continue;
    result = Fraction(Integer(static_cast<long long>(p)), Integer(q));
    return true;
  }
  return false;
}

}  // namespace

FractionMatrix FractionMatrix::identity(Index n) {
  FractionMatrix m(n, n);
  for (Index i = 0; i < n; ++i) m(i, i) = 1;
  return m;
}

FractionMatrix FractionMatrix::transposed() const {
  FractionMatrix m(cols, rows);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < cols; ++j) m(j, i) = (*this)(i, j);
  return m;
}

FractionMatrix operator*(const FractionMatrix& a, const FractionMatrix& b) {
  FractionMatrix m(a.rows, b.cols);
  for (Index i = 0; i < a.rows; ++i)
    for (Index k = 0; k < a.cols; ++k) {
      if (a(i, k) == 0) continue;
      for (Index j = 0; j < b.cols; ++j)
        if (b(k, j) != 0) m(i, j) += a(i, k) * b(k, j);
    }
  return m;
}

FractionMatrix operator*(const Fraction& k, FractionMatrix m) {
  for (Fraction& entry : m.entries) entry *= k;
  return m;
}

FractionMatrix fractions(const MatrixXd& m) {
  if (!m.allFinite()) throw Undecided{"a number is not finite"};
  FractionMatrix result(m.rows(), m.cols());
  for (Index i = 0; i < m.rows(); ++i)
    for (Index j = 0; j < m.cols(); ++j) result(i, j) = Fraction(m(i, j));
  return result;
}

FractionMatrix orthonormal_fractions(const MatrixXd& rows, const std::string& subject) {
  FractionMatrix m(rows.rows(), rows.cols());
  bool found = true;
  for (Index i = 0; i < rows.rows(); ++i)
    for (Index j = 0; j < rows.cols(); ++j) found = found && simple_fraction(rows(i, j), m(i, j));
  if (found) {
    const FractionMatrix product = m * m.transposed(), one = FractionMatrix::identity(rows.rows());
    found = product.entries == one.entries;
  }
  if (!found)
    throw Undecided{
        fmt::format("{} has no exact fractions up to a denominator of {}: take turns of 90 degrees "
                    "or of 3-4-5 triangles",
                    subject, kLargestDenominator)};
  return m;
}

FractionMatrix exact_coefficient(const Graph& graph, const Term& term, ParameterValues values) {
  FractionMatrix result =
      FractionMatrix::identity(graph.signals[static_cast<std::size_t>(term.signal)].size);
  Fraction scale = term.sign;
  for (auto f = term.factors.rbegin(); f != term.factors.rend(); ++f) {
    if (const auto* k = std::get_if<Value>(&*f)) {
      scale *= Fraction(k->at(values));
    } else if (const auto* m = std::get_if<titop::Matrix>(&*f)) {
      result = fractions(*m->value) * result;
    } else if (const auto* p = std::get_if<Part>(&*f)) {
      if (!p->whole()) result = orthonormal_fractions(p->rows(), p->name()) * result;
    } else if (const auto& T = std::get<Rotation>(*f); !T.is_identity()) {
      const FractionMatrix turn =
          orthonormal_fractions(T.at(values), "the rotation in " + print(graph, term));
      FractionMatrix both(result.rows, result.rows);
      for (Index i = 0; i < result.rows; ++i)
        for (Index j = i / 3 * 3; j < i / 3 * 3 + 3; ++j) both(i, j) = turn(i % 3, j % 3);
      result = both * result;
    }
  }
  return scale * std::move(result);
}

}  // namespace titop::exact
