#include "methods/steppers.hpp"

#include <Eigen/LU>

namespace titop_bench {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Step newmark(const titop::StateSpace& m, double h) {
  const MatrixXd I = MatrixXd::Identity(m.A.rows(), m.A.cols());
  const Eigen::PartialPivLU<MatrixXd> left(I - h / 2 * m.A);
  return [left, right = MatrixXd(I + h / 2 * m.A)](const VectorXd& x) {
    return VectorXd(left.solve(right * x));
  };
}

Step explicit_euler(const titop::StateSpace& m, double h) {
  return [A = m.A, h](const VectorXd& x) { return VectorXd(x + h * (A * x)); };
}

Step runge_kutta(const titop::StateSpace& m, double h) {
  return [A = m.A, h](const VectorXd& x) {
    const VectorXd a = A * x, b = A * (x + h / 2 * a), c = A * (x + h / 2 * b), d = A * (x + h * c);
    return VectorXd(x + h / 6 * (a + 2 * b + 2 * c + d));
  };
}

}  // namespace titop_bench
