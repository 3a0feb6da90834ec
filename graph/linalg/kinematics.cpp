#include <titop/graph/linalg/kinematics.hpp>

namespace titop {

Matrix3d cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Matrix6 tau(const Vector3d& CP) {
  Matrix6 t = Matrix6::Identity();
  t.topRightCorner<3, 3>() = cross(CP);
  return t;
}

Matrix6 rigid_mass(double mass, const Matrix3d& I_A, const Vector3d& AP) {
  Matrix6 D = Matrix6::Zero();
  const Matrix3d S = cross(AP);
  D.topLeftCorner<3, 3>() = mass * Matrix3d::Identity();
  D.topRightCorner<3, 3>() = mass * S;
  D.bottomLeftCorner<3, 3>() = -mass * S;
  D.bottomRightCorner<3, 3>() = I_A - mass * S * S;
  return D;
}

}  // namespace titop
