#include <algorithm>
#include <cmath>
#include <titop/compiler/compare.hpp>
#include <titop/compiler/declared.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double kCancelled = 1e-5;  ///< of the terms
constexpr double kSmall = 1e-3;      ///< of row and column

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// The largest entry of every block, blocks x blocks.
MatrixXd by_block(const MatrixXd& m, const Measure& by) {
  MatrixXd result(static_cast<Index>(by.rows.size()), static_cast<Index>(by.cols.size()));
  for (Index i = 0, r = 0; i < result.rows(); r += by.rows[at(i++)])
    for (Index j = 0, c = 0; j < result.cols(); c += by.cols[at(j++)])
      result(i, j) = m.block(r, c, by.rows[at(i)], by.cols[at(j)]).maxCoeff();
  return result;
}

MatrixXd block_sizes(const std::vector<MatrixXcd>& exact, const Measure& by) {
  MatrixXd largest = MatrixXd::Zero(exact.front().rows(), exact.front().cols());
  for (const MatrixXcd& G : exact) largest = largest.cwiseMax(G.cwiseAbs());
  MatrixXd size = by_block(largest, by);
  const MatrixXd terms = by.terms.size() > 0 ? by_block(by.terms, by) : MatrixXd(0 * size);
  // A row or a column that is 0 by nature holds nothing but rounding.
  const double all = size.maxCoeff() > 0 ? size.maxCoeff() : 1;
  const auto or_all = [all](double most) { return most > 1e-12 * all ? most : all; };
  const Eigen::VectorXd rows = size.rowwise().maxCoeff().unaryExpr(or_all),
                        cols = size.colwise().maxCoeff().unaryExpr(or_all);
  for (Index i = 0; i < size.rows(); ++i)
    for (Index j = 0; j < size.cols(); ++j) {
      const double mean = std::sqrt(rows(i)) * std::sqrt(cols(j));
      size(i, j) = std::max({size(i, j), kCancelled * terms(i, j), kSmall * mean});
    }
  return size;
}

template <class List>
std::vector<int> blocks(const List& list) {
  std::vector<int> result;
  for (const int i : as_declared(list)) {
    const int size = list[at(i)].size, each = size % 3 == 0 ? 3 : 1;
    result.insert(result.end(), at(size / each), each);
  }
  return result;
}

}  // namespace

Measure measure(const Graph& graph, MatrixXd terms) {
  return {blocks(graph.outputs), blocks(graph.inputs), std::move(terms)};
}

MatrixXd terms(const StateSpace& m, const std::vector<std::complex<double>>& points) {
  MatrixXd result = m.D.cwiseAbs();
  if (m.A.rows() == 0) return result;
  for (const std::complex<double> s : points) {
    const MatrixXcd K = s * MatrixXcd::Identity(m.A.rows(), m.A.rows()) - m.A;
    const MatrixXcd X = linalg::solve(K, m.B.cast<std::complex<double>>()).z,
                    W = linalg::solve(K.transpose(), m.C.transpose().cast<std::complex<double>>())
                            .z;
    const MatrixXd right = K.cwiseAbs() * X.cwiseAbs(), sum = W.cwiseAbs().transpose() * right;
    if (sum.allFinite()) result = result.cwiseMax(m.D.cwiseAbs() + sum);
  }
  return result;
}

Difference difference(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                      const Measure& measure) {
  Difference worst;
  if (exact.empty() || exact.front().size() == 0) return worst;
  const MatrixXd size = block_sizes(exact, measure);
  for (std::size_t k = 0; k < exact.size(); ++k) {
    if (!a[k].allFinite() || !exact[k].allFinite()) return {HUGE_VAL, k};
    const MatrixXd off = by_block((a[k] - exact[k]).cwiseAbs(), measure);
    for (Index i = 0; i < off.rows(); ++i)
      for (Index j = 0; j < off.cols(); ++j)
        if (off(i, j) > worst.relative * size(i, j)) worst = {off(i, j) / size(i, j), k};
  }
  return worst;
}

}  // namespace titop::detail
