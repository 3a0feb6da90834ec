#include <doctest/doctest.h>

#include <algorithm>
#include <titop/blocks/fe/beam.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/graph/invert.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/symmetric.hpp>

#include "matrices.hpp"

/// Boundary conditions by inversion: with all inputs at 0, M_PC is clamped-free, M_PC^-1
/// free-clamped, M_PC^-1u clamped-clamped, M_PC^-1l free-free. Against eigenvalues of the mesh's
/// own M and K with the rows of the held ends struck out.

using namespace titop;
using namespace blocks_test;

namespace {

const Beam kBeam{.length = 1.2,
                 .section = rectangle(0.05, 0.03),
                 .material = {.E = 70e9, .nu = 0.3, .rho = 2700},
                 .elements = 3};

/// Frequencies of the mesh with these rows free, ascending.
VectorXd direct(Eigen::Index first, Eigen::Index last) {
  const fe::Mesh mesh = beam_mesh(kBeam);
  const Eigen::Index n = last - first;
  const VectorXd lambda =
      eigh(mesh.K.block(first, first, n, n), mesh.M.block(first, first, n, n)).lambda;
  return lambda.cwiseMax(0).cwiseSqrt();
}

/// Moduli of the poles with positive imaginary part, ascending.
VectorXd frequencies(const StateSpace& m) {
  const Eigen::VectorXcd poles = linalg::eigenvalues(m.A);
  std::vector<double> moduli;
  for (const Complex& p : poles)
    if (p.imag() > 0) moduli.push_back(std::abs(p));
  std::sort(moduli.begin(), moduli.end());
  return Eigen::Map<VectorXd>(moduli.data(), static_cast<Eigen::Index>(moduli.size()));
}

/// Relative error of the elastic frequencies; those of `exact` from `rigid` on. Further frequencies
/// of the model must be below 1e-3 of the first one: rigid motions, held ends.
double elastic_error(const StateSpace& model, const VectorXd& exact, Eigen::Index rigid) {
  const VectorXd all = frequencies(model);
  const Eigen::Index n = exact.size() - rigid;
  if (all.size() < n) return 1e300;
  for (Eigen::Index i = 0; i < all.size() - n; ++i)
    if (all(i) > 1e-3 * exact(rigid)) return 1e300;
  return ((all.tail(n) - exact.tail(n)).cwiseQuotient(exact.tail(n))).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("boundary conditions of a beam by inversion of its channels") {
  const FlexibleBody beam(kBeam);
  const Eigen::Index n = beam_mesh(kBeam).M.rows();
  CHECK(model_of(beam).order() == 2 * (n - 6));
  CHECK(elastic_error(model_of(beam), direct(6, n), 0) <= 1e-8);
  CHECK(elastic_error(invert(beam, {"parent"}), direct(0, n), 6) <= 1e-8);
  CHECK(elastic_error(invert(beam, {"C"}), direct(6, n - 6), 0) <= 1e-8);
  CHECK(elastic_error(invert(beam, {"C", "parent"}), direct(0, n - 6), 0) <= 1e-8);
}

TEST_CASE("boundary conditions per degree of freedom: pinned, sliding and turning ends") {
  const FlexibleBody beam(kBeam);
  const fe::Mesh mesh = beam_mesh(kBeam);
  const Eigen::Index n = mesh.M.rows();
  for (const auto& [channels, free_at_P, held_at_C] :
       {std::tuple(std::vector<std::string>{"parent.angular"}, std::vector<int>{3, 4, 5},
                   std::vector<int>{}),
        std::tuple(std::vector<std::string>{"parent(6)", "C(2)"}, std::vector<int>{5},
                   std::vector<int>{1}),
        std::tuple(std::vector<std::string>{"C.linear"}, std::vector<int>{},
                   std::vector<int>{0, 1, 2})}) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool at_P = i < 6, at_C = i >= n - 6;
      const auto listed = [](const std::vector<int>& list, Eigen::Index k) {
        return std::find(list.begin(), list.end(), static_cast<int>(k)) != list.end();
      };
      if (at_P ? listed(free_at_P, i) : !(at_C && listed(held_at_C, i - n + 6))) rows.push_back(i);
    }
    const VectorXd exact =
        eigh(mesh.K(rows, rows), mesh.M(rows, rows)).lambda.cwiseMax(0).cwiseSqrt();
    Eigen::Index rigid = 0;
    while (exact(rigid) < 1e-3 * exact(exact.size() - 1) * 1e-3) ++rigid;
    CAPTURE(channels.front());
    CHECK(elastic_error(invert(beam, channels), exact, rigid) <= 1e-7);
  }
}
