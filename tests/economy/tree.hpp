#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <titop/titop.hpp>
#include <vector>

#include "economy/against.hpp"

/// Trees of modal and rigid bodies as one M, D and K, assembled by hand from the bodies' data: the
/// coordinates are the motion of the root, if it is free, and the modes of all bodies clamped.
namespace titop_test {

class Tree {
 public:
  explicit Tree(bool free) : columns_(free ? 6 : 0), root_(free) {}

  /// Bodies as the diagram mounts them: on child `port` of body `on` (-1: the root), turned by T.
  int add(const titop::ModalData& m, int on = -1, int port = 0,
          const Eigen::Matrix3d& T = Eigen::Matrix3d::Identity()) {
    Body b{{}, on, port, T, columns_, m.omega, {}};
    const Eigen::Index n = m.omega.size();
    b.mass.resize(6 + n, 6 + n);
    b.mass << m.D_P, m.L_P.transpose(), m.L_P, Eigen::MatrixXd::Identity(n, n);
    b.damping = m.xi.size() ? Eigen::VectorXd(2 * m.xi.cwiseProduct(m.omega))
                            : Eigen::VectorXd(Eigen::VectorXd::Zero(n));
    for (const titop::ModalChild& child : m.children) {
      Eigen::MatrixXd read(6, 6 + n);
      read << by_hand::tau(-child.PC), child.Phi_C;
      b.ports.push_back(read);
    }
    return add(std::move(b));
  }
  int add(const titop::RigidBody& r, int on = -1, int port = 0,
          const Eigen::Matrix3d& T = Eigen::Matrix3d::Identity()) {
    Body b{{}, on, port, T, columns_, {}, {}};
    by_hand::Matrix6 own = by_hand::Matrix6::Zero();
    own.topLeftCorner<3, 3>().diagonal().setConstant(r.mass.nominal());
    own.bottomRightCorner<3, 3>() = r.inertia;
    const by_hand::Matrix6 tau = by_hand::tau(-r.PA);
    b.mass = tau.transpose() * own * tau;
    for (const auto& child : r.children) b.ports.emplace_back(by_hand::tau(-child.PC));
    return add(std::move(b));
  }

  /// Six rows: the motion of a body's P (port -1) or of a child point, in its frame.
  Eigen::MatrixXd motion(int body, int port = -1) const {
    const Body& b = bodies_[at(body)];
    Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(6, columns_);
    if (b.on >= 0)
      Y = by_hand::dual(b.T.transpose()) * motion(b.on, b.port);
    else if (root_)
      Y.leftCols(6).setIdentity();
    if (port < 0) return Y;
    const Eigen::MatrixXd& read = b.ports[at(port)];
    Y = read.leftCols(6) * Y;
    Y.middleCols(b.first, b.omega.size()) += read.rightCols(b.omega.size());
    return Y;
  }

  /// M, D and K; B and C by motions: forces on what the rows of `driven` are, outputs `read`.
  by_hand::Structure structure(const Eigen::MatrixXd& driven, const Eigen::MatrixXd& read) const {
    by_hand::Structure a = by_hand::empty(columns_, driven.rows(), read.rows());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& b = bodies_[i];
      Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(b.mass.rows(), columns_);
      Y.topRows(6) = motion(static_cast<int>(i));
      const Eigen::Index n = b.omega.size();
      Y.block(6, b.first, n, n).setIdentity();
      a.M += Y.transpose() * b.mass * Y;
      a.K.diagonal().segment(b.first, n) = b.omega.cwiseAbs2();
      if (n > 0) a.D.diagonal().segment(b.first, n) = b.damping;
    }
    a.B = driven.transpose();
    a.C = read;
    return a;
  }

 private:
  struct Body {
    Eigen::MatrixXd mass;
    int on, port;
    Eigen::Matrix3d T;
    Eigen::Index first;
    Eigen::VectorXd omega, damping;
    std::vector<Eigen::MatrixXd> ports = {};
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  int add(Body b) {
    columns_ += b.omega.size();
    bodies_.push_back(std::move(b));
    return static_cast<int>(bodies_.size()) - 1;
  }
  Eigen::Index columns_;
  bool root_;
  std::vector<Body> bodies_;
};

/// Times s^p of positions: 0 positions, 1 rates, 2 accelerations, per output. The free root is
/// eliminated; undamped, the rest is a sum over modes, found from M x = (1 / lambda) K x with
/// stiffnesses scaled to 1, so that the low ones are sharp.
inline Truth truth_of(const by_hand::Structure& a, bool free, const std::vector<int>& power) {
  using Eigen::MatrixXcd;
  using Eigen::MatrixXd;
  const Eigen::Index r = free ? 6 : 0, n = a.M.rows() - r;
  const MatrixXd inverse = free ? MatrixXd(a.M.topLeftCorner<6, 6>().inverse()) : MatrixXd(0, 0),
                 over = inverse * a.M.topRightCorner(r, n);
  const MatrixXd rigid = a.C.leftCols(r) * inverse * a.B.topRows(r);
  by_hand::Structure e;
  e.M = a.M.bottomRightCorner(n, n) - a.M.bottomLeftCorner(n, r) * over;
  e.D = a.D.bottomRightCorner(n, n);
  e.K = a.K.bottomRightCorner(n, n);
  e.B = a.B.bottomRows(n) - over.transpose() * a.B.topRows(r);
  e.C = a.C.rightCols(n) - a.C.leftCols(r) * over;
  const Eigen::VectorXd scale = e.K.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(scale.asDiagonal() * e.M *
                                                      scale.asDiagonal());
  const Eigen::VectorXd mu = modes.eigenvalues();  // 1 / lambda; modes of stiffness 1
  const MatrixXcd b = (modes.eigenvectors().transpose() * scale.asDiagonal() * e.B)
                          .cast<std::complex<double>>(),
                  c = (e.C * scale.asDiagonal() * modes.eigenvectors())
                          .cast<std::complex<double>>();
  Truth truth{{}, {}};
  for (const double x : mu) truth.omegas.push_back(1 / std::sqrt(x));
  const bool damped = !e.D.isZero(0);
  truth.transfer = [=](std::complex<double> s) {
    MatrixXcd H =
        damped ? by_hand::position_transfer(e, s)
               : MatrixXcd(c * (1.0 + s * s * mu.array()).inverse().matrix().asDiagonal() * b);
    if (free) H += rigid / (s * s);
    for (Eigen::Index i = 0; i < H.rows(); ++i)
      H.row(i) *= std::pow(s, power[static_cast<std::size_t>(i)]);
    return H;
  };
  return truth;
}
inline Truth truth_of(const by_hand::Structure& a, bool free = false, int power = 2) {
  return truth_of(a, free, std::vector<int>(static_cast<std::size_t>(a.C.rows()), power));
}

}  // namespace titop_test
