#pragma once

#include <titop/blocks/exact_beam.hpp>
#include <titop/titop.hpp>

/// A body on a free hinge: its reaction has no torque about the axis, but for rounding.
namespace titop_test {

inline const titop::ExactBeam kBoom{.length = 3,
                                    .section = titop::tube(0.08, 0.07),
                                    .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                                    .damping = {.mass = 0.02, .stiffness = 2e-5}};
inline const titop::Scene kHingeScene{.band_hz = {0.1, 50}, .accuracy = 1e-3};
constexpr int kAboutAxis = 4;  ///< row of the torque about y

/// A hub with a boom, whose tip carries a body on a hinge about y. Outputs: these combinations of
/// the components of the reaction, and the hub's acceleration.
template <class Boom>
titop::Diagram hinged_load(const Boom& beam, const Eigen::MatrixXd& reads) {
  titop::Diagram d{"hinged load"};
  auto hub = d.add("hub", titop::RigidBody{.mass = 60,
                                           .inertia = titop::Vector3d{5, 6, 7}.asDiagonal(),
                                           .children = {{"c", {0.4, 0.1, 0.2}}}});
  auto boom = d.add("boom", beam);
  auto load =
      d.add("load", titop::RigidBody{.mass = 3,
                                     .inertia = titop::Vector3d{0.2, 0.3, 0.25}.asDiagonal(),
                                     .PA = {0.3, 0.1, 0.2}});
  hub.parent.force = -d.input("F", 6);
  mount(boom, hub.child);
  auto h = hinge(d, "h", load, boom.child("C"), titop::Rotation::about({1, 2, 3}, 0.7), {0, 1, 0});
  h.torque = 0;
  d.output("r", static_cast<int>(reads.rows())) = reads * load.parent.reaction;
  d.output("a", 6) = hub.parent.accel;
  return d;
}

inline Eigen::MatrixXd whole_reaction() { return Eigen::MatrixXd::Identity(6, 6); }

/// Without the torque about the axis.
inline Eigen::MatrixXd other_components() {
  Eigen::MatrixXd reads(5, 6);
  reads << whole_reaction().topRows(kAboutAxis), whole_reaction().bottomRows(5 - kAboutAxis);
  return reads;
}

/// The rows of all other outputs.
inline Eigen::MatrixXd without_zero(const Eigen::MatrixXd& pairs) {
  Eigen::MatrixXd rest(pairs.rows() - 1, pairs.cols());
  rest << pairs.topRows(kAboutAxis), pairs.bottomRows(pairs.rows() - 1 - kAboutAxis);
  return rest;
}

/// Entries differ by no more than this share of each, or by 1e-11 of the largest: ten times the
/// accuracy of a transfer.
inline bool alike(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double share) {
  const Eigen::ArrayXXd allowed =
      (share * b.cwiseAbs()).array().max(1e-11 * b.cwiseAbs().maxCoeff());
  return a.rows() == b.rows() && a.cols() == b.cols() && ((a - b).array().abs() <= allowed).all();
}

/// The torque about x times this, as in another unit.
inline Eigen::MatrixXd scaled_torque(double factor) {
  Eigen::MatrixXd reads = other_components();
  reads(3, 3) = factor;
  return reads;
}

}  // namespace titop_test
