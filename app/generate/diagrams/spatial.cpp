#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/slide.hpp>
#include <titop/graph/linalg/eigen.hpp>

#include "generate/diagrams/draft.hpp"
#include "generate/diagrams/modes.hpp"

/// Assemblies with six degrees of freedom per junction.
namespace titop::generate {

using Eigen::MatrixXd;

namespace {

struct DrawnBody {
  std::string name;
  std::vector<std::string> sites;  ///< one per body mounted here, and "T" for everything else
  int modes = 0;
  bool stiff = false;  ///< a beam: prescribing both of its ends loses the digits of (omega / s)^2
};

const ModalData& beam_data() {
  static const ModalData data = modal_data(Beam{.length = 1.5,
                                                .section = rectangle(0.05, 0.08),
                                                .material = {.E = 70e6, .nu = 0.33, .rho = 2700},
                                                .elements = 2,
                                                .modes = {.kept = 8}});
  return data;
}

/// The beam with all its sites at its end.
ModalData beam_with(const std::vector<std::string>& sites, bool damped) {
  ModalData data = beam_data();
  const ModalChild end = data.children.front();
  data.children.clear();
  for (const std::string& site : sites) data.children.push_back({site, end.PC, end.Phi_C});
  if (damped) data.xi.setConstant(0.01);
  return data;
}

RandomDiagram::Step rigid_step(Rng& rng, const DrawnBody& body) {
  const ModalData like = random_modes(rng, 0, body.sites, false);
  const double m = like.D_P(0, 0);
  const Vector3d PA = rng.matrix(3, 1);
  const Matrix3d inertia =
      rigid_mass(0, rng.between(0.5, 2) * Matrix3d::Identity() * m, PA).bottomRightCorner<3, 3>();
  return [=](Build& b) {
    const double L = b.units.length, M = b.units.mass;
    RigidBody spec{.mass = m * M, .inertia = inertia * M * L * L, .PA = PA * L};
    for (const ModalChild& c : like.children) spec.children.push_back({c.name, c.PC * L});
    b.bodies.emplace(body.name, b.d.add(body.name, spec));
  };
}

DrawnBody draw_body(Draft& d, int children) {
  DrawnBody body{d.fresh("b"), {}, 0};
  d.bodies.push_back(body.name);
  for (int i = 1; i <= children; ++i) body.sites.push_back(fmt::format("C{}", i));
  body.sites.push_back("T");
  const int kind = d.rng.below(5);
  if (kind < 2) {
    d.add(rigid_step(d.rng, body));
    return body;
  }
  body.stiff = kind == 2;
  body.modes = body.stiff ? 8 : 1 + d.rng.below(8);
  const ModalData data = kind == 2 ? beam_with(body.sites, d.damped())
                                   : random_modes(d.rng, body.modes, body.sites, d.damped());
  d.add([=](Build& b) {
    b.bodies.emplace(body.name, b.d.add(body.name, FlexibleBody(scaled(data, b.units))));
  });
  return body;
}

Rotation draw_rotation(Draft& d) {
  const int kind = d.rng.below(4);
  if (kind == 0) return {};
  const Rotation T = Rotation::matrix(d.rng.rotation());
  return kind == 1 ? T * Rotation::matrix(d.rng.rotation()).inverse() : T;
}

Vector3d draw_axis(Draft& d) {
  if (d.rng.chance(0.3)) return Vector3d::Unit(d.rng.below(3));
  Vector3d r = d.rng.matrix(3, 1);
  return r.norm() > 0.1 ? r : Vector3d(Vector3d::UnitZ());
}

/// The drive of the joint: none, spring and damper, a motor, a controller, a lock, a motion.
void draw_mechanism(Draft& d, const std::string& h, bool turns) {
  const Dim position = turns ? kAngle : kLength, force = turns ? kTorque : kForce;
  const Dim stiffness{force.length - position.length, force.mass, force.time};
  int kind = d.rng.below(6);
  if (kind == 3 && !d.options.controllers) kind = 1;
  if ((kind == 2 && !d.has_inputs) || (kind == 5 && !d.may_prescribe())) kind = 1;
  const double k = d.rng.octaves(2, 8);
  const double c = kind == 1 && !d.damped() ? 0 : d.rng.octaves(-2, 2);
  if (kind != 1 && kind != 3) ++d.drawn.loose;
  if (kind == 0) d.equation([=](Build& b) { b.joints.at(h).axis.force = 0; });
  if (kind == 4) d.equation([=](Build& b) { b.joints.at(h).axis.accel = 0; });
  if (kind == 1)
    d.equation([=](Build& b) {
      const double unit = stiffness.factor(b.units);
      const auto& axis = b.joints.at(h).axis;
      axis.force = k * unit * axis.position + c * unit * b.units.time * axis.rate;
    });
  if (kind == 2 || kind == 5) {
    const std::string u = d.input({kind == 2 ? force : turns ? kAngularAccel : kAccel});
    if (kind == 2) d.equation([=](Build& b) { b.joints.at(h).axis.force = -b.inputs.at(u); });
    if (kind == 5) d.equation([=](Build& b) { b.joints.at(h).axis.accel = b.inputs.at(u); });
  }
  if (kind == 3) {
    const std::string K = draw_filter(d, position, force, 4, k);
    d.equation([=](Build& b) { b.filters.at(K).in = b.joints.at(h).axis.position; });
    d.equation([=](Build& b) { b.joints.at(h).axis.force = b.filters.at(K).out; });
  }
  if (!d.has_outputs || !d.rng.chance(0.5)) return;
  d.output({position}, [=](Build& b) { return b.joints.at(h).axis.position.expr(); });
  if (kind >= 4) d.output({force}, [=](Build& b) { return b.joints.at(h).axis.force.expr(); });
}

/// Adds a hinge or a slide; which of them, the axis has decided, so that no number is drawn for it.
bool draw_axis_joint(Draft& d, const std::string& h) {
  const Vector3d r = draw_axis(d);
  const bool turns = r.x() >= 0;
  d.add([=](Build& b) {
    if (turns) {
      const auto j = b.d.add(h, Hinge{r});
      b.joints.emplace(h, Build::OneAxis{j.child, j.parent, {j.accel, j.torque, j.angle, j.rate}});
    } else {
      const auto j = b.d.add(h, Slide{r});
      b.joints.emplace(h, Build::OneAxis{j.child, j.parent, {j.accel, j.force, j.travel, j.rate}});
    }
  });
  return turns;
}

void draw_joint(Draft& d, const DrawnBody& body, const DrawnBody& on, const std::string& site) {
  const Rotation T = draw_rotation(d);
  const std::string a = body.name, p = on.name;
  const int kind = d.rng.below(4);
  if (kind == 0) {
    const std::string h = d.fresh("h");
    const bool turns = draw_axis_joint(d, h);
    d.equation([=](Build& b) { mount(b.joints.at(h), b.bodies.at(p).child(site), T); });
    d.equation([=](Build& b) { mount(b.bodies.at(a), b.joints.at(h).child); });
    draw_mechanism(d, h, turns);
  } else if (kind == 1) {
    d.equation([=](Build& b) {
      b.bodies.at(a).parent.accel = T.named(p, a).inverse() * b.bodies.at(p).child(site).accel;
    });
    d.equation([=](Build& b) {
      b.bodies.at(p).child(site).force += T.named(p, a) * b.bodies.at(a).parent.force;
    });
  } else {
    d.equation([=](Build& b) { mount(b.bodies.at(a), b.bodies.at(p).child(site), T); });
  }
}

void hold_partly(Draft& d, const std::string& a, Root root) {
  if (root == Root::sliding) {
    const Vector3d r = draw_axis(d);
    d.equation([=](Build& b) { b.bodies.at(a).parent.accel.along(r) = 0; });
    d.equation([=](Build& b) { release(b.bodies.at(a)); });
    return;
  }
  const bool pinned = root == Root::pinned, driven = d.has_inputs && d.rng.chance(0.5);
  const Dim q = pinned ? kTorque : kForce;
  const std::string u = driven ? d.input({q, q, q}) : "";
  d.equation([=](Build& b) {
    const auto& P = b.bodies.at(a).parent;
    (pinned ? P.accel.linear : P.accel.angular) = 0;
  });
  d.equation([=](Build& b) {
    const auto& P = b.bodies.at(a).parent;
    const auto& f = pinned ? P.force.angular : P.force.linear;
    if (driven)
      f = -b.inputs.at(u);
    else
      f = 0;
  });
}

void draw_force(Draft& d, const std::string& a) {
  const int kind = d.rng.below(3);
  const Vector3d r = draw_axis(d);
  const std::string u = d.input(kind == 0   ? dual(kForce, kTorque)
                                : kind == 1 ? std::vector<Dim>{kForce, kForce, kForce}
                                            : std::vector<Dim>{kForce});
  d.equation([=](Build& b) {
    const auto C = b.bodies.at(a).child("T");
    if (kind == 0) C.force += b.inputs.at(u);
    if (kind == 1) C.force.linear += b.inputs.at(u);
    if (kind == 2) C.force.along(r) -= b.inputs.at(u);
  });
}

void draw_output(Draft& d, const std::string& a) {
  const Vector3d r = draw_axis(d);
  const auto six = dual(kAccel, kAngularAccel);
  switch (d.rng.below(4)) {
    case 0: d.output(six, [=](Build& b) { return b.bodies.at(a).child("T").accel.expr(); }); break;
    case 1: d.output(six, [=](Build& b) { return b.bodies.at(a).parent.accel.expr(); }); break;
    case 2:
      d.output({kAngularAccel, kAngularAccel, kAngularAccel},
               [=](Build& b) { return b.bodies.at(a).child("T").accel.angular.expr(); });
      break;
    default:
      d.output({kAccel}, [=](Build& b) { return b.bodies.at(a).child("T").accel.along(r).expr(); });
  }
}

/// Collocated feedback of accelerations: it adds to the mass, so that the loop is never singular.
void draw_controller(Draft& d, const std::string& a) {
  if (d.rng.chance(0.5)) {
    const Vector3d r = draw_axis(d);
    const std::string K = draw_filter(d, kAccel, kForce, 0.1, d.rng.between(0.1, 2));
    d.equation([=](Build& b) { b.filters.at(K).in = b.bodies.at(a).child("T").accel.along(r); });
    d.equation([=](Build& b) { b.bodies.at(a).child("T").force.along(r) -= b.filters.at(K).out; });
    return;
  }
  const std::string G = d.fresh("G");
  const MatrixXd half = d.rng.matrix(6, 6) / 4;
  d.add([=](Build& b) {
    Vector6 unit = Vector6::Ones();
    unit.tail<3>().setConstant(b.units.length);
    const MatrixXd mass = unit.asDiagonal() * half * half.transpose() * unit.asDiagonal();
    b.gains.emplace(G, b.d.add(G, MatrixGain{b.units.mass * mass}));
  });
  d.equation([=](Build& b) { b.gains.at(G).in = b.bodies.at(a).child("T").accel; });
  d.equation([=](Build& b) { b.bodies.at(a).child("T").force -= b.gains.at(G).out; });
}

/// A row of spring-masses along one direction of the body.
void draw_slosh(Draft& d, const std::string& a) {
  const Vector3d r = draw_axis(d);
  const std::string z = draw_spring(d, false);
  d.equation(
      [=](Build& b) { b.springs.at(z).parent.accel = b.bodies.at(a).child("T").accel.along(r); });
  d.equation(
      [=](Build& b) { b.bodies.at(a).child("T").force.along(r) += b.springs.at(z).parent.force; });
  use_spring(d, z);
  if (!d.rng.chance(0.4)) return;
  const std::string next = draw_spring(d, false);
  d.equation([=](Build& b) { mount(b.springs.at(next), b.springs.at(z).child); });
  use_spring(d, next);
}

/// Fixes the tip: by the ground if nothing else does, by an input if the modes can follow.
void draw_tip(Draft& d, const DrawnBody& body, Root root) {
  const std::string a = body.name;
  const Vector3d r = draw_axis(d);
  const int kind = d.rng.below(2);
  if (root == Root::released && d.rng.chance(0.3)) {
    d.equation([=](Build& b) {
      const auto C = b.bodies.at(a).child("T");
      if (kind == 0) C.accel = 0;
      if (kind == 1) C.accel.linear = 0;
    });
    if (d.has_outputs)
      d.output(dual(kForce, kTorque),
               [=](Build& b) { return b.bodies.at(a).child("T").reaction.expr(); });
  } else if (d.may_prescribe() && body.modes >= 6 && !body.stiff && d.rng.chance(0.3)) {
    const std::string u =
        d.input(kind == 0 ? dual(kAccel, kAngularAccel) : std::vector<Dim>{kAccel});
    if (root != Root::released) d.drawn.loose += kind == 0 ? 6 : 1;
    d.equation([=](Build& b) {
      const auto C = b.bodies.at(a).child("T");
      if (kind == 0) C.accel = b.inputs.at(u);
      if (kind == 1) C.accel.along(r) = b.inputs.at(u);
    });
  }
}

void read_support(Draft& d, const std::string& root, const std::string& seen) {
  if (d.rng.chance(0.5))
    d.output(dual(kForce, kTorque),
             [=](Build& b) { return b.bodies.at(root).parent.force.expr(); });
  if (d.rng.chance(0.5))
    d.output(dual(kLength, kAngle),
             [=](Build& b) { return b.bodies.at(seen).parent.position.expr(); });
}

}  // namespace

void draw_spatial(Draft& d, int count, bool with_springs) {
  const std::vector<int> parent = draw_tree(d, count);
  std::vector<int> children(parent.size(), 0);
  for (std::size_t i = 1; i < parent.size(); ++i) ++children[static_cast<std::size_t>(parent[i])];
  std::vector<DrawnBody> bodies;
  for (const int c : children) bodies.push_back(draw_body(d, c));
  const auto first = [name = bodies.front().name](Build& b) { return b.bodies.at(name); };
  const Root root = draw_root(d, 6);
  if (root <= Root::released)
    hold_root(d, root, first, dual(kAccel, kAngularAccel), dual(kForce, kTorque));
  else
    hold_partly(d, bodies.front().name, root);
  for (std::size_t i = parent.size(); i-- > 1;) {
    const auto p = static_cast<std::size_t>(parent[i]);
    draw_joint(d, bodies[i], bodies[p], fmt::format("C{}", children[p]--));
  }
  for (const DrawnBody& body : bodies) {
    if (d.has_inputs && d.rng.chance(0.25)) draw_force(d, body.name);
    if (d.has_outputs && d.rng.chance(0.25)) draw_output(d, body.name);
    if (d.options.controllers && d.rng.chance(0.2)) draw_controller(d, body.name);
    if (with_springs && d.rng.chance(0.5)) draw_slosh(d, body.name);
  }
  draw_tip(d, bodies.back(), root);
  const auto any = [&] { return bodies[static_cast<std::size_t>(d.rng.below(count))].name; };
  if (d.has_inputs) draw_force(d, any());
  if (d.has_outputs) draw_output(d, any());
  if (d.has_outputs && root == Root::ground)
    read_support(d, bodies.front().name, bodies.back().name);
}

}  // namespace titop::generate
