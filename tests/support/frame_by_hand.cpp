#include "loops/frame_by_hand.hpp"

namespace loops_test {
namespace {

Index size(const Frame& f) {
  Index n = std::ssize(f.spring_masses);
  for (const Frame::Body& b : f.bodies) n += b.beam ? 12 : 6;
  return n;
}

Eigen::Matrix<double, 6, 1> motion_along(const titop::Axis& axis) {
  Eigen::Matrix<double, 6, 1> s = Eigen::Matrix<double, 6, 1>::Zero();
  const bool slides = axis.kind == titop::Axis::Kind::prismatic;
  s.segment<3>(slides ? 0 : 3) = axis.direction.normalized();
  return s;
}

}  // namespace

FrameByHand::FrameByHand(const Frame& frame) : f(frame), all(size(f), 6, 12), held(0, size(f)) {
  Index n = 0;
  for (const Frame::Body& b : f.bodies) {
    first.push_back(n);
    if (b.beam)
      all.beam(b.tube().numbers(), all.unit(n, 6), all.unit(n + 6, 6), n + 12);
    else
      all.add(mass_at_P(b.mass, b.inertia(), b.PA), MatrixXd::Zero(6, 6), all.unit(n, 6));
    n += b.beam ? 12 : 6;
  }
  if (f.grounded) hold(all.unit(0, 6));
  for (const Frame::Joint& j : f.joints) {
    joints.push_back({held.rows(), 0, MatrixXd(0, held.cols()), VectorXd(0)});
    join(j);
    joints.back().count = held.rows() - joints.back().first;
  }
  for (const Frame::SpringMass& m : f.spring_masses) add(m, n++);
  for (const Frame::Bushing& k : f.bushings) add(k);
  const auto end = [&](int i) { return at_point(i, f.bodies[at(i)].E, true); };
  all.a.C << end(f.pushed), end(f.watched);
  all.a.B = end(f.pushed).transpose();
}

void FrameByHand::hold(const MatrixXd& rows) {
  held.conservativeResize(held.rows() + rows.rows(), held.cols());
  held.bottomRows(rows.rows()) = rows;
}

MatrixXd FrameByHand::at_point(int i, const Vector3d& X, bool end) const {
  const Frame::Body& b = f.bodies[at(i)];
  if (b.beam) return all.unit(first[at(i)] + (end ? 6 : 0), 6);
  return by_hand::tau(-b.here(X)) * all.unit(first[at(i)], 6);
}

MatrixXd FrameByHand::in_world(int i, const Vector3d& X, bool end) const {
  if (i == kGround) return MatrixXd::Zero(6, held.cols());
  return by_hand::dual(f.bodies[at(i)].R) * at_point(i, X, end);
}

void FrameByHand::add(const Frame::SpringMass& m, Index own) {
  const MatrixXd stretch = all.unit(own, 1);
  const MatrixXd motion =
      m.direction.transpose() * in_world(m.body, f.bodies[at(m.body)].E, true).topRows(3) + stretch;
  all.a.M += m.mass * motion.transpose() * motion;
  spring(m.stiffness * MatrixXd::Identity(1, 1), stretch);
}

void FrameByHand::add(const Frame::Bushing& k) {
  const MatrixXd apart = in_world(k.a, k.X, true) - in_world(k.b, k.X, true);
  spring(k.K, by_hand::dual(f.bodies[at(k.a)].R).transpose() * apart);
}

void FrameByHand::spring(const MatrixXd& K, const MatrixXd& stretch) {
  all.a.K += stretch.transpose() * K * stretch;
  all.a.D += kDamping * stretch.transpose() * K * stretch;
}

void FrameByHand::joint_spring(double stiffness, const MatrixXd& row) {
  spring(stiffness * MatrixXd::Identity(1, 1), row);
  JointRows& j = joints.back();
  j.stretch.conservativeResize(j.stretch.rows() + 1, held.cols());
  j.stretch.bottomRows(1) = row;
  j.stiffness.conservativeResize(j.stretch.rows());
  j.stiffness(j.stretch.rows() - 1) = stiffness;
}

void FrameByHand::join(const Frame::Joint& j) {
  const MatrixXd apart = in_world(j.a, j.X, j.closes) - in_world(j.b, j.X, true);
  if (j.axes.empty()) return hold(apart);
  MatrixXd S(6, std::ssize(j.axes));
  for (Index i = 0; i < S.cols(); ++i)
    S.col(i) = motion_along(j.axes[at(static_cast<int>(i))].axis);
  const Eigen::JacobiSVD<MatrixXd> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
  hold(svd.matrixU().rightCols(6 - S.cols()).transpose() * apart);
  const MatrixXd q = svd.solve(apart);
  Index k = 0;
  for (const Frame::JointAxis& a : j.axes) {
    const MatrixXd row = q.row(k++);
    if (a.mode == Frame::JointAxis::Mode::locked) hold(row);
    if (a.mode == Frame::JointAxis::Mode::sprung) joint_spring(a.stiffness, row);
  }
}

}  // namespace loops_test
