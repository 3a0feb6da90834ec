#include <doctest/doctest.h>

#include "control/grid_margins.hpp"

/// Margins of two loops at once, and of each alone, against a fine grid of their factors.

using namespace titop;
using namespace titop_test;

namespace {

/// Two loops with weak couplings: the entries of L as sums of fractions, and as one model.
struct LoopPair {
  std::vector<Fraction> entry[2][2], all;
  StateSpace L;

  explicit LoopPair(Rng& rng) {
    std::vector<StateSpace> models;
    Index n = 0;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        entry[i][j] = random_parts(rng, i == j && rng.chance(0.2), false, i == j ? 0.3 : 0.03,
                                   i == j ? 2 : 1);
        all.insert(all.end(), entry[i][j].begin(), entry[i][j].end());
        models.push_back(model_of(entry[i][j]));
        n += models.back().A.rows();
      }
    L.A = MatrixXd::Zero(n, n), L.B = MatrixXd::Zero(n, 2), L.C = MatrixXd::Zero(2, n);
    L.D = MatrixXd::Zero(2, 2);
    Index first = 0;
    for (int k = 0; k < 4; ++k) {
      const StateSpace& m = models[static_cast<std::size_t>(k)];
      L.A.block(first, first, m.A.rows(), m.A.rows()) = m.A;
      L.B.block(first, k % 2, m.A.rows(), 1) = m.B;
      L.C.block(k / 2, first, 1, m.A.rows()) = m.C;
      first += m.A.rows();
    }
  }

  Complex operator()(int i, int j, Real w) const {
    Complex sum = 0;
    for (const Fraction& p : entry[i][j]) sum += p.at(w);
    return sum;
  }
  /// Loop i with the other one closed.
  Complex alone(int i, Real w) const {
    const int o = 1 - i;
    const LoopPair& g = *this;
    return g(i, i, w) - g(i, o, w) * g(o, i, w) / (1.0L + g(o, o, w));
  }
};

/// Least singular value of the 2 x 2 matrix [a b; c d] by its two invariants.
Real least_value(Complex a, Complex b, Complex c, Complex d) {
  const Real sum = std::norm(a) + std::norm(b) + std::norm(c) + std::norm(d),
             det = std::abs(a * d - b * c);
  return det / std::sqrt((sum + std::sqrt(std::max(sum * sum - 4 * det * det, 0.0L))) / 2);
}

/// Least singular value of 1 + L over the grid.
Real nearest(const LoopPair& g, const std::vector<Real>& list) {
  return least(
      [&](Real w) {
        return least_value(1.0L + g(0, 0, w), g(0, 1, w), g(1, 0, w), 1.0L + g(1, 1, w));
      },
      list);
}

/// alpha over the grid: (1 + L) (1 - L)^-1 = -1 + 2 (1 - L)^-1 has the least singular value alpha
/// / 2.
Real disk(const LoopPair& g, const std::vector<Real>& list) {
  return least(
      [&](Real w) {
        const Complex a = 1.0L - g(0, 0, w), b = -g(0, 1, w), c = -g(1, 0, w),
                      d = 1.0L - g(1, 1, w), det = a * d - b * c;
        return 2 * least_value(-1.0L + 2.0L * d / det, -2.0L * b / det, -2.0L * c / det,
                               -1.0L + 2.0L * a / det);
      },
      list);
}

}  // namespace

TEST_CASE("30 random pairs of loops") {
  Rng rng(72);
  int done = 0;
  double largest = 0, at_once = 0;
  while (done < 30) {
    const LoopPair g(rng);
    const Margins m = margins(g.L);
    CHECK(m.nyquist.agree);
    CHECK(m.nyquist.closed_right == unstable(g.L));
    if (!m.stable) continue;
    ++done;
    const std::vector<Real> list = grid(g.all);
    for (int i = 0; i < 2; ++i) {
      const auto at = [&](Real w) { return g.alone(i, w); };
      const double error =
          worst(m.loops[static_cast<std::size_t>(i)], expected(at, list, at(1e-18L)));
      if (error > 1e-6) MESSAGE(done, ": ", error, "\n", to_string(m));
      largest = std::max(largest, error);
    }
    at_once = std::max(at_once, off(m.nearest.value, std::min(nearest(g, list), 1.0L)));
    for (const LoopMargins& l : m.loops) CHECK(m.disk.alpha <= l.disk.alpha * (1 + 1e-9));
    at_once = std::max(at_once, off(m.disk.alpha, std::min(disk(g, list), 2.0L)));
  }
  MESSAGE("largest difference ", largest, ", of both at once ", at_once);
  CHECK(largest <= 1e-6);
  CHECK(at_once <= 1e-6);
}
