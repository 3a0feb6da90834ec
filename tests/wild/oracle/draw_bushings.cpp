#include <cmath>

#include "wild/oracle/draw.hpp"

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Symmetric, semidefinite: a diagonal with zeros, or full and of any rank.
Matrix6d springs(Rng& rng, double size, double zeros) {
  Matrix6d m = Matrix6d::Zero();
  if (rng.chance(0.6)) {
    for (int i = 0; i < 6; ++i) {
      const double entry = size * rng.octaves(-3, 4);
      m(i, i) = rng.chance(zeros) ? 0 : entry;
    }
    return m;
  }
  const MatrixXd half = rng.matrix(rng.chance(zeros) ? 1 + rng.below(5) : 8, 6);
  m = size * half.transpose() * half;
  return 0.5 * (m + m.transpose());
}

/// Bodies on the ground or free, each on the one before directly, on a joint or on a bushing.
std::vector<int> draw_bodies(Draft& d, int count) {
  std::vector<int> bodies;
  const Matrix3d R = d.rotation();
  if (d.rng.chance(0.4)) {
    const int root = d.bushing({}, Vector3d::Zero());
    const Node body = d.body();
    bodies = {d.add(body, d.frame(root) * (d.rng.chance(0.7) ? Matrix3d::Identity() : R))};
    d.mount({bodies[0], -1}, {root, 0});
  } else {
    bodies = {d.add(d.body(), R)};
    d.base(bodies[0]);
  }
  while (static_cast<int>(bodies.size()) < count) {
    Point b = d.site(bodies[at(d.rng.below(static_cast<int>(bodies.size())))]);
    const Vector3d place = d.place(b);
    const int kind = d.rng.below(5);
    if (kind == 0) b = {d.joint(b, d.some_axes()), 0};
    for (int k = 0; kind == 0 && k < static_cast<int>(d.scene.nodes[at(b.node)].axes.size()); ++k)
      d.mechanism(b.node, k);
    if (kind > 1) b = {d.bushing(b, place), 0};
    if (kind > 1 && d.rng.chance(0.05)) b = {d.bushing(b, place), 0};  // springs in series
    const bool same = d.rng.chance(0.7);
    const Matrix3d turn = d.rotation();
    bodies.push_back(
        d.add(d.body(), same ? d.frame(b.node) : Matrix3d(d.frame(b.node) * turn), place));
    d.mount({bodies.back(), -1}, b);
  }
  return bodies;
}

/// A bushing between a body and another or the ground. Its child end is at a point of the first: a
/// new site, or the parent point of a body that floats.
void snub(Draft& d, const std::vector<int>& bodies) {
  const auto count = static_cast<int>(bodies.size());
  const int first = d.rng.below(count);
  const auto tied = [&](const Point& p) {
    for (const Tie& t : d.scene.ties)
      if (t.a == p) return true;
    return false;
  };
  Point a{bodies[at(first)], -1}, b;
  if (tied(a) || d.rng.chance(0.5)) a = d.site(bodies[at(first)]);
  if (count > 1 && d.rng.chance(0.7))
    b = d.site_at(bodies[at((first + 1 + d.rng.below(count - 1)) % count)], d.place(a));
  const int node = d.bushing(b, d.place(a), d.rng.chance(0.7) ? &d.frame(a.node) : nullptr);
  d.mount({node, 0}, a);
}

}  // namespace

int Draft::bushing(const Point& b, const Vector3d& where, const Matrix3d* in) {
  Node n;
  n.kind = Node::Kind::bushing;
  n.stiffness = springs(rng, factor(-4, 6), 0.2);
  n.damping = rng.chance(0.4) ? Matrix6d(Matrix6d::Zero()) : springs(rng, factor(-8, 2), 0.3);
  const Matrix3d R = in ? *in : rotation();
  const int node = add(n, in || b.node < 0 ? R : Matrix3d(frame(b.node) * R), where);
  if (b.node >= 0)
    mount({node, -1}, b);
  else
    scene.ties.push_back({.a = {node, -1}, .b = {}, .input = rng.chance(0.3) ? input(6) : -1});
  return node;
}

Scene draw_bushings(Rng& rng) {
  Draft d(rng);
  const std::vector<int> bodies = draw_bodies(d, 1 + rng.below(3));
  const int more = rng.below(3);
  for (int i = 0; i < more; ++i) snub(d, bodies);
  const int loads = d.scene.inputs.empty() ? 1 + rng.below(2) : rng.below(2);
  for (int i = 0; i < loads; ++i)
    d.load(d.site(bodies[at(rng.below(static_cast<int>(bodies.size())))]));
  d.outputs(2 + rng.below(3));
  d.scene.omega = d.factor(-2, 5);
  return d.scene;
}

}  // namespace wild
