#include <algorithm>
#include <titop/graph/drives.hpp>

namespace titop {

using Eigen::MatrixXd;

MatrixXd complement(const MatrixXd& S, int n) {
  if (S.rows() == 0) return MatrixXd::Identity(n, n);
  if (S.rows() >= n) return MatrixXd(0, n);
  // Take unit vectors where they are free as they stand: their zeros and ones stay exact.
  MatrixXd basis = S;
  const auto grow = [&](const Eigen::RowVectorXd& row) {
    basis.conservativeResize(basis.rows() + 1, n);
    basis.bottomRows(1) = row;
  };
  for (int i = 0; i < n && basis.rows() < n; ++i)
    if (basis.col(i).isZero(0)) grow(Eigen::RowVectorXd::Unit(n, i));
  for (int i = 0; i < n && basis.rows() < n; ++i) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Unit(n, i);
    for (int twice = 0; twice < 2; ++twice) row -= (row * basis.transpose()) * basis;
    if (row.norm() > 0.4) grow(row.normalized());  // of n unit vectors one keeps 1/sqrt(3) or more
  }
  return basis.bottomRows(n - S.rows());
}

std::vector<Drive> drives(const Graph& graph) {
  std::vector<Drive> result(graph.channels.size());
  for (int e = 0; e < static_cast<int>(graph.equations.size()); ++e) {
    const Equation& equation = graph.equations[static_cast<std::size_t>(e)];
    if (equation.target < 0 || equation.of_block) continue;
    const Signal& target = graph.signals[static_cast<std::size_t>(equation.target)];
    if (target.channel < 0) continue;
    Drive& drive = result[static_cast<std::size_t>(target.channel)];
    const Channel& channel = graph.channels[static_cast<std::size_t>(target.channel)];
    if (equation.accumulate)
      drive.added.push_back(e);
    else
      (equation.target == channel.accel ? drive.accel : drive.force).push_back(e);
  }
  for (std::size_t c = 0; c < result.size(); ++c) {
    const int n = graph.channels[c].size;
    std::vector<int>& accel = result[c].accel;
    const auto part = [&](int e) -> const Part& {
      return graph.equations[static_cast<std::size_t>(e)].part;
    };
    if (accel.empty() || part(accel.front()).whole()) {  // by far the most
      (accel.empty() ? result[c].N : result[c].S).setIdentity(n, n);
      (accel.empty() ? result[c].S : result[c].N).resize(0, n);
      continue;
    }
    // The basis must not depend on the order in which the parts were written.
    std::stable_sort(accel.begin(), accel.end(),
                     [&](int a, int b) { return part(a).name < part(b).name; });
    MatrixXd& S = result[c].S;
    S.resize(0, n);
    for (const int e : accel) {
      const MatrixXd rows = part(e).whole() ? MatrixXd::Identity(n, n) : part(e).rows;
      S.conservativeResize(S.rows() + rows.rows(), n);
      S.bottomRows(rows.rows()) = rows;
    }
    result[c].N = complement(S, n);
  }
  return result;
}

}  // namespace titop
