#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/plate.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

#include "dynamics.hpp"

/// Rounded digits of the matrices of a plate, which moves in three directions only.

using namespace titop;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using fe_test::relative;

namespace {

/// The two lowest of the plate held at z, rx, ry of its first node.
VectorXd omegas(const fe::Mesh& mesh) {
  std::vector<Index> free;
  for (Index i = 3; i < mesh.K.rows(); ++i) free.push_back(i);
  return eigh(mesh.K(free, free), mesh.M(free, free)).lambda.head(2).cwiseSqrt();
}

}  // namespace

TEST_CASE("effect of rounded digits of a plate's matrices, by differences") {
  const Plate plate{.a = 1.5,
                    .b = 0.8,
                    .thickness = 0.02,
                    .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                    .elements = {1, 1}};
  fe::Mesh mesh = plate_mesh(plate);
  mesh.digits = 4;
  const VectorXd found = fe::omega_uncertainty(mesh, "0,0", 2);
  VectorXd variance = VectorXd::Zero(2);
  const VectorXd omega = omegas(mesh);
  constexpr double step = 1e-4;
  for (MatrixXd* S : {&mesh.K, &mesh.M})
    for (Index i = 0; i < S->rows(); ++i)
      for (Index j = 0; j <= i; ++j) {
        const double entry = (*S)(i, j);
        std::array<VectorXd, 2> moved;
        for (std::size_t k = 0; k < 2; ++k) {
          (*S)(i, j) = (*S)(j, i) = entry * (1 + (k == 0 ? step : -step));
          moved.at(k) = omegas(mesh);
        }
        (*S)(i, j) = (*S)(j, i) = entry;
        variance += ((moved[0] - moved[1]) / (2 * step)).cwiseQuotient(omega).cwiseAbs2();
      }
  const VectorXd expected = 1e-4 * variance.cwiseSqrt();
  for (Index k = 0; k < 2; ++k) CHECK(relative(found(k), expected(k)) <= 1e-3);
}
