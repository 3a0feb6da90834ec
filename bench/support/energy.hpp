#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <titop/compiler/realization/modal.hpp>

namespace titop_bench {

/// Twice the energy of qdd = -M^-1 K q with a diagonal K, from A alone: with q = d y, ydd = -S y,
/// it is y' y + yd' S^-1 yd, up to a unit.
class Energy {
 public:
  explicit Energy(const titop::StateSpace& m) : form_(titop::second_order(m)), inverse_(form_.S) {}
  double operator()(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd y = form_.D_inverse * x(form_.q), rate = form_.D_inverse * x(form_.qdot);
    return y.dot(y) + rate.dot(inverse_.solve(rate));
  }
  /// All coordinates with the same energy.
  Eigen::VectorXd bent(Eigen::Index states) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(states);
    x(form_.q) = form_.D.diagonal();
    return x;
  }
  double fastest() const {
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(form_.S, Eigen::EigenvaluesOnly)
                         .eigenvalues()
                         .maxCoeff());
  }

 private:
  titop::SecondOrder form_;
  Eigen::LDLT<Eigen::MatrixXd> inverse_;
};

}  // namespace titop_bench
