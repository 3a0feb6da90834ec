#include "reduction/tree.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop_test {
namespace {

using titop::linalg::at;

}  // namespace

int Tree::add(const titop::ModalData& m, int on, int port, const Eigen::Matrix3d& T) {
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

int Tree::add(const titop::RigidBody& r, int on, int port, const Eigen::Matrix3d& T) {
  Body b{{}, on, port, T, columns_, {}, {}};
  by_hand::Matrix6 own = by_hand::Matrix6::Zero();
  own.topLeftCorner<3, 3>().diagonal().setConstant(r.mass.nominal());
  own.bottomRightCorner<3, 3>() = r.inertia.nominal();
  const MatrixXl tau = by_hand::tau(-r.PA.nominal()).cast<long double>();
  b.mass = tau.transpose() * own.cast<long double>() * tau;
  for (const auto& child : r.children)
    b.ports.emplace_back(by_hand::tau(-child.PC.nominal()).cast<long double>());
  return add(std::move(b));
}

MatrixXl Tree::motion(int body, int port) const {
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

Assembled Tree::structure(const MatrixXl& driven, const MatrixXl& read) const {
  const MatrixXl none = MatrixXl::Zero(columns_, columns_);
  Assembled a{none, none, none, driven.transpose(), read};
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& b = bodies_[i];
    const Eigen::Index n = b.omega.size();
    // Y' mass Y, with Y the motion of P above the body's own modes.
    const MatrixXl P = motion(static_cast<int>(i)), carried = b.mass.bottomLeftCorner(n, 6) * P;
    a.M += P.transpose() * b.mass.topLeftCorner(6, 6) * P;
    a.M.middleRows(b.first, n) += carried;
    a.M.middleCols(b.first, n) += carried.transpose();
    a.M.block(b.first, b.first, n, n) += b.mass.bottomRightCorner(n, n);
    a.K.diagonal().segment(b.first, n) = b.omega.cwiseAbs2();
    if (n > 0) a.D.diagonal().segment(b.first, n) = b.damping;
  }
  return a;
}

int Tree::add(Body b) {
  columns_ += b.omega.size();
  bodies_.push_back(std::move(b));
  return static_cast<int>(bodies_.size()) - 1;
}

namespace {

/// C (s^2 M + s D + K)^-1 B by LU, scaled.
Eigen::MatrixXcd position_transfer(const Assembled& a, std::complex<double> at) {
  using Matrix = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;
  const std::complex<long double> s = at;
  const Matrix Z = s * s * a.M + s * a.D + a.K;
  const VectorXl scale = Z.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  const Matrix S = scale.asDiagonal() * Z * scale.asDiagonal();
  const Matrix load = (scale.asDiagonal() * a.B).cast<std::complex<long double>>();
  const Matrix H = a.C * scale.asDiagonal() * S.partialPivLu().solve(load);
  return H.cast<std::complex<double>>();
}

}  // namespace

template <class Real>
InModes in_modes(const Assembled& a, bool free) {
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index r = free ? 6 : 0, n = a.M.rows() - r;
  const MatrixXl inverse = free ? MatrixXl(a.M.topLeftCorner<6, 6>().inverse()) : MatrixXl(0, 0),
                 over = inverse * a.M.topRightCorner(r, n),
                 C = a.C.rightCols(n) - a.C.leftCols(r) * over,
                 B = a.B.bottomRows(n) - over.transpose() * a.B.topRows(r);
  const VectorXl scale = a.K.diagonal().tail(n).cwiseSqrt().cwiseInverse();
  const MatrixXl M = scale.asDiagonal() *
                     (a.M.bottomRightCorner(n, n) - a.M.bottomLeftCorner(n, r) * over) *
                     scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> modes(M.cast<Real>());
  const MatrixXl V = scale.asDiagonal() * modes.eigenvectors().template cast<long double>();
  InModes m{(a.C.leftCols(r) * inverse * a.B.topRows(r)).cast<double>(),
            modes.eigenvalues().template cast<double>(), (V.transpose() * B).cast<double>(),
            (C * V).cast<double>(), MatrixXl(0, 0)};
  if (!a.D.isZero(0)) m.Z = V.transpose() * a.D.bottomRightCorner(n, n) * V;
  return m;
}

template InModes in_modes<double>(const Assembled&, bool);
template InModes in_modes<long double>(const Assembled&, bool);

namespace {

/// A sum of c_k b_k / (1 - s nu_k).
struct ByPoles {
  Eigen::VectorXcd nu;
  Eigen::MatrixXcd b, c;
  Eigen::MatrixXcd at(std::complex<double> s) const {
    return c * (1.0 - s * nu.array()).inverse().matrix().asDiagonal() * b;
  }
  /// Sum of the magnitudes of the terms.
  Eigen::MatrixXd terms(std::complex<double> s) const {
    const Eigen::VectorXd each = (1.0 - s * nu.array()).inverse().abs();
    return c.cwiseAbs() * each.asDiagonal() * b.cwiseAbs();
  }
};

/// Undamped, nu = +-j / omega. Damped, the modes q and the rates v = s q / omega obey
///
///     q / s = -Z q - v / omega,    v / s = q / omega    (nothing driven)
///
/// with q alone driven.
ByPoles by_poles(const InModes& m) {
  using Complex = std::complex<long double>;
  using Matrix = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index n = m.mu.size();
  const VectorXl slow = m.mu.cast<long double>().cwiseSqrt();
  MatrixXl A = MatrixXl::Zero(2 * n, 2 * n);
  A.topLeftCorner(n, n) = -m.Z;
  A.topRightCorner(n, n) = -MatrixXl(slow.asDiagonal());
  A.bottomLeftCorner(n, n) = slow.asDiagonal();
  const Eigen::EigenSolver<MatrixXl> solver(A);
  const Matrix T = solver.eigenvectors(), top = T.topRows(n);
  const Matrix left = T.partialPivLu().inverse().leftCols(n);  // of equal poles, too
  return {solver.eigenvalues().cast<std::complex<double>>(),
          (left * m.b.cast<Complex>()).cast<std::complex<double>>(),
          (m.c.cast<Complex>() * top).cast<std::complex<double>>()};
}

}  // namespace

Truth truth_of(const Assembled& a, bool free, const std::vector<int>& power) {
  using Eigen::MatrixXcd;
  const InModes m = in_modes<long double>(a, free);
  Truth truth{{}, {}};
  for (const double x : m.mu) truth.omegas.push_back(1 / std::sqrt(x));
  const MatrixXcd b = m.b.cast<std::complex<double>>(), c = m.c.cast<std::complex<double>>();
  std::function<MatrixXcd(std::complex<double>)> positions = [=, mu = m.mu](auto s) {
    return MatrixXcd(c * (1.0 + s * s * mu.array()).inverse().matrix().asDiagonal() * b);
  };
  if (m.Z.size() > 0) {
    const ByPoles poles = by_poles(m);
    positions = [=](auto s) { return poles.at(s); };
    const std::complex<double> s{0.3 * truth.omegas.back(), 0.9 * truth.omegas.back()};
    const MatrixXcd sum = poles.at(s) + m.rigid / (s * s), off = sum - position_transfer(a, s);
    const Eigen::MatrixXd terms = poles.terms(s) + m.rigid.cwiseAbs() / std::norm(s);
    // A pair that symmetry makes 0 has rounding alone for terms, too.
    const double nothing = 1e-15 * terms.maxCoeff();
    if (!(off.cwiseAbs().array() <= 1e-12 * terms.array() + nothing).all())
      throw std::logic_error("truth by poles and by LU differ");
  }
  truth.transfer = [=, rigid = MatrixXcd(m.rigid.cast<std::complex<double>>())](auto s) {
    MatrixXcd H = positions(s);
    if (free) H += rigid / (s * s);
    for (Eigen::Index i = 0; i < H.rows(); ++i)
      H.row(i) *= std::pow(s, power[static_cast<std::size_t>(i)]);
    return H;
  };
  return truth;
}
Truth truth_of(const Assembled& a, bool free, int power) {
  return truth_of(a, free, std::vector<int>(static_cast<std::size_t>(a.C.rows()), power));
}

}  // namespace titop_test
