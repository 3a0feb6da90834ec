#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <titop/blocks/spring_mass.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/mount.hpp>

#include "generate/diagrams/modes.hpp"
#include "solve/flexible_chain.hpp"
#include "support/rng.hpp"

/// The entries of the dense A of well-conditioned scenes, one by one, against 150 digits.

using namespace titop;
using namespace solve_test;
using titop_test::Rng;

namespace {

using titop::linalg::at;

/// Springs on springs; `split`: half of the masses are split between child and parent side.
struct Tree {
  std::vector<double> m, k, c, m0;
  std::vector<int> parent;

  Tree(std::uint64_t seed, int n, bool split) {
    Rng rng(seed);
    for (int i = 0; i < n; ++i) {
      m.push_back(rng.octaves(-1, 2));
      k.push_back(rng.octaves(3, 9));
      c.push_back(rng.octaves(-3, 0));
      m0.push_back(split && i > 0 && rng.chance(0.5) ? rng.octaves(-1, 2) : 0);
      parent.push_back(i - 1 - (i > 1 ? rng.below(std::min(i - 1, 2)) : 0));
    }
  }
  StateSpace written() const {
    Diagram d{"tree"};
    auto u = d.input("u");
    std::vector<SpringMass::Handle> z;
    for (std::size_t i = 0; i < m.size(); ++i)
      z.push_back(d.add(
          fmt::format("z{}", i + 1),
          SpringMass{.mass = m[i], .stiffness = k[i], .damping = c[i], .parent_mass = m0[i]}));
    ground(z.front());
    for (std::size_t i = 1; i < z.size(); ++i) mount(z[i], z[at(parent[i])].child);
    z.back().child.force = u;
    d.output("a") = z.back().child.accel;
    StateSpace model;
    compile(d, {.minimize_up_to = 0}).write(model);
    return model;
  }
  /// x_i'' by the stretch of j (k) or its rate (c): M_i x_i'' = -k_i s_i + sum over children k_j
  /// s_j.
  Real of(int i, int j, const std::vector<double>& subject) const {
    if (i < 0 || (j != i && parent[at(j)] != i)) return 0;
    Real mass = m[at(i)];
    for (std::size_t l = 0; l < m.size(); ++l)
      if (parent[l] == i) mass += m0[l];
    return (j == i ? Real(-subject[at(j)]) : Real(subject[at(j)])) / mass;
  }
  /// s_i'' by the stretch of j or its rate.
  Real entry(int i, int j, const std::vector<double>& subject) const {
    return of(i, j, subject) - of(parent[at(i)], j, subject);
  }
};

/// Distance in units of the last place of the exact value.
double ulps(double found, const Real& exact) {
  const double rounded = static_cast<double>(exact);
  if (rounded == 0) return found == 0 ? 0 : std::numeric_limits<double>::infinity();
  const double ulp = std::nextafter(std::abs(rounded), HUGE_VAL) - std::abs(rounded);
  return std::abs(static_cast<double>(Real(found) - exact)) / ulp;
}

/// Chain of flexible bodies with six modes.
struct Chain : FlexibleChain {
  Chain(std::uint64_t seed, int n) {
    Rng rng(seed);
    for (int i = 0; i < n; ++i) {
      ModalData body = titop::generate::random_modes(rng, 6, {"C"}, true);
      add(std::move(body), Rotation::matrix(rng.rotation()));
    }
  }
  StateSpace written() const {
    StateSpace model;
    compile(diagram(), {.minimize_up_to = 0}).write(model);
    return model;
  }
  /// The part of the eta'' rows and eta columns: -(M^-1) diag(omega^2), M over [x_P of the root;
  /// all eta].
  BigMatrix stiffness_part() const {
    const int n = static_cast<int>(data.size()), size = 6 + 6 * n;
    BigMatrix M(size, size), way(6, size);  // way: x_P of the present body
    for (int i = 0; i < 6; ++i) way(i, i) = Complex(1);
    for (int b = 0; b < n; ++b) {
      add_body(M, way, b);
      way = next(way, b);
    }
    BigMatrix E(size, 6 * n);
    for (int j = 0; j < 6 * n; ++j) {
      const Real w = data[at(j / 6)].omega(j % 6);
      E(6 + j, j) = Complex(-w * w);
    }
    const BigMatrix z = solve(std::move(M), std::move(E));
    BigMatrix result(6 * n, 6 * n);
    for (int i = 0; i < 6 * n; ++i)
      for (int j = 0; j < 6 * n; ++j) result(i, j) = z(6 + i, j);
    return result;
  }
  /// M += [way; eta]' [D_P, L_P'; L_P, I] [way; eta].
  void add_body(BigMatrix& M, const BigMatrix& way, int b) const {
    const ModalData& d = data[at(b)];
    const int size = way.cols;
    BigMatrix Y(12, size), own(12, 12), Yt(size, 12);
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < size; ++j) Y(i, j) = way(i, j);
      Y(6 + i, 6 + 6 * b + i) = Complex(1);
      own(6 + i, 6 + i) = Complex(1);
      for (int j = 0; j < 6; ++j) {
        own(i, j) = Complex(d.D_P(i, j));
        own(6 + i, j) = own(j, 6 + i) = Complex(d.L_P(i, j));
      }
    }
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < size; ++j) Yt(j, i) = Y(i, j);
    const BigMatrix more = Yt * (own * Y);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) M(i, j) = M(i, j) + more(i, j);
  }
  /// x_P of the next body: T' (tau x_P + Phi_C eta).
  BigMatrix next(const BigMatrix& way, int b) const {
    const ModalChild& c = data[at(b)].children.front();
    Eigen::MatrixXd tau = Eigen::MatrixXd::Identity(6, 6), back = Eigen::MatrixXd::Zero(6, 6);
    const Vector3d CP = -c.PC;
    tau.topRightCorner(3, 3) << 0, -CP.z(), CP.y(), CP.z(), 0, -CP.x(), -CP.y(), CP.x(), 0;
    back.topLeftCorner(3, 3) = back.bottomRightCorner(3, 3) = T[at(b)].transpose();
    BigMatrix here = BigMatrix(tau) * way;
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < 6; ++k)
        here(i, 6 + 6 * b + k) = here(i, 6 + 6 * b + k) + Complex(c.Phi_C(i, k));
    return BigMatrix(back) * here;
  }
};

}  // namespace

namespace {

double worst_entry(bool split) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Tree tree(seed, 25, split);
    const StateSpace model = tree.written();
    for (int i = 0; i < 25; ++i)
      for (int j = 0; j < 25; ++j) {
        worst = std::max(worst, ulps(model.A(2 * i + 1, 2 * j), tree.entry(i, j, tree.k)));
        worst = std::max(worst, ulps(model.A(2 * i + 1, 2 * j + 1), tree.entry(i, j, tree.c)));
      }
  }
  return worst;
}

}  // namespace

TEST_CASE("entries: of A for scalar trees, within 3 units of the last place") {
  CHECK(worst_entry(false) <= 3);
  // The masses of up to three children are added to the parent's, one by one; then comes a
  // division.
  CHECK(worst_entry(true) <= 3 + 3 + 1);
}

TEST_CASE("entries: of A for ten flexible bodies, 1e-15 of its norm") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Chain chain(seed, 10);
    const StateSpace model = chain.written();
    const Eigen::MatrixXd exact = rounded(chain.stiffness_part()).real();
    Eigen::MatrixXd found(60, 60);
    for (int b = 0; b < 10; ++b)
      for (int c = 0; c < 10; ++c)
        found.block(6 * b, 6 * c, 6, 6) = model.A.block(12 * b + 6, 12 * c, 6, 6);
    const double error = (found - exact).norm() / exact.norm();
    CHECK(error <= 1e-15);
  }
}
