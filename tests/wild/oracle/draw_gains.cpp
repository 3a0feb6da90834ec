#include <cmath>

#include "wild/oracle/draw.hpp"

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
using Measured = Reading::Measured;

Reading out(int node) { return {.measured = Measured::out, .at = {node, -1}}; }

/// 1 + 2^-k or 1 - 2^-k, k from 1 to `nearest`.
double near_one(Rng& rng, int nearest) {
  const double distance = std::ldexp(1.0, -1 - rng.below(nearest));
  return rng.chance(0.5) ? 1 + distance : 1 - distance;
}

/// A ring of gains whose product is near 1, and its input: every node takes the one before.
std::vector<int> draw_ring(Draft& d, int size, int nearest) {
  const int count = 1 + d.rng.below(4);
  const auto first = static_cast<int>(d.scene.nodes.size());
  std::vector<int> ring;
  double product = 1;
  for (int i = 0; i < count; ++i) {
    const double last = near_one(d.rng, nearest) / product, any = d.factor(-6, 7);
    const double g = i == count - 1 ? last : d.rng.chance(0.5) ? any : -any;
    product *= g;
    Node n = d.gain(g * MatrixXd::Identity(size, size));
    n.in.push_back({out(first + (i + count - 1) % count), MatrixXd::Identity(size, size)});
    ring.push_back(d.add(n));
  }
  return ring;
}

/// A sum of the outputs of some nodes and of itself.
int draw_sum(Draft& d, const std::vector<int>& of) {
  const Eigen::Index size = d.scene.nodes[at(of[0])].D.rows();
  const int ports = 2 + d.rng.below(2);
  MatrixXd D(size, ports * size);
  for (int i = 0; i < ports; ++i)
    D.middleCols(i * size, size) =
        (d.rng.chance(0.5) ? 1.0 : -1.0) * MatrixXd::Identity(size, size);
  Node n = d.gain(D);
  n.written = Node::Written::sum;
  for (int i = 0; i < ports; ++i) {
    const bool itself = i == ports - 1 && d.rng.chance(0.3);
    MatrixXd rows = MatrixXd::Zero(ports * size, size);
    rows.middleRows(i * size, size) =
        itself ? MatrixXd(d.rng.matrix(size, size)) : MatrixXd(MatrixXd::Identity(size, size));
    const auto self = static_cast<int>(d.scene.nodes.size());
    n.in.push_back({out(itself ? self : of[at(d.rng.below(static_cast<int>(of.size())))]), rows});
  }
  return d.add(n);
}

/// Nodes with any matrices that take each other's outputs at random, loops included.
std::vector<int> draw_net(Draft& d) {
  const auto first = static_cast<int>(d.scene.nodes.size());
  const int count = 2 + d.rng.below(4);
  std::vector<int> list;
  for (int i = 0; i < count; ++i) {
    const int ins = 1 + d.rng.below(3), outs = 1 + d.rng.below(3);
    list.push_back(d.add(d.gain(d.matrix(-3, 3, outs, ins))));
  }
  for (int i = 0; i < count; ++i) {
    Node& n = d.scene.nodes[at(first + i)];
    const int from = 1 + d.rng.below(2);
    for (int k = 0; k < from; ++k) {
      const int other = first + d.rng.below(count);
      const Eigen::Index size = d.scene.nodes[at(other)].D.rows();
      n.in.push_back({out(other), d.matrix(-3, 2, n.D.cols(), size)});
    }
  }
  return list;
}

/// Feeds reading `r` to a node.
void feed(Draft& d, int node, const Reading& r, double gain) {
  Node& n = d.scene.nodes[at(node)];
  n.in.push_back({r, gain * d.rng.matrix(n.D.cols(), size_of(d.scene, r))});
}

/// A mass or a rigid body whose inertia a force by its own acceleration takes almost away, by a
/// gain near the mass.
void draw_almost_massless(Draft& d, int nearest) {
  Node n;
  const bool one = d.rng.chance(0.5);
  n.kind = one ? Node::Kind::mass : Node::Kind::body;
  n.m = n.mass = d.factor(-4, 5);
  n.k = d.factor(-2, 6), n.c = d.rng.chance(0.5) ? 0 : d.factor(-6, 1);
  const int node = d.add(n);
  if (one) d.scene.ties.push_back({.a = {node, -1}, .b = {}});
  const Point where = one ? Point{node, 0} : Point{node, -1};
  const int size = one ? 1 : 3;
  Node g = d.gain(near_one(d.rng, nearest) * n.m * MatrixXd::Identity(size, size));
  g.in = {{{.measured = Measured::accel, .at = where, .half = one ? 0 : 1},
           MatrixXd::Identity(size, size)}};
  const int gain = d.add(g);
  d.scene.loads.push_back({where, one ? 0 : 1, {{out(gain), MatrixXd::Identity(size, size)}}});
  d.load(one ? where : d.site(node));
}

/// The outputs of a node as a wrench on some body; its inputs by a motion or a reaction.
void close_around(Draft& d, int node) {
  Reading r = d.any_motion();
  if (d.rng.chance(0.2) && !d.scene.ties.empty()) {
    const Tie& t = d.scene.ties[at(d.rng.below(static_cast<int>(d.scene.ties.size())))];
    r = {.measured = Measured::reaction, .at = t.a, .half = one_axis(d.scene, t.a) ? 0 : 1};
  }
  feed(d, node, r, d.factor(-6, 3));
  const int body = d.any_motion().at.node;
  const Node& b = d.scene.nodes[at(body)];
  if (b.kind == Node::Kind::joint) return;
  const bool one = b.kind == Node::Kind::mass;
  const Point where = one ? Point{body, 0} : d.site(body);
  const Eigen::Index outs = d.scene.nodes[at(node)].D.rows();
  d.scene.loads.push_back(
      {where, one ? 0 : 1 + d.rng.below(2), {{out(node), d.matrix(-6, 3, one ? 1 : 3, outs)}}});
}

/// Loop gains are 2^-nearest from 1, or farther.
Scene draw_loops_of_gains(Rng& rng, int nearest) {
  Draft d(rng);
  const int mechanics = rng.below(3);
  if (mechanics == 1) d.tree(1 + rng.below(2));
  if (mechanics == 2) draw_almost_massless(d, nearest);
  std::vector<int> gains;
  if (rng.chance(0.6)) gains = draw_ring(d, 1 + rng.below(3), nearest);
  if (gains.empty() || rng.chance(0.3)) {
    const std::vector<int> more = draw_net(d);
    gains.insert(gains.end(), more.begin(), more.end());
  }
  const int entry = gains[at(rng.below(static_cast<int>(gains.size())))];
  if (mechanics == 0 || rng.chance(0.5))
    feed(d, entry, {.measured = Measured::input, .axis = d.input(1 + rng.below(2))}, 1);
  const int last = rng.chance(0.4) ? draw_sum(d, {gains[0]}) : gains.back();
  if (mechanics > 0) close_around(d, entry);
  if (mechanics > 0) d.outputs(1 + rng.below(2));
  d.scene.outputs.push_back(out(last));
  d.scene.outputs.push_back(out(entry));
  d.scene.omega = d.factor(-4, 5);
  return d.scene;
}

}  // namespace

Node Draft::gain(const MatrixXd& D) {
  Node n;
  n.kind = Node::Kind::lti;
  n.A = MatrixXd(0, 0), n.B = MatrixXd(0, D.cols()), n.C = MatrixXd(D.rows(), 0);
  n.D = D;
  const bool scalar = D.rows() == D.cols() && D == D(0, 0) * MatrixXd::Identity(D.rows(), D.rows());
  const Node::Written forms[] = {Node::Written::lti, Node::Written::matrix, Node::Written::gain};
  n.written = forms[rng.below(scalar ? 3 : 2)];
  return n;
}

Scene draw_gains(Rng& rng) { return draw_loops_of_gains(rng, 6); }
Scene draw_steep_gains(Rng& rng) { return draw_loops_of_gains(rng, 20); }

}  // namespace wild
