#include <doctest/doctest.h>

#include "assembly.hpp"

/// A beam whose root has any subset of its six degrees of freedom free, the others locked or
/// driven: the same finite elements with those supports.

using namespace loops_test;
using namespace titop;
using Eigen::MatrixXcd;

namespace {

const Tube kTube{2, 0.05, 0.04, 3};
constexpr std::array<const char*, 6> kNames{"x", "y", "z", "rx", "ry", "rz"};

const char* name(Index i) { return kNames[static_cast<std::size_t>(i)]; }
Eigen::Vector3d axis(Index i) { return Eigen::Vector3d::Unit(i % 3); }

/// Bit i of `free`: degree of freedom i is free.
std::vector<Index> held(int free) {
  std::vector<Index> result;
  for (int i = 0; i < 6; ++i)
    if (!(free >> i & 1)) result.push_back(i);
  return result;
}

/// Each held one is driven by an input of its own, or locked.
void hold_directly(Diagram& d, const BodyHandle& b, const std::vector<Index>& list, bool driven) {
  const auto drive = [&](auto part, Index i) {
    if (driven)
      part = d.input(name(i));
    else
      part = 0;
  };
  for (const Index i : list)
    i < 3 ? drive(b.parent.accel.along(axis(i)), i) : drive(b.parent.accel.about(axis(i)), i);
  if (list.size() < 6) release(b);
}

/// A joint of six axes on a point of the ground, the held ones driven or locked.
void hold_by_joint(Diagram& d, const BodyHandle& b, const std::vector<Index>& list, bool driven) {
  auto base = d.add("base", RigidBody{.children = {{"C", {0, 0, 0}}}});
  ground(base);
  std::vector<Axis> axes;
  for (Index i = 0; i < 6; ++i)
    axes.push_back(i < 3 ? along(axis(i), name(i)) : about(axis(i), name(i)));
  auto j = joint(d, "joint", b, base.child("C"), {}, axes);
  for (const Index i : list) {
    auto motion = j.axis(name(i)).accel;
    if (driven)
      motion = d.input(name(i));
    else
      motion = 0;
  }
}

struct Fixed {
  by_hand::FreeBeam fe = by_hand::free_beam(kTube.numbers());
  MatrixXd rigid = by_hand::rigid_motion(kTube.numbers());

  std::vector<Index> others(const std::vector<Index>& list) const {
    std::vector<Index> result;
    for (Index i = 0; i < fe.M.rows(); ++i)
      if (std::find(list.begin(), list.end(), i) == list.end()) result.push_back(i);
    return result;
  }
  std::vector<Complex> poles(const std::vector<Index>& list) const {
    const std::vector<Index> free = others(list);
    by_hand::Structure a;
    a.M = fe.M(free, free), a.K = fe.K(free, free);
    const Index zeros =
        list.empty() ? 6 : 6 - Eigen::FullPivLU<MatrixXd>(rigid(list, Eigen::all)).rank();
    return elastic_poles(a, zeros);
  }
  /// Accelerations of the tip per acceleration of the held directions and per wrench at the tip.
  MatrixXcd tip(const std::vector<Index>& list, Complex s) const {
    const std::vector<Index> free = others(list);
    const MatrixXcd Z = s * s * fe.M.cast<Complex>() + fe.K.cast<Complex>();
    const auto count = static_cast<Index>(list.size());
    MatrixXcd wrench = MatrixXcd::Zero(Z.rows(), 6), by(static_cast<Index>(free.size()), count + 6);
    wrench.bottomRows(6).setIdentity();
    by.leftCols(count) = -MatrixXcd(Z(free, list)) / (s * s);
    by.rightCols(6) = wrench(free, Eigen::all);
    const MatrixXcd q = MatrixXcd(Z(free, free)).partialPivLu().solve(by);
    return s * s * q.bottomRows(6);
  }
};

}  // namespace

TEST_CASE("any of the six degrees of freedom locked: order and poles as the finite elements") {
  const FlexibleBody body = kTube.beam();
  const Fixed by_hand_;
  for (int free = 0; free < 64; ++free)
    for (const bool by_joint : {false, true}) {
      CAPTURE(free);
      CAPTURE(by_joint);
      Diagram d{"locked"};
      auto b = d.add("beam", body);
      (by_joint ? hold_by_joint : hold_directly)(d, b, held(free), /*driven=*/false);
      const System system = compile(d, {.minimize_up_to = 0});
      const auto exact = by_hand_.poles(held(free));
      // A joint's free axes have states of their own, the rigid motions among them.
      const std::size_t rigid = by_hand_.others(held(free)).size() - exact.size();
      const std::size_t moving = exact.size() + (by_joint ? rigid : 0);
      CHECK(system.state_space().order() == 2 * static_cast<int>(moving));
      std::vector<Complex> elastic = all_poles(system);
      std::erase_if(elastic, [&](Complex s) { return std::abs(s) < 0.01 * std::abs(exact[0]); });
      CHECK(by_hand::pole_error(elastic, exact) <= 1e-9);
    }
}

TEST_CASE(
    "any of the six degrees of freedom driven: the tip moves as that of the finite elements") {
  const FlexibleBody body = kTube.beam();
  const Fixed by_hand_;
  const Complex s(30, 400);
  for (int free = 0; free < 64; ++free)
    for (const bool by_joint : {false, true}) {
      CAPTURE(free);
      CAPTURE(by_joint);
      Diagram d{"driven"};
      auto b = d.add("beam", body);
      (by_joint ? hold_by_joint : hold_directly)(d, b, held(free), /*driven=*/true);
      b.child.force = d.input("wrench", 6);
      d.output("tip", 6) = b.child.accel;
      const System system = compile(d, {.minimize_up_to = 0});
      const MatrixXcd exact = by_hand_.tip(held(free), s);
      const auto error = [&](const MatrixXcd& G) {
        return (G - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
      };
      CHECK(error(system.transfer(s)) <= 1e-12);
      CHECK(error(system.state_space().transfer(s)) <= 1e-10);
    }
}
