#include <titop/graph/paths.hpp>
#include <vector>

namespace titop {

Eigen::MatrixXd paths(const StateSpace& m) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(m.D.rows(), m.D.cols());
  std::vector<Eigen::Index> next;
  for (Eigen::Index j = 0; j < m.D.cols(); ++j) {
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(m.A.rows());
    const auto reach = [&](const auto& column) {
      for (Eigen::Index i = 0; i < moved.size(); ++i)
        if (column(i) != 0 && moved(i) == 0) moved(i) = 1, next.push_back(i);
    };
    reach(m.B.col(j));
    while (!next.empty()) {
      const Eigen::Index k = next.back();
      next.pop_back();
      reach(m.A.col(k));
    }
    for (Eigen::Index i = 0; i < m.D.rows(); ++i) {
      const bool seen = (m.C.row(i).transpose().array() * moved.array() != 0).any();
      result(i, j) = m.D(i, j) != 0 || seen;
    }
  }
  return result;
}

}  // namespace titop
