#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "wild/oracle/draw.hpp"

namespace wild {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Matrix3d cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v(2), v(1), v(2), 0, -v(0), -v(1), v(0), 0;
  return m;
}

}  // namespace

int Draft::add(Node node, const Matrix3d& R, const Vector3d& p) {
  const auto number = std::to_string(scene.nodes.size() + 1);
  node.name = std::string(1, "abcdefgh"[rng.below(8)]) + number;
  scene.nodes.push_back(std::move(node));
  R_.push_back(R);
  p_.push_back(p);
  return static_cast<int>(scene.nodes.size()) - 1;
}

int Draft::add_turned(Node node, const Matrix3d& frame, const Vector3d& p) {
  const Matrix3d T = rotation();
  return add(std::move(node), frame * T, p);
}

MatrixXd Draft::matrix(int low, int high, Eigen::Index rows, Eigen::Index cols) {
  const double size = factor(low, high);
  return size * rng.matrix(rows, cols);
}

Vector3d Draft::unit() {
  if (rng.chance(0.3)) return Vector3d::Unit(rng.below(3));
  Vector3d r = rng.matrix(3, 1);
  while (r.norm() < 0.2) r = rng.matrix(3, 1);
  return r.normalized();
}

Matrix3d Draft::rotation() {
  return rng.chance(0.3) ? Matrix3d(Matrix3d::Identity()) : rng.rotation();
}

Node Draft::body() {
  Node n;
  n.mass = factor(-4, 5);
  n.PA = rng.matrix(3, 1);
  const double r = factor(-2, 1);
  Vector3d principal;
  for (int i = 0; i < 3; ++i) principal(i) = rng.between(1, 1.8);
  const Matrix3d T = rotation();
  n.inertia = n.mass * r * r * T * principal.asDiagonal() * T.transpose();
  n.inertia = (0.5 * (n.inertia + n.inertia.transpose())).eval();
  if (rng.chance(0.5)) return n;
  const int modes = 1 + rng.below(6);
  Matrix6d tau = Matrix6d::Identity(), D = Matrix6d::Zero();
  tau.topRightCorner<3, 3>() = -cross(n.PA);
  D.topLeftCorner<3, 3>().diagonal().setConstant(n.mass);
  D.bottomRightCorner<3, 3>() = n.inertia;
  D = (tau.transpose() * D * tau).eval();
  n.D_P = 0.5 * (D + D.transpose());
  MatrixXd share = rng.matrix(modes, 6);
  share *= std::sqrt(rng.between(0.1, 0.9)) / share.norm();
  n.L_P = share * MatrixXd(Eigen::LLT<Matrix6d>(n.D_P).matrixU());
  n.omega.resize(modes);
  n.xi.resize(modes);
  const double xi = rng.chance(0.3) ? 0 : rng.octaves(-10, -2);
  double omega = factor(-3, 5);
  for (int i = 0; i < modes; ++i, omega *= rng.between(1.05, 2)) {
    n.omega(i) = omega;
    n.xi(i) = xi;
  }
  return n;
}

Point Draft::site(int node) {
  if (const auto& b = scene.nodes[at(node)].beam)
    return {node, rng.below(static_cast<int>(b->sites.size()))};
  return site_at(node, p_[at(node)] + R_[at(node)] * Vector3d(rng.matrix(3, 1)));
}

Point Draft::site_at(int node, const Vector3d& global) {
  Node& n = scene.nodes[at(node)];
  const Vector3d PC = R_[at(node)].transpose() * (global - p_[at(node)]);
  MatrixXd Phi = rng.matrix(6, n.omega.size());
  if (Phi.size() > 0) Phi /= std::sqrt(n.D_P(0, 0));
  n.sites.push_back({PC, Phi});
  return {node, static_cast<int>(n.sites.size()) - 1};
}

Vector3d Draft::place(const Point& point) const {
  const Node& n = scene.nodes[at(point.node)];
  const Vector3d& p = p_[at(point.node)];
  if (point.site < 0 || n.kind != Node::Kind::body) return p;
  return p + frame(point.node) * n.sites[at(point.site)].PC;
}

void Draft::mount(const Point& a, const Point& b) {
  Tie t{.a = a, .b = b};
  if (!one_axis(scene, a)) t.T = frame(b.node).transpose() * frame(a.node);
  scene.ties.push_back(t);
}

int Draft::joint(const Point& b, const std::vector<Axis>& axes) {
  Node n;
  n.kind = Node::Kind::joint;
  n.axes = axes;
  const int node = add(n, frame(b.node) * rotation(), place(b));
  mount({node, -1}, b);
  return node;
}

std::vector<Axis> Draft::some_axes() {
  const Matrix3d R = rotation();
  const auto axis = [&](bool turns, int i) { return Axis{turns, R.col(i)}; };
  switch (rng.below(7)) {
    case 0:
    case 1: return {axis(true, 0)};
    case 2: return {axis(false, 0)};
    case 3: return {axis(true, 0), axis(true, 1), axis(true, 2)};    // ball
    case 4: return {axis(true, 0), axis(true, 1)};                   // universal
    case 5: return {axis(true, 0), axis(false, 1), axis(false, 2)};  // planar
    default: return {axis(false, 0), axis(true, 0)};                 // cylindrical
  }
}

int Draft::input(int size) {
  scene.inputs.push_back(size);
  return static_cast<int>(scene.inputs.size()) - 1;
}

void Draft::mechanism(int node, int axis) {
  Mechanism m{.node = node, .axis = axis};
  const int kind = rng.below(6);
  if (kind == 0) return;                                  // free
  if (kind == 1 && rng.chance(0.5)) m.c = factor(-8, 2);  // a rotor with friction
  if (kind == 4) m.moves = rng.chance(0.5);
  if (kind == 5 || kind == 3) {
    m.moves = kind == 5 && rng.chance(0.3);
    Reading u{.measured = Reading::Measured::input, .axis = input(1)};
    m.more.push_back({u, MatrixXd::Constant(1, 1, m.moves ? 1.0 : -1.0)});
  }
  if (!m.moves && kind >= 2) m.k = factor(-4, 6), m.c = rng.chance(0.5) ? factor(-8, 2) : 0;
  scene.mechanisms.push_back(m);
}

void Draft::load(const Point& where) {
  Load l{.at = where, .half = one_axis(scene, where) ? 0 : rng.below(3), .sum = {}};
  const int size = one_axis(scene, where) ? 1 : l.half == 0 ? 6 : 3;
  const Reading u{.measured = Reading::Measured::input, .axis = input(size)};
  l.sum.push_back({u, MatrixXd::Identity(size, size)});
  scene.loads.push_back(l);
}

void Draft::base(int node) {
  const int kind = rng.below(5);
  Tie t{.a = {node, -1}, .b = {}};
  if (kind == 0 && scene.nodes[at(node)].kind == Node::Kind::body) return;  // it floats
  if (kind == 1) t.of = rng.chance(0.5) ? Tie::Of::linear : Tie::Of::angular;
  if (scene.nodes[at(node)].kind == Node::Kind::joint) t.of = Tie::Of::all;
  if (kind == 2) t.input = input(size_of(scene, t));
  scene.ties.push_back(t);
}

void Draft::tree(int bodies, double beams) {
  std::vector<int> list;
  const auto one = [&] { return beams > 0 && rng.chance(beams) ? beam() : body(); };
  for (int i = 0; i < bodies; ++i) {
    if (i == 0) {
      list.push_back(add_turned(one(), Matrix3d::Identity()));
      base(list.back());
      continue;
    }
    const int on = list[at(rng.chance(0.6) ? i - 1 : rng.below(i))];
    Point b = site(on);
    if (rng.chance(0.6)) {
      const int j = joint(b, some_axes());
      for (int k = 0; k < static_cast<int>(scene.nodes[at(j)].axes.size()); ++k) mechanism(j, k);
      b = {j, 0};
      list.push_back(add(one(), frame(j), place(b)));
    } else {
      list.push_back(add_turned(one(), frame(on), place(b)));
    }
    mount({list.back(), -1}, b);
  }
  const int loads = scene.inputs.empty() ? 1 + rng.below(2) : rng.below(2);
  for (int i = 0; i < loads; ++i) load(site(list[at(rng.below(bodies))]));
}

Reading Draft::any_motion() {
  using Measured = Reading::Measured;
  for (;;) {
    const int i = rng.below(static_cast<int>(scene.nodes.size()));
    const Node& n = scene.nodes[at(i)];
    const Measured motion[] = {Measured::accel, Measured::rate, Measured::position};
    const Measured of_axis[] = {Measured::axis_accel, Measured::axis_rate, Measured::axis_position};
    Reading r{.measured = motion[rng.below(3)], .at = {i, -1}, .half = rng.below(3)};
    if (n.kind == Node::Kind::mass) {
      r.at.site = 0, r.half = 0;
      return r;
    }
    if (n.kind == Node::Kind::body) {
      if (!n.sites.empty() && rng.chance(0.7))
        r.at.site = rng.below(static_cast<int>(n.sites.size()));
      return r;
    }
    if (n.kind == Node::Kind::bushing) {
      r.at.site = rng.below(2) - 1;
      if (rng.chance(0.5)) r.measured = Measured::displacement;
      if (rng.chance(0.2)) r.measured = Measured::displacement_rate;
      return r;
    }
    if (n.kind == Node::Kind::joint) {
      const int axis = rng.below(static_cast<int>(n.axes.size()));
      return {.measured = of_axis[rng.below(3)], .at = {i, -1}, .axis = axis};
    }
  }
}

void Draft::outputs(int count) {
  using Measured = Reading::Measured;
  for (int i = 0; i < count; ++i) {
    if (!scene.ties.empty() && rng.chance(0.25)) {
      const Tie& t = scene.ties[at(rng.below(static_cast<int>(scene.ties.size())))];
      const int half = one_axis(scene, t.a) ? 0 : rng.below(3);
      scene.outputs.push_back({.measured = Measured::reaction, .at = t.a, .half = half});
    } else {
      scene.outputs.push_back(any_motion());
    }
  }
}

Node Draft::controller(int states, int ins, int outs) {
  Node n;
  n.kind = Node::Kind::lti;
  const double speed = factor(-4, 5);
  n.A = speed * rng.matrix(states, states);
  switch (rng.below(6)) {
    case 0:  // companion form
      n.A.setZero();
      n.A.diagonal(-1).setConstant(speed);
      n.A.row(0) = speed * rng.matrix(1, states);
      break;
    case 1:  // poles at 0
      n.A.col(rng.below(states)).setZero();
      n.A.row(rng.below(states)).setZero();
      break;
    case 2:  // a series of integrators, scaled
      n.A.setZero();
      n.A.diagonal(-1).setConstant(speed);
      break;
    case 3:  // stable
      n.A.diagonal().array() -= 2 * speed * std::sqrt(states);
      break;
    default: break;
  }
  if (rng.chance(0.3)) n.A = (rng.matrix(states, states).array() > 0.2).select(n.A, 0.0).eval();
  n.B = matrix(-3, 4, states, ins);
  n.C = matrix(-3, 4, outs, states);
  n.D = rng.chance(0.5) ? MatrixXd(MatrixXd::Zero(outs, ins)) : rng.matrix(outs, ins);
  return n;
}

}  // namespace wild
