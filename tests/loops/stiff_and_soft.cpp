#include <doctest/doctest.h>

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <titop/graph/linalg/index.hpp>
#include <titop/titop.hpp>

#include "support/rng.hpp"

/// Stiff and soft in one chain: independence is decided by geometry, not by springs.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using titop_test::Rng;
using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;
using Matrix50 = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using titop::linalg::at;

namespace {

/// No chain is reported as narrow or singular.
void check_chains(const System& system) {
  for (const Note& note : system.notes()) {
    CAPTURE(note.text);
    CHECK_FALSE(
        (note.kind == Note::Kind::warning && (note.pass == "chains" || note.pass == "close")));
  }
}

/// A^-1, of a symmetric positive definite matrix: without pivoting.
Matrix50 inverse(Matrix50 A) {
  for (Index k = 0; k < A.rows(); ++k) {
    const Real pivot = 1 / A(k, k);
    A(k, k) = 1;
    A.row(k) *= pivot;
    for (Index i = 0; i < A.rows(); ++i) {
      if (i == k) continue;
      const Real l = A(i, k);
      A(i, k) = 0;
      A.row(i) -= l * A.row(k);
    }
  }
  return A;
}

/// Rigid bodies on bushings between them and the ground, number 0, in frames of any kind.
struct Frame {
  struct Edge {
    int a, b;                 ///< bodies; in the frame of a
    Vector3d from_a, from_b;  ///< to where it is, in their frames
    Vector6 stiffness;
  };
  std::vector<Matrix3d> frames{Matrix3d::Identity()};
  std::vector<Edge> edges = {};

  int bodies() const { return static_cast<int>(frames.size()) - 1; }
  static Vector6 inertia() { return (Vector6() << 2, 2, 2, 0.5, 0.6, 0.7).finished(); }
  Matrix3d between(const Edge& e) const { return frames[at(e.b)].transpose() * frames[at(e.a)]; }
};

/// `loops` more bushings than needed to support all bodies; stiffnesses between 1 and 2^octaves.
Frame random_frame(std::uint64_t seed, int loops, int octaves) {
  Rng rng(seed);
  Frame f;
  std::vector<Vector3d> places{Vector3d::Zero()};
  const int bodies = 1 + rng.below(3);
  const auto connect = [&](int a, int b) {
    const Vector3d place = rng.matrix(3, 1);
    Frame::Edge e{a,
                  b,
                  f.frames[at(a)].transpose() * (place - places[at(a)]),
                  f.frames[at(b)].transpose() * (place - places[at(b)]),
                  {}};
    for (double& k : e.stiffness) k = rng.octaves(0, octaves + 1);
    f.edges.push_back(e);
  };
  for (int i = 1; i <= bodies; ++i) {
    f.frames.push_back(rng.rotation());
    places.push_back(rng.matrix(3, 1));
    connect(i, rng.below(i));
  }
  for (int i = 0; i < loops; ++i) {
    const int a = 1 + rng.below(bodies);
    connect(a, rng.below(a));
  }
  return f;
}

Diagram diagram(const Frame& f) {
  Diagram d{"frame"};
  std::vector<RigidBody> specs(f.frames.size());
  for (RigidBody& spec : specs) {
    spec.mass = Frame::inertia()(0);
    spec.inertia = Frame::inertia().tail<3>().asDiagonal();
    spec.children.push_back({"push"});
  }
  const auto name = [](std::size_t k) { return "bushing" + std::to_string(k); };
  for (std::size_t k = 0; k < f.edges.size(); ++k) {
    specs[at(f.edges[k].a)].children.push_back({name(k), f.edges[k].from_a});
    specs[at(f.edges[k].b)].children.push_back({name(k), f.edges[k].from_b});
  }
  std::vector<BodyHandle> bodies;
  for (std::size_t i = 0; i < specs.size(); ++i)
    bodies.push_back(d.add("body" + std::to_string(i), specs[i]));
  ground(bodies[0]);
  for (std::size_t k = 0; k < f.edges.size(); ++k) {
    const Frame::Edge& e = f.edges[k];
    bushing(d, name(k), bodies[at(e.a)].child(name(k)), bodies[at(e.b)].child(name(k)),
            Rotation::matrix(f.between(e)), {.stiffness = e.stiffness});
  }
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    release(bodies[i]);
    bodies[i].child("push").force += d.input("F" + std::to_string(i), 6);
    d.output("a" + std::to_string(i), 6) = bodies[i].parent.accel;
  }
  return d;
}

/// Motion of a point of a body, from the body's motion.
Matrix6 moved(const Vector3d& point) {
  Matrix6 result = Matrix6::Identity();
  result.topRightCorner<3, 3>() << 0, point.z(), -point.y(), -point.z(), 0, point.x(), point.y(),
      -point.x(), 0;
  return result;
}

MatrixXd by_hand_at(const Frame& f, double s) {
  const Index n = 6 * f.bodies();
  Matrix50 H = Matrix50::Zero(n, n);
  for (Index i = 0; i < n; ++i) H(i, i) = Real(Frame::inertia()(i % 6)) * s * s;
  for (const Frame::Edge& e : f.edges) {
    MatrixXd stretch = MatrixXd::Zero(6, n);
    stretch.middleCols(6 * (e.a - 1), 6) = moved(e.from_a);
    Matrix6 into = Matrix6::Zero();
    into.topLeftCorner<3, 3>() = into.bottomRightCorner<3, 3>() = f.between(e).transpose();
    if (e.b > 0) stretch.middleCols(6 * (e.b - 1), 6) = -into * moved(e.from_b);
    const Matrix50 q = stretch.cast<Real>();
    H += q.transpose() * e.stiffness.cast<Real>().asDiagonal() * q;
  }
  return (Real(s) * s * inverse(H)).cast<double>();
}

}  // namespace

TEST_CASE("three springs side by side, up to 1e20 times as stiff: two stretches follow") {
  for (const double ratio : {1.0, 1e8, 1e16, 1e20})
    for (std::size_t soft = 0; soft < 3; ++soft) {
      CAPTURE(ratio);
      CAPTURE(soft);
      Diagram d{"springs"};
      std::vector<SpringMass::Handle> z;
      double stiffness = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double k = (i == soft ? 3 : 2 + static_cast<double>(i)) * (i == soft ? 1 : ratio);
        z.push_back(d.add("z" + std::to_string(i), SpringMass{.mass = 0.5, .stiffness = k}));
        ground(z.back());
        stiffness += k;
      }
      z[1].child.accel = z[0].child.accel;
      z[2].child.accel = z[0].child.accel;
      z[0].child.force = d.input("u") - z[1].child.force - z[2].child.force;
      d.output("x") = z[soft].stretch;
      const System system = compile(d);
      CHECK(system.order() == 2);
      check_chains(system);
      const double s = std::sqrt(stiffness) / 3;
      const double exact = 1 / (1.5 * s * s + stiffness);
      CHECK(std::abs(system.transfer(s)(0, 0) - exact) <= 1e-14 * exact);
    }
}

TEST_CASE("bodies on bushings in space, axes up to 2^53 times as stiff as others") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed)
    for (const int octaves : {0, 13, 27, 40, 53}) {
      CAPTURE(seed);
      CAPTURE(octaves);
      const Frame f = random_frame(seed, 1 + static_cast<int>(seed % 3), octaves);
      const System system = compile(diagram(f));
      CHECK(system.order() == 12 * f.bodies());
      check_chains(system);
      const MatrixXd exact = by_hand_at(f, 0.7);
      CHECK((system.transfer(0.7) - exact).cwiseAbs().maxCoeff() <=
            1e-11 * exact.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("a platform on two flexible bodies, modes of 1 rad/s beside 1e10 rad/s in every axis") {
  for (const double fast : {1.0, 1e4, 1e6, 1e8, 1e10}) {
    CAPTURE(fast);
    // One mode per axis; the softer of the two bodies is the first in half of the axes.
    const std::array<VectorXd, 2> omega = {
        (VectorXd(6) << 1, 2 * fast, 2 * fast, fast, 1.5, 0.5 * fast).finished(),
        (VectorXd(6) << fast, 3, 3 * fast, fast, 2 * fast, fast).finished()};
    const std::array<VectorXd, 2> shape = {
        (VectorXd(6) << 0.5, 0.4, 0.6, 0.7, 0.3, 0.5).finished(),
        (VectorXd(6) << 0.3, 0.5, 0.4, 0.6, 0.6, 0.4).finished()};
    Diagram d{"platform"};
    auto base = d.add("base", RigidBody{.children = {{"C0"}, {"C1"}}});
    auto top = d.add(
        "top",
        RigidBody{.mass = 3, .inertia = Matrix3d::Identity(), .children = {{"other"}, {"push"}}});
    ground(base);
    std::vector<FlexibleBody::Handle> legs;
    for (std::size_t i = 0; i < 2; ++i) {
      ModalData data;
      data.omega = omega[i];
      data.xi = VectorXd::Zero(6);
      data.L_P = MatrixXd::Zero(6, 6);
      data.D_P.diagonal() << 4, 4, 4, 1, 1, 1;
      data.children.push_back({"C", {0, 0, 0}, shape[i].asDiagonal()});
      legs.push_back(d.add("leg" + std::to_string(i), FlexibleBody{data}));
      mount(legs[i], base.child("C" + std::to_string(i)));
    }
    mount(top, legs[0].child("C"));
    weld(legs[1].child("C"), top.child("other"));
    top.child("push").force += d.input("F", 6);
    d.output("a", 6) = top.parent.accel;
    const System system = compile(d);
    CHECK(system.order() == 12);
    check_chains(system);
    const double s = 0.7;
    const MatrixXcd found = system.transfer(s);
    VectorXd exact(6);
    for (Index i = 0; i < 6; ++i) {
      double impedance = (i < 3 ? 3 : 1) * s * s;
      for (std::size_t leg = 0; leg < 2; ++leg)
        impedance += (s * s + omega[leg](i) * omega[leg](i)) / (shape[leg](i) * shape[leg](i));
      exact(i) = s * s / impedance;
    }
    for (Index i = 0; i < 6; ++i) CHECK(std::abs(found(i, i) - exact(i)) <= 1e-12 * exact(i));
    CHECK((found - MatrixXcd(found.diagonal().asDiagonal())).cwiseAbs().maxCoeff() <=
          1e-14 * exact.maxCoeff());
  }
}
