#include "wild/oracle/draw.hpp"

#include <cmath>

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
using Measured = Reading::Measured;

}  // namespace

Scene draw_row(Rng& rng) {
  Draft d(rng);
  const int n = static_cast<int>(std::exp2(rng.between(0, 5.9)));
  const bool alike = rng.chance(0.5);
  const int spread = alike ? 1 : 1 + rng.below(4);
  const double m = d.factor(-3, 3), k = d.factor(-3, 10);
  const double loss = rng.chance(0.3) ? 0 : std::sqrt(m * k) * d.factor(-10, 5);
  const auto value = [&](double x) { return alike ? x : x * d.factor(-spread, spread); };
  for (int i = 0; i < n; ++i) {
    Node node;
    node.kind = Node::Kind::mass;
    node.m = value(m), node.k = value(k), node.c = value(loss);
    node.m0 = rng.chance(0.2) ? value(m) : 0;
    d.add(node);
    if (i > 0) d.mount({i, -1}, {rng.chance(0.95) ? i - 1 : rng.below(i), 0});
  }
  const int first = rng.below(4), last = rng.below(4);
  if (first == 0) {
    d.scene.nodes[0].m0 = m;
    d.load({0, -1});
  } else {
    d.scene.ties.push_back({.a = {0, -1}, .b = {}, .input = first == 1 ? d.input(1) : -1});
  }
  if (last == 0 || (last == 1 && d.scene.inputs.empty())) {
    d.scene.ties.push_back({.a = {n - 1, 0}, .b = {}, .input = last == 1 ? d.input(1) : -1});
    if (d.scene.inputs.empty()) d.load({rng.below(n), 0});
  } else {
    d.load({n - 1, 0});
  }
  d.outputs(1 + rng.below(3));
  d.scene.outputs.push_back({.measured = Measured::stretch, .at = {rng.below(n), -1}});
  if (first > 0) d.scene.outputs.push_back({.measured = Measured::reaction, .at = {0, -1}});
  d.scene.omega = std::sqrt(k / m) * d.factor(-2, 3);
  return d.scene;
}

Scene draw_tree(Rng& rng) {
  Draft d(rng);
  d.tree(1 + rng.below(5));
  d.outputs(2 + rng.below(3));
  d.scene.omega = d.factor(-2, 5);
  return d.scene;
}

Scene draw_loop(Rng& rng) {
  Draft d(rng);
  d.tree(2 + rng.below(3));
  const int closings = rng.chance(0.8) ? 1 : 2;
  for (int i = 0; i < closings; ++i) {
    std::vector<int> bodies;
    for (int b = 0; b < static_cast<int>(d.scene.nodes.size()); ++b)
      if (d.scene.nodes[at(b)].kind == Node::Kind::body) bodies.push_back(b);
    const int first = rng.below(static_cast<int>(bodies.size()));
    const int second = (first + 1 + rng.below(static_cast<int>(bodies.size()) - 1)) %
                       static_cast<int>(bodies.size());
    Point b = d.site(bodies[at(first)]);
    const Point a = d.site_at(bodies[at(second)], d.place(b));
    if (rng.chance(0.7)) {
      const int j = d.joint(b, d.some_axes());
      for (int k = 0; k < static_cast<int>(d.scene.nodes[at(j)].axes.size()); ++k)
        if (rng.chance(0.5)) d.mechanism(j, k);
      b = {j, 0};
    }
    d.mount(a, b);
  }
  d.outputs(2 + rng.below(3));
  d.scene.omega = d.factor(-2, 5);
  return d.scene;
}

namespace {

/// Some of six axes, in an orthonormal frame.
Tie partial(Draft& d) {
  Tie t;
  const int kind = d.rng.below(4);
  if (kind == 0) t.of = Tie::Of::linear;
  if (kind == 1) t.of = Tie::Of::angular;
  if (kind < 2) return t;
  t.of = Tie::Of::axes;
  const int subset = 1 + d.rng.below(62);
  const Matrix3d R = d.rotation();
  for (int i = 0; i < 6; ++i)
    if (subset >> i & 1) t.axes.push_back({i >= 3, R.col(i % 3)});
  return t;
}

bool holds_place(const Tie& t) {
  if (t.of != Tie::Of::axes) return t.of != Tie::Of::angular;
  for (const Axis& a : t.axes)
    if (!a.turns) return true;
  return false;
}

}  // namespace

Scene draw_half_ties(Rng& rng) {
  Draft d(rng);
  const int bodies = 2 + rng.below(2);
  for (int i = 0; i < bodies; ++i) {
    const Node body = d.body();
    const Matrix3d R = d.rotation();
    const int node = d.add(body, R, Vector3d(rng.matrix(3, 1)));
    if (i == 0) {
      d.base(node);
      continue;
    }
    const int places = 1 + rng.below(3);
    int held = 0;
    for (int k = 0; k < places; ++k) {
      Tie t = partial(d);
      const int other = rng.below(node);
      const bool first = k == 0;
      t.a = first ? Point{node, -1} : d.site(node);
      t.b = holds_place(t) ? d.site_at(other, d.place(t.a)) : d.site(other);
      t.T = d.frame(other).transpose() * d.frame(node);
      const int size = size_of(d.scene, t);
      if (held + size > 6 && rng.chance(0.9)) continue;
      held += size;
      d.scene.ties.push_back(t);
    }
    d.load(rng.chance(0.5) ? Point{node, -1} : d.site(node));
  }
  d.outputs(2 + rng.below(3));
  d.scene.outputs.push_back({.measured = Measured::rate, .at = {bodies - 1, -1}});
  d.scene.omega = d.factor(-2, 5);
  return d.scene;
}

Scene draw_controller(Rng& rng) {
  Draft d(rng);
  const bool mechanics = rng.chance(0.6);
  int first = 0;
  if (mechanics && rng.chance(0.5)) {
    d.tree(1 + rng.below(2));
  } else if (mechanics) {
    Node node;
    node.kind = Node::Kind::mass;
    node.m = d.factor(-2, 3), node.k = d.factor(-2, 6), node.c = d.factor(-6, 1);
    d.add(node);
    d.scene.ties.push_back({.a = {0, -1}, .b = {}});
    d.load({0, 0});
  }
  const int count = 1 + rng.below(2);
  first = static_cast<int>(d.scene.nodes.size());
  for (int i = 0; i < count; ++i) {
    const int ins = 1 + rng.below(3), outs = 1 + rng.below(3);
    Node n = d.controller(3 + rng.below(10), ins, outs);
    const auto feed = [&](const Reading& r, double gain) {
      n.in.push_back({r, gain * rng.matrix(ins, size_of(d.scene, r))});
    };
    if (!mechanics || rng.chance(0.5))
      feed({.measured = Measured::input, .axis = d.input(1 + rng.below(2))}, 1);
    if (mechanics) {
      const Reading motion = d.any_motion();
      feed(motion, d.factor(-6, 1));
    }
    if (i > 0) feed({.measured = Measured::out, .at = {first + i - 1, -1}}, 1);
    const int node = d.add(n);
    if (rng.chance(0.3))
      d.scene.nodes[at(node)].in.push_back(
          {{.measured = Measured::out, .at = {node, -1}}, d.matrix(-6, 1, ins, outs)});
    d.scene.outputs.push_back({.measured = Measured::out, .at = {node, -1}});
    if (mechanics && rng.chance(0.7)) {
      const int body = d.any_motion().at.node;
      const Node& b = d.scene.nodes[at(body)];
      if (b.kind == Node::Kind::joint) continue;
      const Point where = b.kind == Node::Kind::mass ? Point{body, 0} : d.site(body);
      const int size = b.kind == Node::Kind::mass ? 1 : 3;
      const int half = size == 1 ? 0 : 1 + rng.below(2);
      d.scene.loads.push_back(
          {where,
           half,
           {{{.measured = Measured::out, .at = {node, -1}}, d.matrix(-6, 1, size, outs)}}});
    }
  }
  if (mechanics) d.outputs(1 + rng.below(2));
  d.scene.omega = d.factor(-4, 5);
  return d.scene;
}

}  // namespace wild
