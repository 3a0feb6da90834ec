#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

/// An algebraic loop 2^-k from singular: a body of mass m whose acceleration adds g times itself to
/// its force, g = m (1 + 2^-k), along x and z. A force that follows vx - 0.003 wz moves it along
/// the fixed direction f. Transfers cancel between columns of A by as much as the loop.

using namespace titop;
using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kMass = 0.44, kShare = -0.003;
const Vector3d kForce(0.77, 0.15, 0.71);

double gain(int k) { return kMass * (1 + std::exp2(-k)); }

Diagram steep(int k) {
  Diagram d{"steep"};
  auto torque = d.input("t", 3);
  auto body =
      d.add("body", RigidBody{.mass = kMass, .inertia = {1, 1, 1}, .children = {{"C", {0, 0, 0}}}});
  auto loop = d.add("loop", MatrixGain{Vector3d(gain(k), 0, gain(k)).asDiagonal()});
  auto follow = d.add("follow", MatrixGain{MatrixXd(kForce)});
  loop.in = Eigen::Matrix3d(Vector3d(1, 0, 1).asDiagonal()) * body.parent.accel.linear;
  follow.in = MatrixXd{{1, 0, 0, 0, 0, kShare}} * body.parent.rate;
  body.parent.force.linear += -loop.out;
  body.child("C").force.linear += follow.out;
  body.child("C").force.angular += torque;
  d.output("v", 3) = body.parent.rate.linear();
  return d;
}

/// v by the torque about z: with mu = m - g, mu s vx = fx (vx - 0.003 wz), and s wz = t.
Eigen::Vector3cd by_hand(int k, Complex s) {
  const double mu = kMass - gain(k);
  const Complex wz = 1.0 / s, vx = kShare * kForce.x() * wz / (mu * s - kForce.x()),
                along = mu * s * vx / kForce.x();  // vx - 0.003 wz
  return {vx, kForce.y() * along / (kMass * s), kForce.z() * along / (mu * s)};
}

/// A, B, C, D column by column.
StateSpace through_apply(const System& system) {
  StateSpace m;
  const Eigen::Index n = system.order(), nu = 3, ny = 3;
  m.A.resize(n, n), m.B.resize(n, nu), m.C.resize(ny, n), m.D.resize(ny, nu);
  for (Eigen::Index j = 0; j < n + nu; ++j) {
    const VectorXd known = VectorXd::Unit(n + nu, j);
    const System::Rates r = system.apply(known.head(n), known.tail(nu));
    (j < n ? m.A.col(j) : m.B.col(j - n)) = r.xdot;
    (j < n ? m.C.col(j) : m.D.col(j - n)) = r.y;
  }
  return m;
}

}  // namespace

TEST_CASE("solver: a loop of gains up to 1e-6 from singular keeps its digits on every road") {
  for (const int k : {1, 6, 9, 10, 13, 16, 20}) {
    CAPTURE(k);
    const System system = compile(steep(k), {.minimize_up_to = 0});
    const StateSpace columns = through_apply(system);
    for (const Complex s : {Complex(0, 0.4), Complex(0.1, 2)}) {
      const Eigen::Vector3cd right = by_hand(k, s);
      const auto error = [&](const Eigen::MatrixXcd& G) {
        return ((G.col(2) - right).cwiseAbs().array() / right.cwiseAbs().array()).maxCoeff();
      };
      CHECK(error(system.transfer(s)) <= 1e-12);
      CHECK(error(system.state_space().transfer(s)) <= 1e-8);
      CHECK(error(columns.transfer(s)) <= 1e-8);
    }
  }
}
