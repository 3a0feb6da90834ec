#pragma once

#include <Eigen/Geometry>
#include <array>

#include "assembly.hpp"

/// Four-bar mechanisms: ground, crank, coupler and rocker with pins about z, the crank locked.
namespace loops_test {

/// Lengths of crank, coupler, rocker, and between the fixed pins (Grashof: the crank turns round).
inline constexpr std::array<double, 4> kLength{0.3, 0.9, 0.7, 0.8};

/// Angles of the three links against the ground for a crank angle, the upper branch.
inline std::array<double, 3> posture(double crank) {
  const double x = kLength[0] * std::cos(crank) - kLength[3], y = kLength[0] * std::sin(crank);
  const double r = std::hypot(x, y);  // from the rocker's pin to the crank's tip
  const double at_pin =
      std::acos((r * r + kLength[2] * kLength[2] - kLength[1] * kLength[1]) / (2 * r * kLength[2]));
  const double rocker = std::atan2(y, x) - at_pin;
  const double tip_x = kLength[3] + kLength[2] * std::cos(rocker),
               tip_y = kLength[2] * std::sin(rocker);
  return {crank, std::atan2(tip_y - y, tip_x - (x + kLength[3])), rocker};
}

inline titop::Rotation turn(double angle) { return titop::Rotation::about({0, 0, 1}, angle); }

inline Tube link(int i) { return {kLength[static_cast<std::size_t>(i)], 0.04, 0.03, 3}; }

/// The beam's finite elements in its plane only: x, y and rotation about z of every node.
inline titop::ModalData in_plane(const Tube& tube) {
  const by_hand::Beam beam = tube.numbers();
  const by_hand::FreeBeam fe = by_hand::free_beam(beam);
  const MatrixXd R = by_hand::rigid_motion(beam);
  std::vector<Index> free;
  for (Index node = 1; node <= tube.elements; ++node)
    for (const Index i : {0, 1, 5}) free.push_back(6 * node + i);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(fe.K(free, free),
                                                                 fe.M(free, free));
  const MatrixXd& V = modes.eigenvectors();
  titop::ModalData d;
  d.omega = modes.eigenvalues().cwiseSqrt();
  d.xi = VectorXd::Zero(d.omega.size());
  d.L_P = V.transpose() * fe.M(free, Eigen::all) * R;
  d.L_P(Eigen::all, std::vector<Index>{2, 3, 4}).setZero();
  d.D_P = R.transpose() * fe.M * R;
  MatrixXd Phi = MatrixXd::Zero(6, V.cols());
  for (Index i = 0; i < 3; ++i) Phi.row(i < 2 ? i : 5) = V.row(V.rows() - 3 + i);
  d.children.push_back({"C", {tube.length, 0, 0}, Phi});
  return d;
}

enum class Space { planar, full };
/// driven: a wrench on the crank's tip, in its frame, and the acceleration there.
enum class Ports { none, driven };

/// Crank clamped at its angle, pins at the other three corners.
inline titop::Diagram mechanism(double crank, Space space, Ports ports = Ports::none) {
  const auto angle = posture(crank);
  titop::Diagram d{"four-bar"};
  auto base =
      d.add("base", titop::RigidBody{.mass = 1, .children = {{"J1"}, {"J2", {kLength[3], 0, 0}}}});
  ground(base);
  std::vector<titop::BodyHandle> b;
  b.reserve(3);
  for (int i = 0; i < 3; ++i)
    b.push_back(d.add("link" + std::to_string(i + 1),
                      space == Space::full ? titop::FlexibleBody{link(i).beam()}
                                           : titop::FlexibleBody{in_plane(link(i))}));
  const Eigen::Vector3d z{0, 0, 1};
  mount(b[0], base.child("J1"), turn(angle[0]));
  hinge(d, "p12", b[1], b[0].child, turn(angle[1] - angle[0]), z).torque = 0;
  hinge(d, "p30", b[2], base.child("J2"), turn(angle[2]), z).torque = 0;
  auto p23 = d.add("p23", titop::Hinge{z});
  p23.torque = 0;
  mount(p23, b[2].child, turn(angle[1] - angle[2]));
  weld(b[1].child, p23.child);  // closes the chain
  if (ports == Ports::driven) {
    b[0].child.force += d.input("U", 6);
    d.output("a", 6) = b[0].child.accel;
  }
  return d;
}

/// Coordinates: crank's nodes, coupler's nodes, rocker's inner nodes, then the three pins' angles.
inline by_hand::Structure mechanism_by_hand(double crank, Space space) {
  const auto angle = posture(crank);
  const Index own = 6 * link(0).elements, inner = own - 6, n = 2 * own + inner + 3;
  Assembly r(n, 6, 6);
  const auto into = [&](int from, int to) {
    return by_hand::dual(Eigen::AngleAxisd(angle[static_cast<std::size_t>(from)] -
                                               angle[static_cast<std::size_t>(to)],
                                           Eigen::Vector3d::UnitZ())
                             .toRotationMatrix());
  };
  const auto pin = [&](Index i) {
    MatrixXd rows = MatrixXd::Zero(6, n);
    rows(5, n - 3 + i) = 1;
    return rows;
  };
  const MatrixXd tip1 = r.unit(inner, 6), tip2 = r.unit(own + inner, 6);
  r.beam(link(0).numbers(), MatrixXd::Zero(6, n), tip1, 0);
  r.beam(link(1).numbers(), into(0, 1) * tip1 + pin(0), tip2, own);
  r.beam(link(2).numbers(), pin(1), into(1, 2) * tip2 + pin(2), 2 * own);
  r.a.C = tip1;
  r.a.B = tip1.transpose();
  if (space == Space::full) return r.a;
  std::vector<Index> plane;
  for (Index i = 0; i < n - 3; ++i)
    if (i % 6 == 0 || i % 6 == 1 || i % 6 == 5) plane.push_back(i);
  for (Index i = n - 3; i < n; ++i) plane.push_back(i);
  by_hand::Structure a = r.a;
  a.M = r.a.M(plane, plane), a.D = r.a.D(plane, plane), a.K = r.a.K(plane, plane);
  a.C = r.a.C(Eigen::all, plane), a.B = r.a.B(plane, Eigen::all);
  return a;
}

}  // namespace loops_test
