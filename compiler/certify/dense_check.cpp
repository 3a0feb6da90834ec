#include <algorithm>
#include <limits>
#include <titop/compiler/certify/steady_random.hpp>
#include <titop/compiler/evaluate.hpp>
#include <titop/compiler/system_data.hpp>

/// The dense model against the factors that it was written from.
namespace titop::detail {
namespace {

using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The model's states block by block: first and count.
std::vector<std::pair<int, int>> segments(const SystemData& d) {
  std::vector<std::pair<int, int>> result;
  const std::vector<int>& kept = d.states.kept();
  for (const int i : d.layout().state_nodes) {
    const int begin = d.layout().state_first[at(i)],
              end = begin + static_cast<int>(d.numbers.blocks[at(i)]->A.rows());
    const auto first = std::lower_bound(kept.begin(), kept.end(), begin);
    result.emplace_back(first - kept.begin(), std::lower_bound(first, kept.end(), end) - first);
  }
  return result;
}

}  // namespace

double dense_difference(const SystemData& d, const StateSpace& m) {
  if (m.A.size() == 0) return 0;
  SteadyRandom random;
  VectorXd x(m.A.rows()), u(m.B.cols());
  for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = random.next();
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = random.next();
  const VectorXd all = d.states.expanded(x, u);
  solve::RowMatrix<double> known(all.size() + u.size(), 1);
  known << all, u;
  const Rates exact = rates(d, known);
  VectorXd off = d.states.kept_rows(VectorXd(exact.xdot)), size = VectorXd::Zero(x.size());
  for (const auto& [matrix, vector] : {std::pair(&m.A, &x), std::pair(&m.B, &u)})
    for (Eigen::Index j = 0; j < matrix->cols(); ++j) {  // once through memory
      off -= matrix->col(j) * (*vector)(j);
      size += matrix->col(j).cwiseAbs() * std::abs((*vector)(j));
    }
  if (!off.allFinite()) return kInfinity;
  double worst = 0;
  for (const auto& [first, n] : segments(d)) {
    if (n == 0) continue;
    const double largest = size.segment(first, n).maxCoeff();
    if (largest > 0) worst = std::max(worst, off.segment(first, n).cwiseAbs().maxCoeff() / largest);
  }
  return worst;
}

DenseError dense_error(const SystemData& d, const StateSpace& m) {
  using T = std::complex<double>;
  SteadyRandom random;
  solve::RowMatrix<T> u(m.B.cols(), 1);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = {random.next(), random.next()};
  DenseError worst;
  if (u.size() == 0 || m.C.rows() == 0 || m.A.size() == 0) return worst;
  for (const double factor : {1e-4, 1e-2, 1.0, 1e2}) {
    const T s = factor * pick_s(d);
    const Evaluation<T> point(d, s, u);
    const solve::RowMatrix<T> x = d.states.model_states(point.states(), u, s);
    VectorXcd left = -s * x;
    for (Eigen::Index j = 0; j < m.A.cols(); ++j) left += m.A.col(j) * x(j);
    left += m.B * u;
    const solve::RowMatrix<T> change = point.forced(d.states.expanded(solve::RowMatrix<T>(left))),
                              y = point.outputs();
    // What C itself costs in rounding is one product: below what is looked for here.
    const double off = change.cwiseAbs().maxCoeff(), size = y.cwiseAbs().maxCoeff();
    const double error = !change.allFinite() || !y.allFinite() ? kInfinity
                         : off > 0                             ? off / size
                                                               : 0;
    if (error > worst.error) worst = {error, s};
  }
  return worst;
}

}  // namespace titop::detail
