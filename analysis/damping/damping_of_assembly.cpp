#include <cmath>
#include <titop/analysis/damping/assembled_part.hpp>
#include <titop/graph/linalg/graded.hpp>
#include <titop/graph/linalg/rounding.hpp>

/// Damping that a body's assembled modes have exactly.
namespace titop {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// D_P^-1 B, without the directions that have no mass (and in which no mode has any).
MatrixXd solve_rigid(const Matrix6& D_P, const MatrixXd& B) {
  const Vector6 scale =
      D_P.diagonal().unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 1.0; });
  const SymmetricModes m = eigh(scale.asDiagonal() * D_P * scale.asDiagonal());
  const VectorXd inverse =
      m.lambda.unaryExpr([](double l) { return l > linalg::kAxisRounding ? 1 / l : 0.0; });
  const MatrixXd V = scale.asDiagonal() * m.V;
  return V * (inverse.asDiagonal() * (V.transpose() * B));
}

/// D = M Phi diag(2 xi w) Phi' M in the modes clamped at the root, with Phi those of the free body:
/// (1 - L_P D_P^-1 L_P') etadd + Omega^2 eta = 0. In y = Omega eta the eigenvalues are mu = w^-2,
/// and M phi = K phi / w^2, whose rows at the rigid motions are 0.
MatrixXd damping_of_free_modes(const ModalData& d, const ModalDamping& xi) {
  const VectorXd soft = d.omega.cwiseInverse();
  MatrixXd M = MatrixXd::Identity(d.omega.size(), d.omega.size());
  M -= d.L_P * solve_rigid(d.D_P, d.L_P.transpose());
  const SymmetricModes modes = eigh_graded(soft.asDiagonal() * M * soft.asDiagonal()).modes;
  const VectorXd z = modes.lambda.unaryExpr(
      [&](double mu) { return mu > 0 ? 2 * xi.at(1 / std::sqrt(mu)) * std::sqrt(mu) : 0; });
  const MatrixXd forces = d.omega.asDiagonal() * modes.V;
  return forces * z.asDiagonal() * forces.transpose();
}

}  // namespace

FlexibleBody damping_of_assembly(const Diagram& part, const std::string& root,
                                 const std::vector<AssemblyPort>& ports, const ModalDamping& xi,
                                 RootBoundary boundary, SourceLine at) {
  ModalData data = detail::assembled_part(part, root, ports);
  if (boundary == RootBoundary::clamped || data.omega.size() == 0) {
    data.xi = data.omega.unaryExpr([&](double omega) { return xi.at(omega); });
    return {std::move(data), at};
  }
  const MatrixXd Z = damping_of_free_modes(data, xi);
  data.xi = Z.diagonal().cwiseQuotient(2 * data.omega);
  return FlexibleBody(std::move(data), at).damped_by(Z);
}

}  // namespace titop
