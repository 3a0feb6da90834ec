#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <titop/blocks/posture.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linalg::at;
using std::numbers::pi;

bool turns(const LoopStep& step) { return step.joint.kind == Axis::Kind::revolute; }

std::string name_of(const LoopStep& step, Index i) {
  return step.joint.name.empty() ? fmt::format("joint {}", i + 1) : step.joint.name;
}

/// The loop with its constants worked out.
struct KinematicLoop {
  const std::vector<LoopStep>& steps;
  std::vector<Vector3d> axis = {};  ///< unit vectors
  std::vector<Matrix3d> turn = {};
  std::vector<Index> unknown = {};
  double size = 0;  ///< [m], length by which translations are scaled

  explicit KinematicLoop(const std::vector<LoopStep>& list) : steps(list) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      const LoopStep& s = list[i];
      axis.push_back(unit_direction(s.joint));
      turn.push_back(s.turn.nominal());
      if (!s.given) unknown.push_back(static_cast<Index>(i));
      size += s.link.norm() + (turns(s) ? 0 : std::abs(s.given.value_or(s.guess)));
    }
    if (size == 0) size = 1;  // a spherical one: only rotations
  }

  VectorXd start() const {
    VectorXd q(static_cast<Index>(steps.size()));
    for (Index i = 0; i < q.size(); ++i) q(i) = steps[at(i)].given.value_or(steps[at(i)].guess);
    return q;
  }
};

/// Pose of the loop's end relative to its beginning, and its derivatives by the unknowns.
struct End {
  Vector6 gap;  ///< translation over the loop's size, rotation vector
  MatrixXd J;   ///< 6 x unknowns
  double cost() const { return gap.squaredNorm(); }
};

End end_of(const KinematicLoop& loop, const VectorXd& q) {
  const Index n = q.size();
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
  std::vector<Vector3d> r(at(n)), origin(at(n));
  for (Index i = 0; i < n; ++i) {
    const LoopStep& step = loop.steps[at(i)];
    r[at(i)] = R * loop.axis[at(i)];
    origin[at(i)] = p;
    if (turns(step))
      R = R * Eigen::AngleAxisd(q(i), loop.axis[at(i)]).toRotationMatrix();
    else
      p += q(i) * r[at(i)];
    p += R * step.link;
    R = R * loop.turn[at(i)];
  }
  const Eigen::AngleAxisd rotation(R);
  End end;
  end.gap << p / loop.size, rotation.angle() * rotation.axis();
  end.J = MatrixXd::Zero(6, static_cast<Index>(loop.unknown.size()));
  for (Index c = 0; c < end.J.cols(); ++c) {
    const auto i = at(loop.unknown[at(c)]);
    if (turns(loop.steps[i]))
      end.J.col(c) << r[i].cross(p - origin[i]) / loop.size, r[i];
    else
      end.J.col(c).head<3>() = r[i] / loop.size;
  }
  return end;
}

/// Smallest step in |J dq + gap|^2 + lambda |dq|^2.
VectorXd damped_step(const End& end, double lambda) {
  const Index n = end.J.cols();
  MatrixXd M(6 + n, n);
  M << end.J, std::sqrt(lambda) * MatrixXd::Identity(n, n);
  VectorXd rhs = VectorXd::Zero(6 + n);
  rhs.head(6) = -end.gap;
  return M.colPivHouseholderQr().solve(rhs);
}

/// Levenberg-Marquardt from q until no step helps any more.
VectorXd close_from(const KinematicLoop& loop, VectorXd q) {
  if (loop.unknown.empty()) return q;
  End end = end_of(loop, q);
  constexpr double kFirst = 1e-3, kSmallest = 1e-12, kNone = 1e-16, kLargest = 1e12;
  double lambda = kFirst;
  for (int i = 0; i < 200 && end.cost() > 0 && lambda < kLargest; ++i) {
    const VectorXd dq = damped_step(end, lambda);
    VectorXd next = q;
    for (Index c = 0; c < dq.size(); ++c) next(loop.unknown[at(c)]) += dq(c);
    const End there = end_of(loop, next);
    if (there.cost() < end.cost()) {
      q = next, end = there;
      lambda = lambda < kNone ? 0 : lambda / 10;
    } else {
      lambda = std::max(10 * lambda, kSmallest);
    }
  }
  return q;
}

bool closed(const End& end, double tolerance) {
  return end.gap.head<3>().norm() <= tolerance && end.gap.tail<3>().norm() <= tolerance;
}

/// The values that close the loop best: from the guesses, then from ever farther away.
VectorXd best(const KinematicLoop& loop, double tolerance) {
  constexpr int kStarts = 64;
  std::mt19937 random(1);
  // Written out: the standard's distributions differ from library to library.
  const auto uniform = [&] { return std::ldexp(static_cast<double>(random()), -31) - 1; };
  VectorXd found = close_from(loop, loop.start());
  for (int k = 1; k < kStarts && !closed(end_of(loop, found), tolerance); ++k) {
    VectorXd q = loop.start();
    for (const Index i : loop.unknown)
      q(i) += (turns(loop.steps[at(i)]) ? pi : loop.size) * uniform() * k / kStarts;
    const VectorXd other = close_from(loop, q);
    if (end_of(loop, other).cost() < end_of(loop, found).cost()) found = other;
  }
  return found;
}

void refuse_open(const KinematicLoop& loop, const End& end) {
  throw Error(
      Code::kinematic_loop,
      fmt::format("the loop of {} to {} cannot be closed: at best it stays open by {:.6g} m and "
                  "{:.6g} rad",
                  name_of(loop.steps.front(), 0),
                  name_of(loop.steps.back(), static_cast<Index>(loop.steps.size()) - 1),
                  end.gap.head<3>().norm() * loop.size, end.gap.tail<3>().norm()),
      "check the links' lengths and turns, give other values, or leave more joints to be found; "
      "PostureOptions{.tolerance = ...} allows for rounded data");
}

/// Throws singular if the given values do not determine the posture of the loop: J has a null
/// space.
void check_held(const KinematicLoop& loop, const End& end) {
  const Index n = end.J.cols();
  if (n == 0) return;
  const Eigen::JacobiSVD<MatrixXd> svd(end.J, Eigen::ComputeFullV);
  const VectorXd& s = svd.singularValues();
  constexpr double kHeld = 1e-6;   // of the largest: less may be rounding of a dead centre
  constexpr double kMoves = 1e-3;  // of the largest: joints that are named
  if (n <= 6 && s(n - 1) > kHeld * s(0)) return;
  const VectorXd motion = svd.matrixV().col(n - 1);
  std::string names;
  for (Index c = 0; c < n; ++c)
    if (std::abs(motion(c)) > kMoves * motion.cwiseAbs().maxCoeff()) {
      const Index i = loop.unknown[at(c)];
      names += (names.empty() ? "" : ", ") + name_of(loop.steps[at(i)], i);
    }
  throw Error(Code::singular,
              fmt::format("the posture is not determined: {} can still move while the loop is "
                          "closed",
                          names),
              "give one of their values; at a dead centre, the value of another joint");
}

void check_finite(const std::vector<LoopStep>& loop) {
  if (loop.empty())
    throw Error(Code::bad_value, "a loop without joints has no posture", "give its joints");
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (!loop[i].link.allFinite() || !std::isfinite(loop[i].given.value_or(0)) ||
        !std::isfinite(loop[i].guess))
      throw Error(Code::not_finite,
                  fmt::format("the loop's {} has a value or a link that is not finite",
                              name_of(loop[i], static_cast<Index>(i))),
                  "check given, guess and link");
}

/// The angle that differs from it by whole turns and is nearest to the guess.
double near_guess(const LoopStep& step, double q) {
  if (!turns(step) || step.given) return q;
  return q - 2 * pi * std::round((q - step.guess) / (2 * pi));
}

}  // namespace

Posture posture(const std::vector<LoopStep>& steps, const PostureOptions& options) {
  check_finite(steps);
  const KinematicLoop loop(steps);
  const VectorXd q = best(loop, options.tolerance);
  const End end = end_of(loop, q);
  if (!closed(end, options.tolerance)) refuse_open(loop, end);
  check_held(loop, end);
  Posture p;
  p.gap = end.gap.head<3>().norm() * loop.size;
  p.gap_angle = end.gap.tail<3>().norm();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const LoopStep& step = steps[i];
    const LoopStep& before = steps[i == 0 ? steps.size() - 1 : i - 1];
    p.values.push_back(near_guess(step, q(static_cast<Index>(i))));
    const double value = p.values.back();
    p.T_ba.push_back(turns(step) ? before.turn * Rotation::about(step.joint.direction, value)
                                 : before.turn);
    p.offset.push_back(turns(step) ? Vector3d(Vector3d::Zero())
                                   : Vector3d(before.turn.nominal() * loop.axis[i] * value));
  }
  return p;
}

}  // namespace titop
