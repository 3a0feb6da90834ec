#include "wild/oracle/equations.hpp"

#include <Eigen/QR>
#include <cmath>

namespace wild {

namespace {

using Real = Equations::Real;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Eigen::Matrix<Real, 3, 3> cross(const Vector3d& v) {
  Eigen::Matrix<Real, 3, 3> m;
  const Real x(v(0)), y(v(1)), z(v(2)), o(0);
  m << o, -z, y, z, o, -x, -y, x, o;
  return m;
}

/// Motion of a point from that of P of the same rigid body.
Eigen::Matrix<Real, 6, 6> tau(const Vector3d& PC) {
  Eigen::Matrix<Real, 6, 6> t = Eigen::Matrix<Real, 6, 6>::Identity();
  t.topRightCorner<3, 3>() = -cross(PC);
  return t;
}

Eigen::Matrix<Real, 6, 6> rigid_mass(const Node& n) {
  Eigen::Matrix<Real, 6, 6> m = Eigen::Matrix<Real, 6, 6>::Zero();
  for (Index i = 0; i < 3; ++i) m(i, i) = Real(n.mass);
  m.bottomRightCorner<3, 3>() = n.inertia.cast<Real>();
  const Eigen::Matrix<Real, 6, 6> t = tau(n.PA);
  return t.transpose() * m * t;
}

Vector6d twist(const Axis& a) {
  Vector6d t = Vector6d::Zero();
  t.segment<3>(a.turns ? 3 : 0) = a.r;
  return t;
}

}  // namespace

Equations::Equations(const Scene& scene) : scene_(scene) {
  place();
  for (Matrix& p : P) p.setZero(n_, n_);
  R.setZero(n_, inputs_);
  undetermined_.assign(at(n_), 0);
  for (int i = 0; i < static_cast<int>(scene.nodes.size()); ++i) node(i);
  for (std::size_t i = 0; i < scene.ties.size(); ++i) tie(i);
  mechanisms();
  drop_redundant();
  for (const Load& load : scene.loads) {
    const bool one = one_axis(scene, load.at);
    const Index rows = one ? 1 : load.half == 0 ? 6 : 3;
    Signal w = sum(load.sum, rows);
    const Matrix J = jacobian(load.at);
    const Matrix up = one ? Matrix(J.transpose()) : Matrix(J.transpose() * half(load.half));
    for (Matrix& m : w.of) m = (up * m).eval();
    w.in = (up * w.in).eval();
    subtract(x_[at(load.at.node)], w);
  }
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (scene.nodes[i].kind == Node::Kind::lti)
      subtract(z_[i] + scene.nodes[i].A.rows(), sum(scene.nodes[i].in, scene.nodes[i].D.cols()));
  outputs();
}

void Equations::place() {
  for (const Node& n : scene_.nodes) {
    x_.push_back(n_);
    size_.push_back(0);
    Q_.push_back(-1);
    z_.push_back(n_);
    if (n.kind == Node::Kind::mass) size_.back() = 2;
    if (n.kind == Node::Kind::body) size_.back() = 6 + n.omega.size();
    beams_.push_back(n.beam ? beam_model(*n.beam) : BeamModel{});
    if (n.beam) size_.back() = beams_.back().M.rows();
    if (n.beam && !beams_.back().none.empty()) none = beams_.back().none;
    if (n.kind == Node::Kind::bushing) size_.back() = 12;
    if (n.kind == Node::Kind::joint) size_.back() = 6 + static_cast<Index>(n.axes.size());
    n_ += size_.back();
    if (n.kind == Node::Kind::joint) {
      Q_.back() = n_;
      n_ += static_cast<Index>(n.axes.size());
    }
    if (n.kind == Node::Kind::lti) n_ += n.A.rows() + n.D.cols() + n.D.rows();
  }
  for (const Tie& t : scene_.ties) {
    lambda_.push_back(n_);
    n_ += size_of(scene_, t);
  }
  for (const int size : scene_.inputs) {
    input_.push_back(inputs_);
    inputs_ += size;
  }
}

void Equations::node(int i) {
  const Node& n = scene_.nodes[at(i)];
  const Index x = x_[at(i)];
  if (n.kind == Node::Kind::mass) {
    P[2](x, x) = Real(n.m0);
    P[2](x + 1, x + 1) = Real(n.m);
    const auto pair = [&](Matrix& m, double value) {
      m(x, x) += Real(value);
      m(x + 1, x + 1) += Real(value);
      m(x, x + 1) -= Real(value);
      m(x + 1, x) -= Real(value);
    };
    pair(P[0], n.k);
    pair(P[1], n.c);
  }
  if (n.beam) {
    const BeamModel& b = beams_[at(i)];
    P[2].block(x, x, b.M.rows(), b.M.cols()) = b.M;
    P[1].block(x, x, b.M.rows(), b.M.cols()) = b.D;
    P[0].block(x, x, b.M.rows(), b.M.cols()) = b.K;
  } else if (n.kind == Node::Kind::body) {
    body(n, x);
  }
  if (n.kind == Node::Kind::bushing)
    for (std::size_t order = 0; order < 2; ++order) {
      const Matrix m = (order == 0 ? n.stiffness : n.damping).cast<Real>();
      P[order].block<12, 12>(x, x) << m, -m, -m, m;
    }
  if (n.kind == Node::Kind::joint)
    for (Index k = 0; k < size_[at(i)] - 6; ++k) P[0](x + 6 + k, Q_[at(i)] + k) = Real(1);
  if (n.kind == Node::Kind::lti) controller(n, z_[at(i)]);
}

void Equations::body(const Node& n, Index x) {
  const Index modes = n.omega.size();
  P[2].block<6, 6>(x, x) =
      modes == 0 ? rigid_mass(n) : Eigen::Matrix<Real, 6, 6>(n.D_P.cast<Real>());
  for (Index k = 0; k < modes; ++k) {
    const Index row = x + 6 + k;
    const Real omega(n.omega(k));
    P[2](row, row) = Real(1);
    P[1](row, row) = Real(2) * Real(n.xi(k)) * omega;
    P[0](row, row) = omega * omega;
    for (Index j = 0; j < 6; ++j) P[2](row, x + j) = P[2](x + j, row) = Real(n.L_P(k, j));
  }
}

void Equations::controller(const Node& n, Index z) {
  const Index states = n.A.rows(), in = z + states, out = in + n.D.cols();
  for (Index i = 0; i < states; ++i) P[1](z + i, z + i) = Real(1);
  P[0].block(z, z, states, states) = -n.A.cast<Real>();
  P[0].block(z, in, states, n.D.cols()) = -n.B.cast<Real>();
  for (Index i = in; i < out + n.D.rows(); ++i) P[0](i, i) = Real(1);
  P[0].block(out, z, n.D.rows(), states) = -n.C.cast<Real>();
  P[0].block(out, in, n.D.rows(), n.D.cols()) = -n.D.cast<Real>();
}

Equations::Matrix Equations::six(const Matrix3d& T) const {
  Matrix m = Matrix::Zero(6, 6);
  m.topLeftCorner<3, 3>() = T.cast<Real>();
  m.bottomRightCorner<3, 3>() = T.cast<Real>();
  return m;
}

Equations::Matrix Equations::half(int which) const {
  const Matrix I = Matrix::Identity(6, 6);
  if (which == 0) return I;
  return which == 1 ? I.leftCols(3).eval() : I.rightCols(3).eval();
}

Equations::Matrix Equations::jacobian(const Point& p) const {
  const Node& n = scene_.nodes[at(p.node)];
  const Index rows = n.kind == Node::Kind::mass ? 1 : 6;
  Matrix J = Matrix::Zero(rows, size_[at(p.node)]);
  if (n.kind == Node::Kind::mass) {
    J(0, p.site + 1) = Real(1);
    return J;
  }
  if (n.kind == Node::Kind::bushing) {
    J.middleCols(p.site < 0 ? 0 : 6, 6).setIdentity();
    return J;
  }
  J.leftCols(6).setIdentity();
  if (p.site < 0) return J;
  if (n.kind == Node::Kind::joint) {
    for (std::size_t k = 0; k < n.axes.size(); ++k)
      J.col(6 + static_cast<Index>(k)) = twist(n.axes[k]).cast<Real>();
    return J;
  }
  if (n.beam) return beams_[at(p.node)].sites[at(p.site)];
  J.leftCols(6) = tau(n.sites[at(p.site)].PC);
  if (n.omega.size() > 0) J.rightCols(n.omega.size()) = n.sites[at(p.site)].Phi.cast<Real>();
  return J;
}

void Equations::push(const Point& p, Index column, const Matrix& wrench) {
  const Matrix rows = jacobian(p).transpose() * wrench;
  P[0].block(x_[at(p.node)], column, rows.rows(), rows.cols()) -= rows;
}

void Equations::tie(std::size_t i) {
  const Tie& t = scene_.ties[i];
  const Matrix S = rows_of(scene_, t).cast<Real>();
  const bool one = one_axis(scene_, t.a);
  const Index row = lambda_[i];
  const auto [a, b] = std::pair{t.a, t.b};
  Matrix& here = t.input >= 0 ? P[2] : P[0];
  here.block(row, x_[at(a.node)], S.rows(), size_[at(a.node)]) += S * jacobian(a);
  push(a, row, S.transpose());
  if (t.input >= 0)
    R.block(row, input_[at(t.input)], S.rows(), S.rows()).setIdentity();
  else if (b.node >= 0) {
    const Matrix T = one ? Matrix::Identity(1, 1).eval() : six(t.T);
    P[0].block(row, x_[at(b.node)], S.rows(), size_[at(b.node)]) -= S * T.transpose() * jacobian(b);
    push(b, row, -(T * S.transpose()));
  }
  for (Index k = 0; k < S.rows(); ++k) held_.push_back({row + k, t.input >= 0});
}

void Equations::mechanisms() {
  for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
    const Node& n = scene_.nodes[i];
    for (std::size_t k = 0; n.kind == Node::Kind::joint && k < n.axes.size(); ++k) {
      const Index q = x_[i] + 6 + static_cast<Index>(k), row = Q_[i] + static_cast<Index>(k);
      const Mechanism* given = nullptr;
      for (const Mechanism& m : scene_.mechanisms)
        if (m.node == static_cast<int>(i) && m.axis == static_cast<int>(k)) given = &m;
      if (given && given->moves) {
        P[2](row, q) = Real(1);
        held_.push_back({row, !given->more.empty()});
      } else {
        P[0](row, row) = Real(1);
        if (given) P[0](row, q) = -Real(given->k);
        if (given) P[1](row, q) = -Real(given->c);
      }
      if (given) subtract(row, sum(given->more, 1));
    }
  }
}

/// Constraints that others imply leave, with their multipliers: by rank of the rows, scaled.
void Equations::drop_redundant() {
  const auto m = static_cast<Index>(held_.size());
  if (m == 0 || !closes(scene_)) return;
  Matrix G(n_, m);
  for (Index j = 0; j < m; ++j) {
    const Index row = held_[at(j)].row;
    G.col(j) = (P[0].row(row) + P[2].row(row)).transpose();
  }
  for (int round = 0; round < 3; ++round) {
    for (Index i = 0; i < n_; ++i) {
      const Real size = G.row(i).cwiseAbs().maxCoeff();
      if (size > Real(0)) G.row(i) /= size;
    }
    for (Index j = 0; j < m; ++j) {
      const Real size = G.col(j).cwiseAbs().maxCoeff();
      if (size > Real(0)) G.col(j) /= size;
    }
  }
  const Eigen::ColPivHouseholderQR<Matrix> qr(G);
  const auto pivot = [&](Index k) {
    using std::abs;
    return static_cast<double>(abs(qr.matrixQR()(k, k)) / abs(qr.matrixQR()(0, 0)));
  };
  Index rank = 0;
  while (rank < std::min(m, n_) && pivot(rank) > 1e-13) ++rank;
  if (rank > 0 && pivot(rank - 1) < 1e-7) none = "a posture is nearly singular";
  redundant = static_cast<int>(m - rank);
  if (redundant == 0) return;
  const Matrix shares = qr.matrixQR()
                            .topLeftCorner(rank, rank)
                            .triangularView<Eigen::Upper>()
                            .solve(Matrix(qr.matrixQR().block(0, rank, rank, m - rank)));
  const auto& order = qr.colsPermutation().indices();
  for (Index d = rank; d < m; ++d) {
    const Held& out = held_[at(order(d))];
    bool given = out.given;
    undetermined_[at(out.row)] = 1;
    for (Index k = 0; k < rank; ++k) {
      using std::abs;
      if (abs(shares(k, d - rank)) < Real(1e-9)) continue;
      given = given || held_[at(order(k))].given;
      undetermined_[at(held_[at(order(k))].row)] = 1;
    }
    if (given) none = "a prescribed motion stands against a constraint";
    for (Matrix& p : P) p.row(out.row).setZero();
    P[0](out.row, out.row) = Real(1);
  }
}

Equations::Signal Equations::read(const Reading& r) {
  using Measured = Reading::Measured;
  const Index rows = size_of(scene_, r);
  Signal s;
  for (Matrix& m : s.of) m.setZero(rows, n_);
  s.in.setZero(rows, inputs_);
  const auto i = at(r.at.node);
  const auto unknown = [&](int order, Index place) { s.of[at(order)](0, place) = Real(1); };
  const auto motion = [&](int order) {
    Matrix J = jacobian(r.at);
    if (J.rows() == 6) J = (half(r.half).transpose() * J).eval();
    s.of[at(order)].middleCols(x_[i], size_[i]) = J;
  };
  switch (r.measured) {
    case Measured::input: s.in.middleCols(input_[at(r.axis)], rows).setIdentity(); break;
    case Measured::accel: motion(2); break;
    case Measured::rate: motion(1); break;
    case Measured::position: motion(0); break;
    case Measured::reaction:
      for (std::size_t t = 0; t < scene_.ties.size(); ++t) {
        if (!(scene_.ties[t].a == r.at)) continue;
        Matrix S = rows_of(scene_, scene_.ties[t]).transpose().cast<Real>();
        if (S.rows() == 6) S = (half(r.half).transpose() * S).eval();
        if (r.at.site < 0) S = -S;
        s.of[0].middleCols(lambda_[t], S.cols()) += S;
        for (Index k = 0; k < S.cols(); ++k)
          if (undetermined_[at(lambda_[t] + k)] && !S.col(k).isZero(Real(0)))
            none = "an internal force is read";
      }
      break;
    case Measured::axis_accel: unknown(2, x_[i] + 6 + r.axis); break;
    case Measured::axis_rate: unknown(1, x_[i] + 6 + r.axis); break;
    case Measured::axis_position: unknown(0, x_[i] + 6 + r.axis); break;
    case Measured::axis_force:
      unknown(0, Q_[i] + r.axis);
      if (undetermined_[at(Q_[i] + r.axis)]) none = "an internal force is read";
      break;
    case Measured::stretch:
      unknown(0, x_[i] + 1);
      s.of[0](0, x_[i]) = Real(-1);
      break;
    case Measured::displacement:
    case Measured::displacement_rate: {
      Matrix& m = s.of[r.measured == Measured::displacement ? 0 : 1];
      m.middleCols(x_[i] + 6, 6) = half(r.half).transpose();
      m.middleCols(x_[i], 6) = -half(r.half).transpose();
      break;
    }
    case Measured::out: {
      const Node& n = scene_.nodes[i];
      s.of[0].middleCols(z_[i] + n.A.rows() + n.D.cols(), rows).setIdentity();
      break;
    }
  }
  return s;
}

Equations::Signal Equations::sum(const Sum& shares, Index rows) {
  Signal total;
  for (Matrix& m : total.of) m.setZero(rows, n_);
  total.in.setZero(rows, inputs_);
  for (const Share& share : shares) {
    const Signal s = read(share.of);
    const Matrix gain = share.gain.cast<Real>();
    for (std::size_t k = 0; k < 3; ++k) total.of[k] += gain * s.of[k];
    total.in += gain * s.in;
  }
  return total;
}

void Equations::subtract(Index row, const Signal& s) {
  for (std::size_t k = 0; k < 3; ++k) P[k].middleRows(row, s.in.rows()) -= s.of[k];
  R.middleRows(row, s.in.rows()) += s.in;
}

void Equations::outputs() {
  Index rows = 0;
  for (const Reading& r : scene_.outputs) rows += size_of(scene_, r);
  for (Matrix& q : Q) q.setZero(rows, n_);
  E.setZero(rows, inputs_);
  rows = 0;
  for (const Reading& r : scene_.outputs) {
    const Signal s = read(r);
    for (std::size_t k = 0; k < 3; ++k) Q[k].middleRows(rows, s.in.rows()) = s.of[k];
    E.middleRows(rows, s.in.rows()) = s.in;
    rows += s.in.rows();
  }
}

}  // namespace wild
