#include "generate/diagrams/draft.hpp"

/// Assemblies with one degree of freedom per junction.
namespace titop::generate {

std::string draw_spring(Draft& d, bool free) {
  const std::string name = d.fresh("z");
  const double m = d.rng.octaves(-1, 3), k = d.rng.octaves(3, 9);
  const double c = d.damped() ? d.rng.octaves(-3, 2) : 0;
  const double m0 = free || d.rng.chance(0.5) ? d.rng.octaves(-1, 3) : 0;
  d.add([=](Build& b) {
    const double M = b.units.mass, t = b.units.time;
    b.springs.emplace(name, b.d.add(name, SpringMass{.mass = m * M,
                                                     .stiffness = k * M / (t * t),
                                                     .damping = c * M / t,
                                                     .parent_mass = m0 * M}));
  });
  d.springs.push_back(name);
  return name;
}

namespace {

/// A force at the child end of z: an input, plain, scaled, through a gain, or two
/// through a matrix.
void draw_force(Draft& d, const std::string& z) {
  const int kind = d.rng.below(4);
  const std::string u =
      d.input(kind == 3 ? std::vector<Dim>{kForce, kForce} : std::vector<Dim>{kForce});
  if (kind == 0) d.equation([=](Build& b) { b.springs.at(z).child.force += b.inputs.at(u); });
  if (kind == 1) d.equation([=](Build& b) { b.springs.at(z).child.force -= 2.5 * b.inputs.at(u); });
  if (kind < 2) return;
  const std::string g = d.fresh("G");
  if (kind == 2)
    d.add([=](Build& b) { b.gains.emplace(g, b.d.add(g, Gain{.gain = -0.75})); });
  else
    d.add([=](Build& b) {
      MatrixGain both{Eigen::MatrixXd::Constant(1, 2, 0.5)};
      both.matrix(0, 1) = -1.25;
      b.gains.emplace(g, b.d.add(g, both));
    });
  d.equation([=](Build& b) { b.gains.at(g).in = b.inputs.at(u); });
  d.equation([=](Build& b) { b.springs.at(z).child.force += b.gains.at(g).out; });
}

/// A controller at z: from its acceleration with a direct term (an algebraic loop, never singular:
/// it adds to the mass), or from its stretch, alone or against a reference.
void draw_controller(Draft& d, const std::string& z) {
  const int kind = d.rng.below(d.has_inputs ? 3 : 2);
  const Dim in = kind == 0 ? kAccel : kLength;
  const std::string K = draw_filter(d, in, kForce, kind == 0 ? 0.1 : 8,
                                    kind == 0 ? d.rng.between(0.1, 2) : d.rng.between(-4, 4));
  d.equation([=](Build& b) { b.springs.at(z).child.force -= b.filters.at(K).out; });
  if (kind == 0) d.equation([=](Build& b) { b.filters.at(K).in = b.springs.at(z).child.accel; });
  if (kind == 1) d.equation([=](Build& b) { b.filters.at(K).in = b.springs.at(z).stretch; });
  if (kind != 2) return;
  const std::string S = d.fresh("S"), r = d.input({kLength});
  d.add([=](Build& b) { b.sums.emplace(S, b.d.add(S, Sum{.signs = "-+"})); });
  d.equation([=](Build& b) { b.sums.at(S).in(1) = b.inputs.at(r); });
  d.equation([=](Build& b) { b.sums.at(S).in(2) = b.springs.at(z).stretch; });
  d.equation([=](Build& b) { b.filters.at(K).in = b.sums.at(S).out; });
}

void draw_output(Draft& d, const std::string& z) {
  switch (d.rng.below(4)) {
    case 0: d.output({kAccel}, [=](Build& b) { return b.springs.at(z).child.accel.expr(); }); break;
    case 1: d.output({kLength}, [=](Build& b) { return b.springs.at(z).stretch.expr(); }); break;
    case 2: d.output({kForce}, [=](Build& b) { return -b.springs.at(z).parent.force; }); break;
    default:
      d.output({kAccel}, [=](Build& b) {
        return b.springs.at(z).parent.accel + 2.0 * b.springs.at(z).child.accel;
      });
  }
}

void draw_mount(Draft& d, const std::string& z, const std::string& on) {
  if (d.rng.chance(0.5)) {
    d.equation([=](Build& b) { mount(b.springs.at(z), b.springs.at(on).child); });
    return;
  }
  d.equation([=](Build& b) { b.springs.at(z).parent.accel = b.springs.at(on).child.accel; });
  d.equation([=](Build& b) { b.springs.at(on).child.force += b.springs.at(z).parent.force; });
}

/// The far end of a chain may be held: only one end of it by the ground.
void draw_tip(Draft& d, const std::string& z, Root root) {
  if (root == Root::released && d.rng.chance(0.4)) {
    d.equation([=](Build& b) { b.springs.at(z).child.accel = 0; });
    if (d.has_outputs)
      d.output({kForce}, [=](Build& b) { return b.springs.at(z).child.reaction.expr(); });
  } else if (d.may_prescribe() && d.rng.chance(0.2)) {
    const std::string a = d.input({kAccel});
    if (root != Root::released) ++d.drawn.loose;
    d.equation([=](Build& b) { b.springs.at(z).child.accel = b.inputs.at(a); });
  }
}

}  // namespace

void use_spring(Draft& d, const std::string& z) {
  if (d.has_inputs && d.rng.chance(0.4)) draw_force(d, z);
  if (d.options.controllers && d.rng.chance(0.25)) draw_controller(d, z);
  if (d.has_outputs && d.rng.chance(0.4)) draw_output(d, z);
}

void draw_scalar(Draft& d, int count) {
  const std::vector<int> parent = draw_tree(d, count);
  std::vector<std::string> z;
  for (int i = 0; i < count; ++i) z.push_back(draw_spring(d, i == 0));
  const auto first = [name = z.front()](Build& b) { return b.springs.at(name); };
  const Root root = draw_root(d, 3);
  hold_root(d, root, first, {kAccel}, {kForce});
  for (std::size_t i = 1; i < z.size(); ++i)
    draw_mount(d, z[i], z[static_cast<std::size_t>(parent[i])]);
  for (const std::string& name : z) use_spring(d, name);
  draw_tip(d, z.back(), root);
  if (d.has_inputs) draw_force(d, z[static_cast<std::size_t>(d.rng.below(count))]);
  if (!d.has_outputs) return;
  draw_output(d, z[static_cast<std::size_t>(d.rng.below(count))]);
  const std::string& seen = z.front();
  if (root == Root::ground && count > 1)
    d.output({kLength}, [=](Build& b) { return b.springs.at(seen).position.expr(); });
}

}  // namespace titop::generate
