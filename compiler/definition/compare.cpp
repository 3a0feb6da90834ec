#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/definition/compare.hpp>
#include <titop/graph/declared.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/name_order.hpp>
#include <titop/graph/paths.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// Floor of sizes, relative to neighbours: a 0 in 32 digits may be 1e-26, which is then 1e-8 of
/// this, the limit; in double it is 1e-17.
constexpr double kFinest = 1e-18;

using linalg::at;

/// The largest entry of every block, blocks x blocks.
MatrixXd by_block(const MatrixXd& m, const Measure& by) {
  MatrixXd result(static_cast<Index>(by.rows.size()), static_cast<Index>(by.cols.size()));
  for (Index i = 0, r = 0; i < result.rows(); r += by.rows[at(i++)])
    for (Index j = 0, c = 0; j < result.cols(); c += by.cols[at(j++)])
      result(i, j) = m.block(r, c, by.rows[at(i)], by.cols[at(j)]).maxCoeff();
  return result;
}

MatrixXd largest(const std::vector<MatrixXcd>& list) {
  MatrixXd result = MatrixXd::Zero(list.front().rows(), list.front().cols());
  for (const MatrixXcd& G : list) result = result.cwiseMax(G.cwiseAbs());
  return result;
}

MatrixXd block_sizes(const std::vector<MatrixXcd>& exact, const Measure& by) {
  const MatrixXd size = by_block(largest(exact), by);
  return by.terms.size() > 0 ? size.cwiseMax(kLeastSize * by_block(by.terms, by)) : size;
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

/// A residue of a 0 in 32 or 50 digits counts as one: of blocks that are 0 in the other transfers.
void forgive_zeros(const MatrixXd& other, MatrixXd& size) {
  const Eigen::VectorXd output = size.rowwise().maxCoeff();
  const Eigen::RowVectorXd input = size.colwise().maxCoeff();
  for (Index i = 0; i < size.rows(); ++i)
    for (Index j = 0; j < size.cols(); ++j)
      if (other(i, j) == 0)
        size(i, j) = std::max(size(i, j), kFinest * std::max(output(i), input(j)));
}

}  // namespace

Measure measure(const Graph& graph, MatrixXd terms) {
  return {blocks(graph.outputs), blocks(graph.inputs), std::move(terms)};
}

std::vector<MatrixXcd> transfers(const StateSpace& m,
                                 const std::vector<std::complex<double>>& points) {
  const MatrixXcd there = paths(m).cast<std::complex<double>>();
  std::vector<MatrixXcd> list;
  for (const std::complex<double> s : points) list.push_back(m.transfer(s).cwiseProduct(there));
  return list;
}

std::vector<MatrixXcd> refined_transfers(const StateSpace& model,
                                         const std::vector<std::complex<double>>& points) {
  const StateSpace m = states_by_name(model);
  const MatrixXcd there = paths(m).cast<std::complex<double>>();
  std::vector<MatrixXcd> list;
  for (const std::complex<double> s : points) {
    const linalg::Solution y = linalg::refined_response(m.A, m.B, m.C, m.D, s);
    if (!(y.rcond > 0) || !y.z.allFinite())
      throw Error(Code::singular, fmt::format("s = {}{:+}j is a pole", s.real(), s.imag()),
                  "evaluate at another s");
    list.push_back(y.z.cwiseProduct(there));
  }
  return list;
}

namespace {

/// |s I - A|, |(s I - A)^-1 B| and |C (s I - A)^-1|.
struct ResolventGain {
  MatrixXd size, of_states, to_outputs;
};

ResolventGain gain(const StateSpace& m, std::complex<double> s) {
  const MatrixXcd K = s * MatrixXcd::Identity(m.A.rows(), m.A.rows()) - m.A;
  return {K.cwiseAbs(), linalg::solve(K, m.B.cast<std::complex<double>>()).z.cwiseAbs(),
          linalg::solve(K.transpose(), m.C.transpose().cast<std::complex<double>>())
              .z.transpose()
              .cwiseAbs()};
}

}  // namespace

MatrixXd terms(const StateSpace& model, const std::vector<std::complex<double>>& points) {
  const StateSpace m = states_by_name(model);
  MatrixXd result = m.D.cwiseAbs();
  if (m.A.rows() == 0) return result;
  for (const std::complex<double> s : points) {
    const ResolventGain by = gain(m, s);
    if (by.of_states.size() == 0 || by.to_outputs.size() == 0) continue;  // a pole, or no ports
    const MatrixXd right = by.size * by.of_states, sum = by.to_outputs * right;
    if (sum.allFinite()) result = result.cwiseMax(m.D.cwiseAbs() + sum);
  }
  return result;
}

MatrixXd of_nothing(const MatrixXd& terms, const std::vector<MatrixXcd>& exact) {
  const MatrixXd size = largest(exact);
  const MatrixXd around = size.rowwise().maxCoeff().cwiseSqrt() *
                          Eigen::RowVectorXd(size.colwise().maxCoeff().cwiseSqrt());
  const double limit = kSixDigits / linalg::kEpsilon;
  return (around.array() == 0 || terms.array() <= limit * around.array()).select(terms, 0);
}

MatrixXd terms_of_rounding(const StateSpace& m, const StateSpace& rounding,
                           const std::vector<std::complex<double>>& points) {
  MatrixXd result = rounding.D;
  for (const std::complex<double> s : points) {
    if (m.A.rows() == 0) break;
    const ResolventGain by = gain(m, s);
    const MatrixXd states = rounding.B + rounding.A * by.of_states,
                   sum = by.to_outputs * states + rounding.C * by.of_states;
    if (sum.allFinite()) result = result.cwiseMax(rounding.D + sum);
  }
  return of_nothing(result / linalg::kEpsilon, refined_transfers(m, points));
}

void add_rounding(Measure& measure, const std::vector<MatrixXcd>& exact, const MatrixXd& terms) {
  if (measure.terms.size() == 0) measure.terms = MatrixXd::Zero(terms.rows(), terms.cols());
  const MatrixXd size = by_block(largest(exact), measure),
                 rounding = by_block(terms, measure) / kTermsPerRounding;
  const Eigen::VectorXd output = size.rowwise().maxCoeff().cwiseSqrt();
  const Eigen::RowVectorXd input = size.colwise().maxCoeff().cwiseSqrt();
  for (Index i = 0, r = 0; i < size.rows(); r += measure.rows[at(i++)])
    for (Index j = 0, c = 0; j < size.cols(); c += measure.cols[at(j++)]) {
      if (size(i, j) > kNoise * rounding(i, j)) continue;
      auto block = measure.terms.block(r, c, measure.rows[at(i)], measure.cols[at(j)]);
      block = block.cwiseMax(terms.block(r, c, block.rows(), block.cols())).eval();
      if (size(i, j) == 0) block = block.cwiseMax(kLeastSize * output(i) * input(j)).eval();
    }
}

std::vector<std::complex<double>> some_of(const std::vector<std::complex<double>>& points) {
  std::vector<std::complex<double>> result;
  const std::size_t step = (points.size() + 7) / 8;  // the last one included
  for (std::size_t k = points.size(); k > 0; k -= std::min(k, step))
    result.push_back(points[k - 1]);
  return result;
}

Difference difference(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                      const Measure& measure) {
  Difference worst;
  if (exact.empty() || exact.front().size() == 0) return worst;
  MatrixXd size = block_sizes(exact, measure);
  forgive_zeros(by_block(largest(a), measure), size);
  for (std::size_t k = 0; k < exact.size(); ++k) {
    if (!a[k].allFinite() || !exact[k].allFinite()) return {HUGE_VAL, k};
    const MatrixXd off = by_block((a[k] - exact[k]).cwiseAbs(), measure);
    for (Index i = 0; i < off.rows(); ++i)
      for (Index j = 0; j < off.cols(); ++j)
        if (off(i, j) > worst.relative * size(i, j))
          worst = {size(i, j) > 0 ? off(i, j) / size(i, j) : HUGE_VAL, k};
  }
  return worst;
}

}  // namespace titop::detail
