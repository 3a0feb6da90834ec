#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <titop/titop.hpp>
#include <vector>

/// Poles of closed chains, whose coordinates share springs and masses: by the potential energy they
/// are those of a symmetric problem. Against M and K of the mesh with both ends held.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

Beam beam() {
  return {.length = 2,
          .section = rectangle(0.06, 0.04),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = 6};
}

System held_twice() {
  Diagram d{"held twice"};
  auto rod = d.add("rod", FlexibleBody(beam()));
  ground(rod);
  ground(rod.child);
  d.output("base", 6) = rod.parent.force;
  return compile(d, {.minimize_up_to = 0});
}

/// All coordinates but those of the two ends.
Eigen::VectorXd frequencies() {
  const fe::Mesh mesh = beam_mesh(beam());
  std::vector<Index> free;
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (mesh.dofs[i].point != 0 && mesh.dofs[i].point + 1 != mesh.points.size())
      free.push_back(static_cast<Index>(i));
  const MatrixXd K = mesh.K(free, free), M = mesh.M(free, free);
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, M, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseSqrt();
}

}  // namespace

TEST_CASE("poles: a beam held at both ends is undamped, at the frequencies of its mesh") {
  const Eigen::VectorXd exact = frequencies();
  const std::vector<Pole> found = held_twice().poles();
  REQUIRE(static_cast<Index>(found.size()) == exact.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].s.real() == 0);
    CHECK(found[i].pair);
    REQUIRE(found[i].blocks.size() == 1);
    CHECK(std::abs(found[i].blocks.front().second - 1) <= 1e-9);
    CHECK(std::abs(found[i].omega / exact(static_cast<Index>(i)) - 1) <= 1e-9);
  }
}
