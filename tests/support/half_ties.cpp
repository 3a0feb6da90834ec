#include "half_ties.hpp"

namespace half_ties {
namespace {

using titop::Diagram;
using titop::DualPort;
using titop::Rotation;

Vector3d vector(Rng& rng, double size) { return size * rng.matrix(3, 1); }

Matrix3d rotation(Rng& rng) {
  const Vector3d axis = vector(rng, 1);
  return Eigen::AngleAxisd(rng.between(-3, 3), axis.normalized()).toRotationMatrix();
}

Body draw_body(Rng& rng, bool flexible) {
  Body b;
  b.mass = rng.between(0.5, 3);
  b.inertia.setZero();
  for (const Index i : {2, 1, 0}) b.inertia(i, i) = rng.between(1, 1.5);
  b.PA = vector(rng, 0.5);
  b.D_P = titop::rigid_mass(b.mass, b.inertia, -b.PA);
  if (rng.chance(0.7)) b.turn = rotation(rng);
  b.place = vector(rng, 2);
  const Index modes = flexible && rng.chance(0.5) ? 1 + rng.below(3) : 0;
  b.omega = VectorXd::Constant(modes, 1) + 10 * rng.matrix(modes, 1).cwiseAbs();
  b.L_P = 0.2 * rng.matrix(modes, 6);
  return b;
}

int add_point(Rng& rng, Body& b, const Vector3d& world) {
  b.points.push_back({"c" + std::to_string(b.points.size()), b.turn.transpose() * (world - b.place),
                      0.5 * rng.matrix(6, b.modes())});
  return static_cast<int>(b.points.size()) - 1;
}

int draw_mask(Rng& rng) {
  constexpr int kUsual[] = {7, 56, 63};
  return rng.chance(0.5) ? kUsual[rng.below(3)] : 1 + rng.below(63);
}

/// Admissible offset of the points of a tie: anywhere if no translation is tied, along the one that
/// is, else nowhere.
Vector3d draw_offset(Rng& rng, const HalfTie& t, const Matrix3d& turn) {
  const int linear = t.mask & 7;
  if (linear == 0) return vector(rng, 1);
  if ((linear & (linear - 1)) != 0) return Vector3d::Zero();
  return rng.between(-1, 1) * turn.col(linear == 4 ? 2 : linear - 1);
}

void draw_source(Rng& rng, Sketch& s, HalfTie& t, const Vector3d& target) {
  t.mask = t.slide ? 63 - (1 << rng.below(3)) : draw_mask(rng);
  t.by_halves = rng.chance(0.5);
  if (t.source >= 0)
    t.source_point =
        add_point(rng, body(s, t.source), target + draw_offset(rng, t, body(s, t.target).turn));
  s.ties.push_back(t);
}

/// A target's port for the source's: the equations of one direction, or of three.
template <class Port>
void tie(const Port& target, const Port& source, const Rotation& T, double sign) {
  target.accel = T * source.accel;
  source.force += sign * (T.inverse() * target.reaction);
}

void write(const Sketch& s, const HalfTie& t, const DualPort<6>& P, const DualPort<6>* S,
           bool angular) {
  const int mask = angular ? t.mask >> 3 : t.mask & 7;
  const std::string to = "b" + std::to_string(t.target), from = "b" + std::to_string(t.source);
  const double sign = t.target_point < 0 ? 1 : -1;
  if (mask == 7 && t.by_halves) {
    const auto& accel = angular ? P.accel.angular : P.accel.linear;
    if (!S) {
      accel = 0;
      return;
    }
    const Rotation T = Rotation::matrix(turn(s, t)).named(to, from);
    accel = T * (angular ? S->accel.angular : S->accel.linear);
    const auto& force = angular ? S->force.angular : S->force.linear;
    force += sign * (T.inverse() * (angular ? P.reaction.angular() : P.reaction.linear()));
    return;
  }
  for (int i = 0; i < 3; ++i) {
    if ((mask >> i & 1) == 0) continue;
    const Vector3d r = Vector3d::Unit(i);
    const auto p = angular ? P.about(r) : P.along(r);
    if (S) {
      const Vector3d there = turn(s, t).transpose() * r;
      tie(p, angular ? S->about(there) : S->along(there), Rotation{}.named(to, from), sign);
    } else {
      p.accel = 0;
    }
  }
}

}  // namespace

Sketch draw(Rng& rng, bool flexible, bool slides) {
  Sketch s;
  const int bodies = 2 + rng.below(4), loops = 1 + rng.below(2);
  for (int i = 0; i < bodies; ++i) s.bodies.push_back(draw_body(rng, flexible));
  for (int i = 0; i < bodies; ++i) {
    if (i == 0 && rng.chance(0.5)) continue;  // the first one is free
    HalfTie t{.target = i, .source = i == 0 ? -1 : rng.below(i)};
    t.slide = slides && t.source >= 0 && rng.chance(0.5);
    draw_source(rng, s, t, body(s, i).place);
  }
  for (int i = 0; i < loops; ++i) {
    HalfTie t{.target = rng.below(bodies), .source = rng.below(bodies)};
    if (t.source == t.target) t.source = -1;
    const Vector3d x = body(s, t.target).place + vector(rng, 1);
    t.target_point = add_point(rng, body(s, t.target), x);
    draw_source(rng, s, t, x);
  }
  s.load = rng.below(bodies), s.seen = rng.below(bodies);
  s.load_point = add_point(rng, body(s, s.load), body(s, s.load).place + vector(rng, 1));
  s.seen_point = add_point(rng, body(s, s.seen), body(s, s.seen).place + vector(rng, 1));
  return s;
}

void tie_again(Sketch& s, HalfTie& t, int mask) {
  t.mask = mask;
  if (t.source < 0) return;
  const Body& target = body(s, t.target);
  Body& source = body(s, t.source);
  Vector3d place = target.place;
  if (t.target_point >= 0)
    place += target.turn * target.points[static_cast<std::size_t>(t.target_point)].PC;
  source.points[static_cast<std::size_t>(t.source_point)].PC =
      source.turn.transpose() * (place - source.place);
}

namespace {

Spinning draw_rotor(Rng& rng) {
  Spinning r;
  r.mass = rng.between(0.1, 1);
  r.transverse = rng.between(0.05, 0.3);
  r.axial = rng.between(0.5, 1.9) * r.transverse;
  r.held = rng.chance(0.3);
  r.friction = rng.chance(0.5) ? rng.between(0.1, 1) : 0;
  r.centre = vector(rng, 0.3);
  return r;
}

}  // namespace

void draw_momenta(Rng& rng, Sketch& s, double size) {
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    if (i > 0 && rng.chance(0.5)) continue;
    Body& b = s.bodies[i];
    const int point = rng.below(static_cast<int>(b.points.size()) + 1) - 1;
    const double sign = rng.sign(), h = sign * rng.between(0.2, 1) * size;
    b.momenta.push_back({point, h, vector(rng, 1)});
    if (point >= 0 && rng.chance(0.5)) b.momenta.back().rotor = draw_rotor(rng);
  }
}

Sketch reversed(Sketch s) {
  for (Body& b : s.bodies)
    for (Momentum& m : b.momenta) m.h = -m.h;
  return s;
}

namespace {

void add(Diagram& d, const Momentum& m, const DualPort<6>& P) {
  if (!m.rotor) return titop::momentum(P, m.h, m.axis);
  const Spinning& r = *m.rotor;
  auto rotor =
      d.add("r" + std::to_string(d.graph().nodes.size()), titop::Rotor{.mass = r.mass,
                                                                       .axial = r.axial,
                                                                       .transverse = r.transverse,
                                                                       .axis = m.axis,
                                                                       .momentum = m.h,
                                                                       .PA = r.centre});
  mount(rotor, P);
  if (r.held)
    rotor.accel = 0;
  else
    rotor.torque = r.friction * rotor.speed;
}

}  // namespace

Diagram diagram(const Sketch& s) {
  Diagram d{"half ties"};
  const auto U = d.input("U", 6);
  std::vector<titop::BodyHandle> handles;
  for (const Body& b : s.bodies) {
    const std::string name = "b" + std::to_string(handles.size());
    if (b.modes() > 0) {
      handles.push_back(
          d.add(name, titop::FlexibleBody{titop::ModalData{.omega = b.omega,
                                                           .xi = VectorXd::Zero(b.modes()),
                                                           .L_P = b.L_P,
                                                           .D_P = b.D_P,
                                                           .children = b.points}}));
      continue;
    }
    titop::RigidBody rigid{.mass = b.mass, .inertia = b.inertia, .PA = b.PA};
    for (const titop::ModalChild& c : b.points) rigid.children.push_back({c.name, c.PC});
    handles.push_back(d.add(name, rigid));
  }
  const auto port = [&](int b, int point) {
    const auto& h = handles[static_cast<std::size_t>(b)];
    if (point < 0) return DualPort<6>(h.parent);
    return h.child(body(s, b).points[static_cast<std::size_t>(point)].name);
  };
  std::vector<char> held(s.bodies.size(), 0);
  for (const HalfTie& t : s.ties) {
    const DualPort<6> P = port(t.target, t.target_point);
    if (t.target_point < 0) held[static_cast<std::size_t>(t.target)] = 1;
    if (t.slide) {
      const Vector3d axis((t.mask & 1) == 0, (t.mask & 2) == 0, (t.mask & 4) == 0);
      const auto& carried = handles[static_cast<std::size_t>(t.target)];
      titop::slide(d, "s" + std::to_string(t.target), carried, port(t.source, t.source_point),
                   Rotation::matrix(turn(s, t).transpose()), axis)
          .force = 0;
      continue;
    }
    if (t.source < 0) {
      write(s, t, P, nullptr, false), write(s, t, P, nullptr, true);
    } else {
      const DualPort<6> S = port(t.source, t.source_point);
      write(s, t, P, &S, false), write(s, t, P, &S, true);
    }
    if (t.mask != 63) release(P);
  }
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!held[i]) release(handles[i]);
  for (std::size_t i = 0; i < s.bodies.size(); ++i)
    for (const Momentum& m : s.bodies[i].momenta) add(d, m, port(static_cast<int>(i), m.point));
  port(s.load, s.load_point).force += U;
  d.output("rate", 6) = port(s.seen, s.seen_point).rate;
  return d;
}

namespace {

/// First row of each body's coordinates (motion of its parent point, modes), of the rotors' angles,
/// and the number of all.
std::vector<Index> first_rows(const Sketch& s) {
  std::vector<Index> first{0};
  for (const Body& b : s.bodies) first.push_back(first.back() + 6 + b.modes());
  Index rotors = 0;
  for (const Body& b : s.bodies)
    rotors += std::count_if(b.momenta.begin(), b.momenta.end(),
                            [](const Momentum& m) { return m.rotor.has_value(); });
  first.push_back(first.back() + rotors);
  return first;
}

MatrixXd motion(const Sketch& s, const std::vector<Index>& first, int i, int point) {
  const Index f = first[static_cast<std::size_t>(i)];
  MatrixXd X = MatrixXd::Zero(6, first.back());
  X.block(0, f, 6, 6).setIdentity();
  if (point < 0) return X;
  const titop::ModalChild& c = body(s, i).points[static_cast<std::size_t>(point)];
  for (Index k = 0; k < 3; ++k)  // v_C = v_P + w x PC
    X.block(0, f + 3 + k, 3, 1) = Vector3d(Vector3d::Unit(k)).cross(c.PC);
  X.block(0, f + 6, 6, body(s, i).modes()) = c.Phi_C;
  return X;
}

/// The torques h a x omega on the bodies, on the left side of the equations.
MatrixXd gyroscopic(const Sketch& s, const std::vector<Index>& first) {
  MatrixXd G = MatrixXd::Zero(first.back(), first.back());
  for (std::size_t i = 0; i < s.bodies.size(); ++i)
    for (const Momentum& m : s.bodies[i].momenta) {
      const MatrixXd omega = motion(s, first, static_cast<int>(i), m.point).bottomRows(3);
      const Vector3d h = m.h * m.axis.normalized();
      for (Index k = 0; k < G.cols(); ++k)
        G.col(k) -= omega.transpose() * h.cross(Vector3d(omega.col(k)));
    }
  return G;
}

/// Masses of the rotors, and their friction.
void add_rotors(const Sketch& s, const std::vector<Index>& first, MatrixXd& M, MatrixXd& G) {
  Index own = first[s.bodies.size()];
  for (std::size_t i = 0; i < s.bodies.size(); ++i)
    for (const Momentum& m : s.bodies[i].momenta) {
      if (!m.rotor) continue;
      const Spinning& r = *m.rotor;
      const Vector3d a = m.axis.normalized();
      const MatrixXd X = motion(s, first, static_cast<int>(i), m.point), turn = X.bottomRows(3);
      MatrixXd move = X.topRows(3), spin = a.transpose() * turn;
      for (Index k = 0; k < X.cols(); ++k) move.col(k) += Vector3d(turn.col(k)).cross(r.centre);
      if (!r.held) spin(0, own) += 1;
      M += r.mass * move.transpose() * move + r.axial * spin.transpose() * spin +
           r.transverse * turn.transpose() * (Matrix3d::Identity() - a * a.transpose()) * turn;
      G(own, own) += r.friction;
      if (r.held) M(own, own) = 1;  // at rest
      ++own;
    }
}

/// One row per direction that is tied.
MatrixXd constraints(const Sketch& s, const std::vector<Index>& first) {
  MatrixXd J(0, first.back());
  for (const HalfTie& t : s.ties) {
    MatrixXd X = motion(s, first, t.target, t.target_point);
    if (t.source >= 0) {
      const MatrixXd Y = motion(s, first, t.source, t.source_point);
      X.topRows(3) -= turn(s, t) * Y.topRows(3);
      X.bottomRows(3) -= turn(s, t) * Y.bottomRows(3);
    }
    for (int i = 0; i < 6; ++i) {
      if (!t.ties(i)) continue;
      J.conservativeResize(J.rows() + 1, J.cols());
      J.bottomRows(1) = X.row(i);
    }
  }
  return J;
}

}  // namespace

Oracle oracle(const Sketch& s) {
  const std::vector<Index> first = first_rows(s);
  const Index n = first.back();
  MatrixXd M = MatrixXd::Zero(n, n), K = M;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const Body& b = s.bodies[i];
    const Index f = first[i], modes = b.modes();
    M.block(f, f, 6, 6) = b.D_P;
    M.block(f + 6, f, modes, 6) = b.L_P;
    M.block(f, f + 6, 6, modes) = b.L_P.transpose();
    M.block(f + 6, f + 6, modes, modes).setIdentity();
    K.block(f + 6, f + 6, modes, modes) = b.omega.cwiseAbs2().asDiagonal();
  }
  MatrixXd G = gyroscopic(s, first);
  add_rotors(s, first, M, G);
  const Eigen::JacobiSVD<MatrixXd> svd(constraints(s, first), Eigen::ComputeFullV);
  const VectorXd& sigma = svd.singularValues();
  const Index rank = (sigma.array() > 1e-9 * sigma(0)).count();
  const MatrixXd Z = svd.matrixV().rightCols(n - rank);
  return {.M = Z.transpose() * M * Z,
          .G = Z.transpose() * G * Z,
          .K = Z.transpose() * K * Z,
          .B = Z.transpose() * motion(s, first, s.load, s.load_point).transpose(),
          .C = motion(s, first, s.seen, s.seen_point) * Z,
          .gap = sigma(rank - 1) / sigma(0)};
}

}  // namespace half_ties
