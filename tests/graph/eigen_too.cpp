// Usual directives of a user's file. If a name of titop were also one of Eigen's, this would not
// compile.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <titop/titop.hpp>

using namespace Eigen;
using namespace titop;

TEST_CASE("titop beside `using namespace Eigen`") {
  const Matrix3d J = Vector3d(1, 2, 2.5).asDiagonal();
  const Vector3d PA(0.1, 0, 0);
  Diagram d{"both"};
  auto F = d.input("F", 6);
  auto B = d.add("B", RigidBody{.mass = 4, .inertia = J, .PA = PA});
  B.parent.force = -F;
  d.output("a", 6) = B.parent.accel;
  const MatrixXd inverse_mass = compile(d).static_gain();
  const Matrix6 M = rigid_mass(4, J, -PA);
  CHECK((inverse_mass * M - Matrix6::Identity()).cwiseAbs().maxCoeff() <= 1e-14);
}
