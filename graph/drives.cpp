#include <algorithm>
#include <numeric>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop {

using Eigen::MatrixXd;

MatrixXd complement(const MatrixXd& S, int n) {
  if (S.rows() == 0) return MatrixXd::Identity(n, n);
  if (S.rows() >= n) return MatrixXd(0, n);
  // Unit vectors orthogonal to S first: their zeros and ones are exact.
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

namespace {

using linalg::at;

/// In which list an equation stands: three of each channel. -1: in none.
int list_of(const Graph& graph, const Equation& e) {
  if (e.target < 0 || e.of_block) return -1;
  const int channel = graph.signals[at(e.target)].channel;
  if (channel < 0) return -1;
  if (e.accumulate) return 3 * channel + 2;
  return 3 * channel + (e.target == graph.channels[at(channel)].accel ? 0 : 1);
}

/// The directions, of n, that these equations on an acceleration leave free.
MatrixXd left_by(const Graph& graph, std::span<const int> equations, int n) {
  MatrixXd S(0, n);
  for (const int e : equations) {
    const Part& part = graph.equations[at(e)].part;
    const MatrixXd rows = part.whole() ? MatrixXd::Identity(n, n) : part.rows();
    S.conservativeResize(S.rows() + rows.rows(), n);
    S.bottomRows(rows.rows()) = rows;
  }
  return complement(S, n);
}

}  // namespace

Drives::Drives(const Graph& graph) : drives_(graph.channels.size()) {
  std::vector<int> list, begin(3 * drives_.size() + 1, 0);
  list.reserve(graph.equations.size());
  for (const Equation& e : graph.equations) {
    list.push_back(list_of(graph, e));
    if (list.back() >= 0) ++begin[at(list.back() + 1)];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  equations_.resize(at(begin.back()));
  std::vector<int> next = begin;
  for (int e = 0; e < static_cast<int>(list.size()); ++e)
    if (const int l = list[at(e)]; l >= 0) equations_[at(next[at(l)]++)] = e;
  const auto part = [&](int e) -> const Part& { return graph.equations[at(e)].part; };
  for (std::size_t c = 0; c < drives_.size(); ++c) {
    const auto of = [&](std::size_t i) {
      return std::span(equations_.data() + begin[3 * c + i],
                       equations_.data() + begin[3 * c + i + 1]);
    };
    Drive& drive = drives_[c];
    const std::span<int> accel = of(0);
    drive.accel = accel, drive.force = of(1), drive.added = of(2);
    drive.size = graph.channels[c].size;
    if (accel.empty()) {
      drive.free = drive.size;
    } else if (!part(accel.front()).whole()) {
      // The basis must not depend on the order in which the parts were written.
      std::stable_sort(accel.begin(), accel.end(),
                       [&](int a, int b) { return part(a).name() < part(b).name(); });
      drive.some = left_by(graph, accel, drive.size);
      drive.free = static_cast<int>(drive.some.rows());
    }
  }
}

}  // namespace titop
