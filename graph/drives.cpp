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
    MatrixXd& S = result[c].S;
    // The basis must not depend on the order in which the parts were written.
    std::stable_sort(result[c].accel.begin(), result[c].accel.end(), [&](int a, int b) {
      return graph.equations[static_cast<std::size_t>(a)].part.name <
             graph.equations[static_cast<std::size_t>(b)].part.name;
    });
    S.resize(0, n);
    for (const int e : result[c].accel) {
      const Part& part = graph.equations[static_cast<std::size_t>(e)].part;
      const MatrixXd rows = part.whole() ? MatrixXd::Identity(n, n) : part.rows;
      S.conservativeResize(S.rows() + rows.rows(), n);
      S.bottomRows(rows.rows()) = rows;
    }
    result[c].N = complement(S, n);
  }
  return result;
}

}  // namespace titop
