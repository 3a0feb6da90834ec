#include <titop/graph/paths.hpp>
#include <vector>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd paths(const MatrixXd& A, const MatrixXd& B) {
  MatrixXd result = MatrixXd::Zero(B.rows(), B.cols());
  std::vector<Index> next;
  for (Index j = 0; j < B.cols(); ++j) {
    const auto reach = [&](const auto& column) {
      for (Index i = 0; i < B.rows(); ++i)
        if (column(i) != 0 && result(i, j) == 0) result(i, j) = 1, next.push_back(i);
    };
    reach(B.col(j));
    while (!next.empty()) {
      const Index k = next.back();
      next.pop_back();
      reach(A.col(k));
    }
  }
  return result;
}

MatrixXd paths(const StateSpace& m) {
  const MatrixXd moved = paths(m.A, m.B);
  MatrixXd result(m.D.rows(), m.D.cols());
  for (Index j = 0; j < result.cols(); ++j)
    for (Index i = 0; i < result.rows(); ++i)
      result(i, j) =
          m.D(i, j) != 0 || (m.C.row(i).transpose().array() * moved.col(j).array() != 0).any();
  return result;
}

}  // namespace titop
