#include "satellite_by_hand.hpp"

#include <Eigen/Geometry>

#include "satellite.hpp"

namespace scenes {

by_hand::Structure satellite_by_hand(const titop::ModalData& boom) {
  const Eigen::Index N = boom.omega.size(), n = 7 + 2 * N;
  by_hand::Structure a = by_hand::empty(n, 7, 19);
  const by_hand::Matrix6 tau_AP = by_hand::tau(-hub_spec.PA.nominal());
  by_hand::Matrix6 hub = by_hand::Matrix6::Zero();
  hub.topLeftCorner<3, 3>().diagonal().setConstant(85);
  hub.bottomRightCorner<3, 3>() = hub_spec.inertia.nominal();
  a.M.topLeftCorner<6, 6>() = tau_AP.transpose() * hub * tau_AP;
  by_hand::MatrixXd own(6 + N, 6 + N);
  own << boom.D_P, boom.L_P.transpose(), boom.L_P, by_hand::MatrixXd::Identity(N, N);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Matrix3d T_ba = i == 0 ? Eigen::AngleAxisd(angle1, turn1.normalized()).matrix()
                                        : Eigen::AngleAxisd(angle2, turn2.normalized()).matrix();
    by_hand::MatrixXd Y = by_hand::MatrixXd::Zero(6 + N, n);
    Y.topLeftCorner<6, 6>() =
        by_hand::dual(T_ba.transpose()) *
        by_hand::tau(-hub_spec.children[static_cast<std::size_t>(i)].PC.nominal());
    if (i == 1) Y.block<3, 1>(3, 6) = hinge_axis;
    Y.block(6, 7 + i * N, N, N).setIdentity();
    a.M += Y.transpose() * own * Y;
    a.K.diagonal().segment(7 + i * N, N) = boom.omega.cwiseAbs2();
    a.D.diagonal().segment(7 + i * N, N) = 2 * boom.xi.cwiseProduct(boom.omega);
    by_hand::MatrixXd tip(6, 6 + N);
    tip << by_hand::tau(-boom.children[0].PC), boom.children[0].Phi_C;
    a.C.middleRows<6>(6 + 6 * i) = tip * Y;
  }
  a.K(6, 6) = kappa;
  a.D(6, 6) = c;
  a.C.topLeftCorner<6, 6>().setIdentity();
  a.C(18, 6) = 1;
  a.B.topLeftCorner<7, 7>().setIdentity();
  return a;
}

}  // namespace scenes
