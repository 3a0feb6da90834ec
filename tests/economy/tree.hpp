#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <titop/titop.hpp>
#include <vector>

#include "economy/against.hpp"

/// Trees of modal and rigid bodies as one M, D and K, assembled by hand from the bodies' data: the
/// coordinates are the motion of the root, if it is free, and the modes of all bodies clamped. In
/// long double, since a bound may be as low as 1e-12 of a peak, and 5e-14 of what would be there if
/// symmetry did not make it 0: double loses more where a free root is eliminated, and where heavy
/// and light bodies meet.
namespace titop_test {

using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using VectorXl = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// M xdd + D xd + K x = B u, y = C x.
struct Assembled {
  MatrixXl M, D, K, B, C;
};

class Tree {
 public:
  explicit Tree(bool free) : columns_(free ? 6 : 0), root_(free) {}

  /// Bodies as the diagram mounts them: on child `port` of body `on` (-1: the root), turned by T.
  int add(const titop::ModalData& m, int on = -1, int port = 0,
          const Eigen::Matrix3d& T = Eigen::Matrix3d::Identity()) {
    const Eigen::Index n = m.omega.size();
    Body b{MatrixXl(6 + n, 6 + n), on, port, T, columns_, m.omega.cast<long double>(), {}};
    const MatrixXl L = m.L_P.cast<long double>();
    b.mass << m.D_P.cast<long double>(), L.transpose(), L, MatrixXl::Identity(n, n);
    b.damping = VectorXl::Zero(n);
    if (m.xi.size() > 0) b.damping = 2 * m.xi.cast<long double>().cwiseProduct(b.omega);
    for (const titop::ModalChild& child : m.children) {
      Eigen::MatrixXd read(6, 6 + n);
      read << by_hand::tau(-child.PC), child.Phi_C;
      b.ports.push_back(read.cast<long double>());
    }
    return add(std::move(b));
  }
  int add(const titop::RigidBody& r, int on = -1, int port = 0,
          const Eigen::Matrix3d& T = Eigen::Matrix3d::Identity()) {
    Body b{{}, on, port, T, columns_, {}, {}};
    by_hand::Matrix6 own = by_hand::Matrix6::Zero();
    own.topLeftCorner<3, 3>().diagonal().setConstant(r.mass.nominal());
    own.bottomRightCorner<3, 3>() = r.inertia;
    const MatrixXl tau = by_hand::tau(-r.PA).cast<long double>();
    b.mass = tau.transpose() * own.cast<long double>() * tau;
    for (const auto& child : r.children)
      b.ports.emplace_back(by_hand::tau(-child.PC).cast<long double>());
    return add(std::move(b));
  }

  /// Six rows: the motion of a body's P (port -1) or of a child point, in its frame.
  MatrixXl motion(int body, int port = -1) const {
    const Body& b = bodies_[at(body)];
    MatrixXl Y = MatrixXl::Zero(6, columns_);
    if (b.on >= 0)
      Y = by_hand::dual(b.T.transpose()).cast<long double>() * motion(b.on, b.port);
    else if (root_)
      Y.leftCols(6).setIdentity();
    if (port < 0) return Y;
    const MatrixXl& read = b.ports[at(port)];
    Y = read.leftCols(6) * Y;
    Y.middleCols(b.first, b.omega.size()) += read.rightCols(b.omega.size());
    return Y;
  }

  /// M, D and K; B and C by motions: forces on what the rows of `driven` are, outputs `read`.
  Assembled structure(const MatrixXl& driven, const MatrixXl& read) const {
    const MatrixXl none = MatrixXl::Zero(columns_, columns_);
    Assembled a{none, none, none, driven.transpose(), read};
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& b = bodies_[i];
      MatrixXl Y = MatrixXl::Zero(b.mass.rows(), columns_);
      Y.topRows(6) = motion(static_cast<int>(i));
      const Eigen::Index n = b.omega.size();
      Y.block(6, b.first, n, n).setIdentity();
      a.M += Y.transpose() * b.mass * Y;
      a.K.diagonal().segment(b.first, n) = b.omega.cwiseAbs2();
      if (n > 0) a.D.diagonal().segment(b.first, n) = b.damping;
    }
    return a;
  }

 private:
  struct Body {
    MatrixXl mass;
    int on, port;
    Eigen::Matrix3d T;
    Eigen::Index first;
    VectorXl omega, damping;
    std::vector<MatrixXl> ports = {};
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

/// C (s^2 M + s D + K)^-1 B by LU, scaled.
inline Eigen::MatrixXcd position_transfer(const Assembled& a, std::complex<double> at) {
  using Matrix = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;
  const std::complex<long double> s = at;
  const Matrix Z = s * s * a.M + s * a.D + a.K;
  const VectorXl scale = Z.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  const Matrix S = scale.asDiagonal() * Z * scale.asDiagonal();
  const Matrix load = (scale.asDiagonal() * a.B).cast<std::complex<long double>>();
  const Matrix H = a.C * scale.asDiagonal() * S.partialPivLu().solve(load);
  return H.cast<std::complex<double>>();
}

/// Times s^p of positions: 0 positions, 1 rates, 2 accelerations, per output. The free root is
/// eliminated; undamped, the rest is a sum over modes, found from M x = (1 / lambda) K x with
/// stiffnesses scaled to 1, so that the low ones are sharp.
inline Truth truth_of(const Assembled& a, bool free, const std::vector<int>& power) {
  using Eigen::MatrixXcd;
  const Eigen::Index r = free ? 6 : 0, n = a.M.rows() - r;
  const MatrixXl inverse = free ? MatrixXl(a.M.topLeftCorner<6, 6>().inverse()) : MatrixXl(0, 0),
                 over = inverse * a.M.topRightCorner(r, n);
  const MatrixXcd rigid =
      (a.C.leftCols(r) * inverse * a.B.topRows(r)).cast<double>().cast<std::complex<double>>();
  const Assembled e{a.M.bottomRightCorner(n, n) - a.M.bottomLeftCorner(n, r) * over,
                    a.D.bottomRightCorner(n, n), a.K.bottomRightCorner(n, n),
                    a.B.bottomRows(n) - over.transpose() * a.B.topRows(r),
                    a.C.rightCols(n) - a.C.leftCols(r) * over};
  const VectorXl scale = e.K.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXl> modes(scale.asDiagonal() * e.M *
                                                      scale.asDiagonal());
  const Eigen::VectorXd mu = modes.eigenvalues().cast<double>();      // 1 / lambda
  const MatrixXl scaled = scale.asDiagonal() * modes.eigenvectors();  // modes of stiffness 1
  const MatrixXcd b = (scaled.transpose() * e.B).cast<double>().cast<std::complex<double>>(),
                  c = (e.C * scaled).cast<double>().cast<std::complex<double>>();
  Truth truth{{}, {}};
  for (const double x : mu) truth.omegas.push_back(1 / std::sqrt(x));
  const bool damped = !e.D.isZero(0);
  truth.transfer = [=](std::complex<double> s) {
    MatrixXcd H =
        damped ? position_transfer(e, s)
               : MatrixXcd(c * (1.0 + s * s * mu.array()).inverse().matrix().asDiagonal() * b);
    if (free) H += rigid / (s * s);
    for (Eigen::Index i = 0; i < H.rows(); ++i)
      H.row(i) *= std::pow(s, power[static_cast<std::size_t>(i)]);
    return H;
  };
  return truth;
}
inline Truth truth_of(const Assembled& a, bool free = false, int power = 2) {
  return truth_of(a, free, std::vector<int>(static_cast<std::size_t>(a.C.rows()), power));
}

}  // namespace titop_test
