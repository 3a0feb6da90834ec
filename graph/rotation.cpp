#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/rotation.hpp>

namespace titop {
namespace {

/// Right angles are exact: the cosine of pi / 2 in double, 6e-17, would couple motions that are
/// independent.
Matrix3d turn(const Vector3d& axis, double angle) {
  const Matrix3d T = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return (T.array().abs() <= std::numeric_limits<double>::epsilon()).select(0, T);
}

}  // namespace

Rotation Rotation::about(const Vector3d& axis, Value angle) {
  const double length = axis.norm();
  if (!std::isfinite(length) || length == 0 || !std::isfinite(angle.nominal()))
    throw Error(Code::not_a_rotation,
                fmt::format("no rotation about the axis ({}, {}, {}) by {}", axis.x(), axis.y(),
                            axis.z(), angle.nominal()),
                "give a finite axis other than 0 and a finite angle [rad]");
  if (angle.is_parameter() || std::abs(angle.nominal()) > 2 * std::numbers::pi)
    return Rotation(NamedSteps{{Turn{axis / length, angle}}});
  return Rotation(NamedSteps{{turn(axis / length, angle.nominal())}});
}

const Rotation::NamedSteps& Rotation::held() const {
  static const NamedSteps nothing;
  return held_ ? *held_ : nothing;
}

const Rotation::Names& Rotation::names() const {
  static const Names none;
  return held_ && held_->names ? *held_->names : none;
}

std::shared_ptr<const Rotation::Names> Rotation::named_pair(std::string to, std::string from) {
  if (to.empty() && from.empty()) return {};
  return std::make_shared<const Names>(Names{std::move(to), std::move(from)});
}

namespace {

void check_rotation(const Matrix3d& T) {
  const double off = (T.transpose() * T - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= linalg::kMatrixDigits))  // also catches not-a-number
    throw Error(Code::not_a_rotation,
                fmt::format("the matrix is not orthogonal: T'T differs from I by {:.2g}", off),
                "its columns must be the unit vectors of frame a in frame b; at most 1e-9 may be "
                "missing, which is then repaired");
  if (T.determinant() < 0)
    throw Error(Code::not_a_rotation, "the matrix mirrors: its determinant is -1",
                "its columns must form a right-handed frame");
}

}  // namespace

Rotation Rotation::of_steps(std::vector<Step> steps) {
  for (const Step& step : steps)
    if (const auto* T = std::get_if<Matrix3d>(&step))
      check_rotation(*T);
    else if (const double off = std::get<Turn>(step).axis.norm() - 1;
             !(std::abs(off) <= linalg::kMatrixDigits))
      throw Error(Code::not_a_rotation, fmt::format("an axis of length {}", off + 1),
                  "give a unit vector");
  return Rotation(NamedSteps{std::move(steps)});
}

Rotation Rotation::matrix(const Matrix3d& T) {
  check_rotation(T);
  const Eigen::JacobiSVD<Matrix3d> svd(T, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // An exact rotation (such as a permutation of axes) must stay exact.
  const bool exact = (T.transpose() * T - Matrix3d::Identity()).isZero(0);
  return Rotation(NamedSteps{{exact ? T : Matrix3d(svd.matrixU() * svd.matrixV().transpose())}});
}

Rotation Rotation::named(std::string to, std::string from) const {
  return Rotation(NamedSteps{steps(), named_pair(std::move(to), std::move(from))});
}

Rotation Rotation::inverse() const {
  NamedSteps inverse{{}, named_pair(from(), to())};
  for (auto step = steps().rbegin(); step != steps().rend(); ++step) {
    if (const auto* T = std::get_if<Matrix3d>(&*step)) {
      inverse.steps.push_back(Matrix3d(T->transpose()));
    } else {
      const Turn& t = std::get<Turn>(*step);
      inverse.steps.push_back(Turn{-t.axis, t.angle});
    }
  }
  return Rotation(std::move(inverse));
}

Rotation operator*(const Rotation& T_cb, const Rotation& T_ba) {
  if (!T_cb.from().empty() && !T_ba.to().empty() && T_cb.from() != T_ba.to())
    throw Error(Code::frame,
                fmt::format("the rotation {}<-{} cannot follow the rotation {}<-{}", T_cb.to(),
                            T_cb.from(), T_ba.to(), T_ba.from()),
                "compose T_cb * T_ba, or take the inverse of one of them");
  Rotation::NamedSteps both = T_cb.held();
  both.names = Rotation::named_pair(T_cb.to(), T_ba.from());
  for (const auto& step : T_ba.steps()) {
    auto* last = both.steps.empty() ? nullptr : std::get_if<Matrix3d>(&both.steps.back());
    const auto* next = std::get_if<Matrix3d>(&step);
    if (last && next)
      *last = Matrix3d(*last * *next);
    else
      both.steps.push_back(step);
  }
  return Rotation(std::move(both));
}

Matrix3d Rotation::at(ParameterValues values) const {
  Matrix3d T = Matrix3d::Identity();
  for (const Step& step : steps()) {
    if (const auto* M = std::get_if<Matrix3d>(&step)) {
      T = steps().size() == 1 ? *M : Matrix3d(T * *M);
    } else {
      const Turn& t = std::get<Turn>(step);
      T = Matrix3d(T * turn(t.axis, t.angle.at(values)));
    }
  }
  return T;
}

Matrix3d Rotation::nominal() const {
  Matrix3d T = Matrix3d::Identity();
  for (const Step& step : steps()) {
    const auto* M = std::get_if<Matrix3d>(&step);
    T = Matrix3d(T *
                 (M ? *M : turn(std::get<Turn>(step).axis, std::get<Turn>(step).angle.nominal())));
  }
  return T;
}

std::vector<Value> Rotation::values() const {
  std::vector<Value> result;
  for (const Step& step : steps())
    if (const auto* t = std::get_if<Turn>(&step)) result.push_back(t->angle);
  return result;
}

}  // namespace titop
