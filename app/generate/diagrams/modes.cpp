#include "generate/diagrams/modes.hpp"

#include <fmt/format.h>

#include <numbers>
#include <titop/blocks/rigid_body.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop::generate {

using Eigen::MatrixXd;

ModalData random_modes(Rng& rng, int modes, const std::vector<std::string>& children, bool damped) {
  const double m = rng.octaves(-1, 4), radius = rng.between(0.3, 1);
  const Vector3d parts = Vector3d::Constant(0.2) + rng.matrix(3, 1).cwiseAbs();
  const Matrix3d T = rng.rotation();
  const Vector3d principal(parts(0) + parts(1), parts(1) + parts(2), parts(2) + parts(0));
  const Matrix3d inertia = m * radius * radius * T * principal.asDiagonal() * T.transpose();
  ModalData data;
  data.D_P = rigid_mass(m, (inertia + inertia.transpose()) / 2, rng.matrix(3, 1));
  data.omega.resize(modes);
  data.xi.resize(modes);
  for (int i = 0; i < modes; ++i) {
    data.omega(i) = rng.octaves(0, 7);
    data.xi(i) = damped ? rng.between(0.005, 0.02) : 0;
  }
  const MatrixXd share = rng.matrix(modes, 6);
  const MatrixXd root = data.D_P.llt().matrixU();
  data.L_P = modes ? MatrixXd(0.8 / std::sqrt(share.squaredNorm()) * share * root) : MatrixXd(0, 6);
  for (const std::string& child : children) {
    MatrixXd Phi = rng.matrix(6, modes) / std::sqrt(m);
    Phi.bottomRows(3) /= radius;
    data.children.push_back({child, 2 * rng.matrix(3, 1), Phi});
  }
  return data;
}

ModalData clustered_modes(const ClusterOptions& o) {
  Rng rng(6);
  ModalData data;
  data.omega.resize(o.modes);
  data.xi = Eigen::VectorXd::Constant(o.modes, 0.005);
  data.L_P = MatrixXd::Zero(o.modes, 6);
  data.D_P = Matrix6::Identity() * 1000;
  for (int i = 1; i <= o.points; ++i)
    data.children.push_back({fmt::format("C{}", i), Vector3d(1, 2, 3), MatrixXd(6, o.modes)});
  for (int j = 0; j < o.modes; ++j) {
    const double centre = 1 + 0.8 * (j / 10);  // [Hz]
    data.omega(j) = 2 * std::numbers::pi * centre * (1 + o.width / 2 * rng.between(-1, 1));
    for (int k = 0; o.carried && k < 6; ++k) data.L_P(j, k) = rng.between(-1, 1);
    for (ModalChild& child : data.children)
      for (int k = 0; k < 6; ++k) child.Phi_C(k, j) = 0.1 * rng.between(-1, 1);
  }
  return data;
}

}  // namespace titop::generate
