#include "wild/oracle/draw.hpp"

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Which modes are kept, with which damping. Beams of equal bendings or clamped at an inner point
/// keep all of them with one damping, as one of two equal modes is not defined.
void choose_modes(Beam& b, Rng& rng) {
  const int modes = 6 * b.elements;
  const bool distinct = b.I_y != b.I_z && (b.parent == 0 || b.parent == b.elements);
  if (distinct && rng.chance(0.5)) b.kept = rng.below(modes + 1);
  if (b.kept >= 0 && rng.chance(0.5)) {
    b.residual = b.sites;
    if (rng.chance(0.3)) b.residual.push_back(b.parent);
  }
  const int kept = b.kept < 0 ? modes : b.kept;
  const bool each = distinct && kept > 0 && rng.chance(0.3);
  if (rng.chance(0.7))
    for (int i = 0; i < (each ? kept : 1); ++i) b.xi.push_back(rng.octaves(-10, -2));
}

/// Closes the chain from a beam's site to a body that is none, if both are there.
void close_on_beam(Draft& d) {
  std::vector<int> beams, others;
  for (int i = 0; i < static_cast<int>(d.scene.nodes.size()); ++i) {
    const Node& n = d.scene.nodes[at(i)];
    if (n.kind == Node::Kind::body) (n.beam ? beams : others).push_back(i);
  }
  if (beams.empty() || others.empty()) return;
  Point b = d.site(beams[at(d.rng.below(static_cast<int>(beams.size())))]);
  const Point a = d.site_at(others[at(d.rng.below(static_cast<int>(others.size())))], d.place(b));
  if (d.rng.chance(0.7)) {
    const int j = d.joint(b, d.some_axes());
    for (int k = 0; k < static_cast<int>(d.scene.nodes[at(j)].axes.size()); ++k)
      if (d.rng.chance(0.5)) d.mechanism(j, k);
    b = {j, 0};
  }
  d.mount(a, b);
}

}  // namespace

Node Draft::beam() {
  Node n;
  Beam b;
  b.elements = 1 + rng.below(1 + rng.below(4));
  b.length = factor(-2, 3);
  const double slender = factor(2, 6), omega = factor(-3, 5), mass = factor(-4, 5);
  const double gyration = b.length / slender, swing = omega * b.length * b.length;
  b.area = gyration * gyration * factor(1, 5);
  b.I_z = b.area * gyration * gyration;
  b.I_y = rng.chance(0.3) ? b.I_z : b.I_z * factor(-3, 4);
  b.J = (b.I_y + b.I_z) * rng.between(0.05, 1);
  if (rng.chance(0.3)) b.I_x = (b.I_y + b.I_z) * rng.between(1, 1.5);
  b.rho = mass / (b.area * b.length);
  // Of the first bending: omega^2 = 1.8751^4 E I / (rho A L^4).
  b.E = swing * swing * b.rho * b.area / b.I_z / 12.36;
  b.nu = rng.between(-0.4, 0.49);
  if (rng.chance(0.3)) b.G = b.E * rng.between(0.3, 0.6);
  b.parent = rng.chance(0.7) ? 0 : rng.below(b.elements + 1);
  b.sites = {b.parent == b.elements ? 0 : b.elements};
  for (int i = 0; i < b.elements; ++i)
    if (i != b.parent && i != b.sites[0] && rng.chance(0.2)) b.sites.push_back(i);
  choose_modes(b, rng);
  for (const int point : b.sites) {
    n.sites.emplace_back();
    n.sites.back().PC(0) = b.length * (point - b.parent) / b.elements;
  }
  n.beam = b;
  return n;
}

Scene draw_beams(Rng& rng) {
  Draft d(rng);
  d.tree(1 + rng.below(3), 0.6);
  if (rng.chance(0.25)) close_on_beam(d);
  d.outputs(2 + rng.below(3));
  d.scene.omega = d.factor(-2, 5);
  return d.scene;
}

}  // namespace wild
