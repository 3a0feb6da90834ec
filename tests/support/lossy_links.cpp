#include "support/lossy_links.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/multiprecision/cpp_complex.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "support/rng.hpp"

using namespace titop;

namespace titop_test {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Big = boost::multiprecision::cpp_complex_50;
using BigMatrix = Eigen::Matrix<Big, Eigen::Dynamic, Eigen::Dynamic>;
using Matrix66 = Eigen::Matrix<double, 6, 6>;

constexpr double kMass = 3;
constexpr double kOmega = 20;  ///< of a body on its joint [rad/s]

Matrix3d cross(const Vector3d& v) {
  return Matrix3d{{0, -v(2), v(1)}, {v(2), 0, -v(0)}, {-v(1), v(0), 0}};
}

/// One body of the row, and its joint.
struct Link {
  Vector3d PA{0.2, -0.1, 0.15}, PC{0.5, 0.2, -0.1}, axis = Vector3d(1, -2, 3).normalized();
  Matrix3d inertia{{0.5, 0.05, -0.02}, {0.05, 0.6, 0.03}, {-0.02, 0.03, 0.4}};
  Matrix66 D_P = Matrix66::Zero();
  Eigen::VectorXd omega, xi;
  MatrixXd L_P, Phi;

  explicit Link(const LossyLinks& of) {
    if (of.joint == LossyLinks::Joint::clamp)
      set_beam(of.damping);
    else
      set_body(of.modes);
  }
  ModalData data() const {
    return {.omega = omega, .xi = xi, .L_P = L_P, .D_P = D_P, .children = {{"C", PC, Phi}}};
  }

 private:
  /// Its first clamped mode is at 4 rad/s.
  void set_beam(double damping) {
    const ModalData beam = modal_data(Beam{.length = 0.5,
                                           .section = rectangle(0.03, 0.02),
                                           .material = {.E = 7e6, .nu = 0.33, .rho = 2700},
                                           .elements = 2,
                                           .modes = {.xi = {damping}}});
    PC = beam.children.front().PC;
    Phi = beam.children.front().Phi_C;
    omega = beam.omega, xi = beam.xi, L_P = beam.L_P, D_P = beam.D_P;
  }
  void set_body(int modes) {
    omega.resize(modes), xi.resize(modes), L_P.resize(modes, 6), Phi.resize(6, modes);
    Matrix66 tau = Matrix66::Identity();
    tau.topRightCorner<3, 3>() = -cross(PA);
    D_P.topLeftCorner<3, 3>() = kMass * Matrix3d::Identity();
    D_P.bottomRightCorner<3, 3>() = inertia;
    D_P = (tau.transpose() * D_P * tau).eval();
    D_P = (0.5 * (D_P + D_P.transpose())).eval();
    Rng rng(11);
    for (int i = 0; i < modes; ++i) omega(i) = kOmega * (0.8 + 1.3 * i), xi(i) = 0.02 + 0.2 * i;
    L_P = 0.2 * rng.matrix(modes, 6);
    Phi = 0.5 * rng.matrix(6, modes);
  }
};

Matrix66 stiffness() {
  const double k = kMass * kOmega * kOmega;
  Matrix66 K = Matrix66::Zero();
  K.diagonal() << k, 1.5 * k, 0.8 * k, 0.3 * k, 0.2 * k, 0.25 * k;
  K(0, 4) = K(4, 0) = 0.1 * k;
  return K;
}

/// Damping over stiffness [s]: of `ratio` times critical at kOmega.
double loss(double ratio) { return 2 * ratio / kOmega; }

Big big(std::complex<double> z) { return {z.real(), z.imag()}; }
BigMatrix big(const MatrixXd& m) {
  return m.unaryExpr([](double x) { return Big(x); });
}

/// A X = B by elimination with partial pivoting.
BigMatrix solved(BigMatrix A, BigMatrix B) {
  for (Index k = 0; k < A.rows(); ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < A.rows(); ++i)
      if (norm(A(i, k)).real() > norm(A(pivot, k)).real()) pivot = i;
    A.row(k).swap(A.row(pivot));
    B.row(k).swap(B.row(pivot));
    for (Index i = 0; i < A.rows(); ++i) {
      if (i == k || A(i, k) == Big(0)) continue;
      const Big f = A(i, k) / A(k, k);
      for (Index j = k; j < A.cols(); ++j) A(i, j) -= f * A(k, j);
      for (Index j = 0; j < B.cols(); ++j) B(i, j) -= f * B(k, j);
    }
  }
  for (Index i = 0; i < A.rows(); ++i)
    for (Index j = 0; j < B.cols(); ++j) B(i, j) /= A(i, i);
  return B;
}

/// One step of the recursion: rails side by side, x = [x_P; eta] of each body.
struct Step {
  BigMatrix Z;      ///< force per coordinate: M s^2 + D s + K, rungs included
  BigMatrix E, W;   ///< x_P, x_C of the coordinates
  BigMatrix joint;  ///< x_P - x_C before = joint (-f_P), f_P the wrench on the body at P
};

Step step_of(const LossyLinks& of, const Link& link, const Big& s) {
  const Index m = link.omega.size(), size = 6 + m, rails = of.rails;
  BigMatrix Z = BigMatrix::Zero(size, size), W = BigMatrix::Zero(6, size);
  Z.topLeftCorner(6, 6) = big(link.D_P) * (s * s);
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < 6; ++j) Z(6 + i, j) = Z(j, 6 + i) = Big(link.L_P(i, j)) * s * s;
    Z(6 + i, 6 + i) = s * s + Big(2) * Big(link.xi(i)) * Big(link.omega(i)) * s +
                      Big(link.omega(i)) * Big(link.omega(i));
  }
  MatrixXd tau = MatrixXd::Identity(6, 6);
  tau.topRightCorner(3, 3) = -cross(link.PC);
  W.leftCols(6) = big(tau);
  if (m > 0) W.rightCols(m) = big(link.Phi);
  const Big c = Big(1) + Big(loss(of.damping)) * s;
  BigMatrix joint = BigMatrix::Zero(6, 6);
  if (of.joint == LossyLinks::Joint::bushing) {
    joint = solved(big(stiffness()) * c, big(MatrixXd(MatrixXd::Identity(6, 6))));
  } else if (of.joint == LossyLinks::Joint::hinge) {
    Eigen::Matrix<double, 6, 1> h = Eigen::Matrix<double, 6, 1>::Zero();
    h.tail<3>() = link.axis;
    joint = big(MatrixXd(h * h.transpose())) * (Big(1) / (Big(stiffness()(3, 3)) * c));
  }
  Step all{BigMatrix::Zero(rails * size, rails * size), BigMatrix::Zero(6 * rails, rails * size),
           BigMatrix::Zero(6 * rails, rails * size), BigMatrix::Zero(6 * rails, 6 * rails)};
  for (Index r = 0; r < rails; ++r) {
    all.Z.block(r * size, r * size, size, size) = Z;
    all.E.block(6 * r, r * size, 6, 6) = big(MatrixXd(MatrixXd::Identity(6, 6)));
    all.W.block(6 * r, r * size, 6, size) = W;
    all.joint.block(6 * r, 6 * r, 6, 6) = joint;
  }
  for (Index r = 0; r + 1 < rails; ++r) {
    const BigMatrix between = all.W.middleRows(6 * r, 6) - all.W.middleRows(6 * r + 6, 6);
    all.Z += between.transpose() * (big(stiffness()) * c) * between;
  }
  return all;
}

}  // namespace

namespace {

/// Displacements by a unit wrench at the tip (6 x 6): of the tip, of x_C of the first link.
struct Compliances {
  BigMatrix tip, first;
};

Compliances compliances(const LossyLinks& of, const Step& step) {
  const Index ports = 6 * of.rails;
  const auto free = [&](const BigMatrix& at, const BigMatrix& by) {
    return BigMatrix(at * solved(step.Z, by.transpose()));
  };
  const BigMatrix PP = free(step.E, step.E), PC = free(step.E, step.W), CP = PC.transpose(),
                  CC = free(step.W, step.W);
  BigMatrix below = BigMatrix::Zero(ports, ports), first;  // x_C over a wrench at C, of the ground
  std::vector<BigMatrix> passed;                           // -f_P over a wrench at C
  for (int i = 0; i < of.n; ++i) {
    if (i == 0 && of.base == LossyLinks::Base::free) {
      passed.push_back(BigMatrix::Zero(ports, ports));
      below = CC;
    } else {
      passed.push_back(solved(PP + below + step.joint, PC));  // x_P = -(below + joint) f_P
      below = CC - CP * passed.back();
    }
    if (i == 0) first = below;
  }
  BigMatrix at_first = BigMatrix::Zero(ports, 6);
  at_first.topRows(6) = big(MatrixXd(MatrixXd::Identity(6, 6)));
  for (std::size_t i = passed.size(); i-- > 1;) at_first = (passed[i] * at_first).eval();
  return {below.topLeftCorner(6, 6), (first * at_first).topRows(6)};
}

}  // namespace

MatrixXcd LossyLinks::exact(std::complex<double> at) const {
  const Big s = big(at);
  const auto [tip_by_force, base_by_force] = compliances(*this, step_of(*this, Link(*this), s));
  BigMatrix base_out = base_by_force * (s * s), tip_out = tip_by_force * (s * s);
  if (tip == Tip::motion) {
    const BigMatrix force = solved(tip_out, big(MatrixXd(MatrixXd::Identity(6, 6))));
    base_out = (base_out * force).eval(), tip_out = force;
  }
  MatrixXcd result(12, 6);
  for (Index i = 0; i < 12; ++i)
    for (Index j = 0; j < 6; ++j) {
      const Big& z = i < 6 ? base_out(i, j) : tip_out(i - 6, j);
      result(i, j) = {static_cast<double>(z.real()), static_cast<double>(z.imag())};
    }
  return result;
}

Diagram LossyLinks::diagram() const {
  const Link link(*this);
  const double c = loss(damping);
  const Bushing six{.stiffness = SixAxes(stiffness()),
                    .damping = SixAxes(Matrix66(c * stiffness()))};
  const bool rigid = modes == 0 && joint != Joint::clamp;
  const FlexibleBody body = rigid ? FlexibleBody(RigidBody{.mass = kMass,
                                                           .inertia = link.inertia,
                                                           .PA = link.PA,
                                                           .children = {{"C", link.PC}}})
                                  : FlexibleBody(link.data());
  Diagram d{"links"};
  std::vector<FlexibleBody::Handle> last;
  const auto u = d.input("u", 6);
  for (int i = 0; i < n; ++i)
    for (int r = 0; r < rails; ++r) {
      const std::string name = fmt::format("{:03}{}", i, "abc"[r]);
      const auto next = d.add("b" + name, body);
      const auto hang = [&](const auto& part) {
        if (i == 0)
          ground(part);
        else
          mount(part, last[static_cast<std::size_t>(r)].child("C"));
      };
      if (i == 0 && base == Base::free) {
        release(next);
      } else if (joint == Joint::clamp) {
        hang(next);
      } else if (joint == Joint::bushing) {
        const auto j = d.add("j" + name, six);
        hang(j), mount(next, j.child);
      } else {
        const auto h = d.add("j" + name, Hinge{link.axis});
        hang(h), mount(next, h.child);
        h.torque = stiffness()(3, 3) * h.angle + c * stiffness()(3, 3) * h.rate;
      }
      if (r > 0)
        bushing(d, "r" + name, next.child("C"), last[static_cast<std::size_t>(r - 1)].child("C"),
                Rotation(), six);
      if (i == 0)
        last.push_back(next);
      else
        last[static_cast<std::size_t>(r)] = next;
      if (i == 0 && r == 0) d.output("base", 6) = next.child("C").accel;
    }
  const auto end = last[0].child("C");
  if (tip == Tip::force)
    end.force += u, d.output("tip", 6) = end.accel;
  else
    end.accel = u, d.output("tip", 6) = end.force;
  return d;
}

double worst_block(const MatrixXcd& found, const MatrixXcd& exact, double share) {
  double worst = 0;
  for (Index i = 0; i < exact.rows(); i += 3)
    for (Index j = 0; j < exact.cols(); j += 3) {
      const auto largest = [&](Index row) {
        return exact.block(row, j, 3, 3).cwiseAbs().maxCoeff();
      };
      const double size = std::max(largest(i), share * largest(6 + i % 6));
      const double off = (found.block(i, j, 3, 3) - exact.block(i, j, 3, 3)).cwiseAbs().maxCoeff();
      if (size > 1e-290) worst = std::max(worst, off / size);
    }
  return worst;
}

}  // namespace titop_test
