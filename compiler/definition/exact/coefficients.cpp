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

ExactMatrix exact_coefficient(const Graph& graph, const Term& term, ParameterValues values) {
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
      const ExactMatrix turn =
          orthonormal_fractions(T.at(values), "the rotation in " + print(graph, term));
      ExactMatrix both(result.rows, result.rows);
      for (Index i = 0; i < result.rows; ++i)
        for (Index j = i / 3 * 3; j < i / 3 * 3 + 3; ++j) both(i, j) = turn(i % 3, j % 3);
      result = both * result;
    }
  }
  return scale * std::move(result);
}

}  // namespace titop::exact
