#include "agreement.hpp"

#include <algorithm>
#include <limits>

namespace titop_bench {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

/// Not a number counts as infinitely wrong.
double larger(double a, double b) {
  return b <= a ? a : (b > a ? b : std::numeric_limits<double>::infinity());
}

double ratio(double difference, double size) {
  return difference == 0 ? 0 : size > 0 ? difference / size : difference;
}

/// Largest relative difference of the rows of [a1 a2] and [b1 b2].
double by_rows(const MatrixXd& a1, const MatrixXd& a2, const MatrixXd& b1, const MatrixXd& b2) {
  double worst = 0;
  const auto size = [](const auto& m, Eigen::Index i) {
    return m.cols() ? m.row(i).cwiseAbs().maxCoeff() : 0.0;
  };
  for (Eigen::Index i = 0; i < a1.rows(); ++i) {
    const double off = std::max(size(a1 - b1, i), size(a2 - b2, i));
    worst = larger(worst, ratio(off, std::max(size(b1, i), size(b2, i))));
  }
  return worst;
}

}  // namespace

double difference(const titop::StateSpace& a, const titop::StateSpace& b) {
  if (a.A.rows() != b.A.rows()) return std::numeric_limits<double>::infinity();
  return std::max(by_rows(a.A, a.B, b.A, b.B), by_rows(a.C, a.D, b.C, b.D));
}

double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return larger(0, ratio((a - b).cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()));
}

double difference(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& b) {
  const Eigen::Index rows = b[0].rows(), cols = b[0].cols();
  const Eigen::Index m = rows % 3 ? 1 : 3, n = cols % 3 ? 1 : 3;
  double worst = 0;
  for (Eigen::Index i = 0; i < rows; i += m)
    for (Eigen::Index j = 0; j < cols; j += n) {
      double off = 0, size = 0;
      for (std::size_t k = 0; k < b.size(); ++k) {
        off = larger(off, (a[k] - b[k]).block(i, j, m, n).cwiseAbs().maxCoeff());
        size = std::max(size, b[k].block(i, j, m, n).cwiseAbs().maxCoeff());
      }
      worst = larger(worst, ratio(off, size));
    }
  return worst;
}

}  // namespace titop_bench
