#include <cmath>

#include "wild/oracle/draw.hpp"

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Rotation about z that brings the first of `count` places to place i: by 180, 120 or 90 degrees
/// each.
Matrix3d turn(int i, int count) {
  const double c = count == 3 ? -0.5 : count == 2 ? -1 : 0;
  const double s = count == 3 ? std::sqrt(0.75) : count == 2 ? 0 : 1;
  Matrix3d once, T = Matrix3d::Identity();
  once << c, -s, 0, s, c, 0, 0, 0, 1;
  for (int k = 0; k < i; ++k) T = (once * T).eval();
  return T;
}

/// Appendages by their place, each drawn once.
struct Appendage {
  Node body;
  Matrix3d mounting;
  Site on_hub;             ///< of the first place
  std::vector<Axis> axes;  ///< none: mounted directly
  double k = 0, c = 0;     ///< of each axis; both 0: it is free
};

Appendage draw_appendage(Draft& d, const Node& hub) {
  Appendage a;
  a.body = d.rng.chance(0.25) ? d.beam() : d.body();
  a.mounting = d.rotation();
  a.on_hub.PC = d.rng.matrix(3, 1);
  a.on_hub.Phi = d.rng.matrix(6, hub.omega.size());
  if (hub.omega.size() > 0) a.on_hub.Phi /= std::sqrt(hub.D_P(0, 0));
  if (d.rng.chance(0.3)) a.axes = d.some_axes();
  if (d.rng.chance(0.7)) a.k = d.factor(-4, 6);
  if (d.rng.chance(0.5)) a.c = d.factor(-8, 2);
  return a;
}

/// Returns the node of the appendage.
int place(Draft& d, const Appendage& a, int hub, const Matrix3d& T) {
  Site site = a.on_hub;
  site.PC = T * site.PC;
  for (int half = 0; half < 2; ++half)
    site.Phi.middleRows<3>(3 * half) = T * site.Phi.middleRows<3>(3 * half).eval();
  Node& carrier = d.scene.nodes[at(hub)];
  carrier.sites.push_back(site);
  Point b{hub, static_cast<int>(carrier.sites.size()) - 1};
  const Matrix3d R = d.frame(hub) * T * a.mounting;
  const Vector3d where = d.place(b);
  if (!a.axes.empty()) {
    Node joint;
    joint.kind = Node::Kind::joint;
    joint.axes = a.axes;
    const int j = d.add(joint, R, where);
    d.mount({j, -1}, b);
    for (int k = 0; k < static_cast<int>(a.axes.size()); ++k)
      if (a.k > 0 || a.c > 0)
        d.scene.mechanisms.push_back({.node = j, .axis = k, .k = a.k, .c = a.c});
    b = {j, 0};
  }
  const int node = d.add(a.body, R, where);
  d.mount({node, -1}, b);
  return node;
}

}  // namespace

Scene draw_equal(Rng& rng) {
  Draft d(rng);
  const int hub = d.add_turned(d.body(), Matrix3d::Identity());
  if (rng.chance(0.5)) d.base(hub);
  const Appendage a = draw_appendage(d, d.scene.nodes[at(hub)]);
  const int count = 2 + rng.below(3);
  const Matrix3d B = d.rotation();  // the axis of the turns: z or any
  std::vector<int> list = {hub};
  for (int i = 0; i < count; ++i)
    list.push_back(place(d, a, hub, B * turn(i, count) * B.transpose()));
  const int loads = d.scene.inputs.empty() ? 1 + rng.below(2) : rng.below(2);
  for (int i = 0; i < loads; ++i) d.load(d.site(list[at(rng.below(count + 1))]));
  d.outputs(2 + rng.below(3));
  d.scene.omega = d.factor(-2, 5);
  return d.scene;
}

}  // namespace wild
