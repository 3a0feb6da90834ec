#pragma once

#include <memory>
#include <string>
#include <titop/graph/linalg/kinematics.hpp>
#include <titop/graph/value.hpp>
#include <variant>
#include <vector>

namespace titop {

/// Direction cosine matrix T_ba: `[v]_b = T_ba [v]_a`. On dual vectors it acts as diag(T_ba, T_ba).
///
/// It may carry the names of the two frames (the names of their nodes); then its direction is
/// checked wherever it is used. Without names a rotated signal is in an unknown frame, which is
/// accepted and listed in the compile log. The identity `Rotation()` without names, alone between
/// signals of two bodies, takes the names of their frames in that equation.
///
///     Rotation T_ba = Rotation::about({0, 0, 1}, pi / 2);
///     Rotation T_bc = T_ba * T_ac;            // only b<-a after a<-c, if the names are known
///     Rotation T_ab = T_ba.inverse();
///
/// Copies share their data.
class Rotation {
 public:
  Rotation() = default;  ///< identity, no names

  /// By `angle` [rad] about the unit vector along `axis` (any length but 0): the columns are the
  /// axes of the rotated frame a in frame b. `angle` may be a parameter. More than a turn is legal
  /// but rarely intended (degrees?): the compile log warns of it. Entries of 2.2e-16 and less are
  /// 0, so that a right angle is exact. Throws not_a_rotation.
  static Rotation about(const Vector3d& axis, Value angle);

  /// From its matrix. Throws not_a_rotation unless |T'T - I| <= 1e-9 and det T > 0; a smaller
  /// deviation (rounded digits of a file) is removed: nearest rotation by polar decomposition.
  static Rotation matrix(const Matrix3d& T);

  /// The same with frame names: `T.named("B", "A1")` takes components in A1 to components in B.
  Rotation named(std::string to, std::string from) const;
  /// True if no frame is named.
  bool nameless() const { return to().empty() && from().empty(); }

  /// T_ab from T_ba.
  Rotation inverse() const;

  /// T_cb * T_ba = T_ca. Throws frame if the inner names are known and differ.
  friend Rotation operator*(const Rotation& T_cb, const Rotation& T_ba);

  /// 3 x 3 matrix for these parameter values. O(number of composed rotations).
  Matrix3d at(ParameterValues values) const;
  /// The same at the nominal values.
  Matrix3d nominal() const;

  const std::string& to() const { return names().to; }
  const std::string& from() const { return names().from; }
  bool is_identity() const { return steps().empty(); }
  /// The values that its angles depend on.
  std::vector<Value> values() const;

  struct Turn {
    Vector3d axis;  ///< unit vector
    Value angle;    ///< [rad], a parameter or more than a turn
  };
  using Step = std::variant<Matrix3d, Turn>;
  /// The product, left to right; neighbouring matrices are merged.
  const std::vector<Step>& steps() const { return held().steps; }
  /// The rotation of these steps, to the last bit (from a file). Throws not_a_rotation as `matrix`
  /// does, and corrects nothing.
  static Rotation of_steps(std::vector<Step> steps);

 private:
  struct Names {
    std::string to, from;
  };
  struct NamedSteps {
    std::vector<Step> steps = {};
    std::shared_ptr<const Names> names = {};  ///< null: none, as of most
  };
  explicit Rotation(NamedSteps held) : held_(std::make_shared<const NamedSteps>(std::move(held))) {}
  static std::shared_ptr<const Names> named_pair(std::string to, std::string from);
  const NamedSteps& held() const;
  const Names& names() const;

  std::shared_ptr<const NamedSteps> held_;  ///< null: the identity, no names
};

}  // namespace titop
