#include <algorithm>
#include <cmath>
#include <titop/compiler/certificate/dense_check.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/without_rounding.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/steady_random.hpp>

/// The entries of the dense model against the factors that it was written from.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using linalg::at;
using linalg::kEpsilon;

/// Rows of [xdot; y] that share a size, first and count.
using Groups = std::vector<std::pair<Index, Index>>;

/// Block by block, then unit by unit.
Groups groups(const Factored& d) {
  Groups result;
  const std::vector<int>& kept = d.states.kept();
  for (const int i : d.layout().state_nodes) {
    const int begin = d.layout().state_first[at(i)],
              end = begin + static_cast<int>(d.numbers.blocks[at(i)]->A.rows());
    const auto first = std::lower_bound(kept.begin(), kept.end(), begin);
    result.emplace_back(first - kept.begin(), std::lower_bound(first, kept.end(), end) - first);
  }
  Index first = d.states.order();
  for (const int size : measure(d.graph(), {}).rows) {
    result.emplace_back(first, size);
    first += size;
  }
  return result;
}

/// Columns of [xdot; y] of the model, and their rounding.
struct ModelColumns {
  MatrixXd value, rounding;
};

ModelColumns by_factors(const Factored& d, const solve::RowMatrix<double>& x,
                        const solve::RowMatrix<double>& u) {
  const solve::RowMatrix<double> all = d.states.expanded(x, u);
  solve::RowMatrix<double> known(all.rows() + u.rows(), u.cols());
  known << all, u;
  const Instant now(d, std::move(known));
  // Cancellation on the way is not contained in the last terms: a sample of rounding gives its
  // size.
  const Instant off = now.doubt();
  const auto both = [&](const solve::RowMatrix<double>& xdot, const solve::RowMatrix<double>& y) {
    MatrixXd result(x.rows() + y.rows(), u.cols());
    result << d.states.kept_rows(xdot), y;
    return result;
  };
  const MatrixXd terms = kEpsilon * both(now.xdot_terms(), now.outputs_terms());
  return {both(now.xdot(), now.outputs()),
          terms.cwiseMax(both(off.xdot(), off.outputs()).cwiseAbs())};
}

/// Columns of [xdot; y]: states alone and inputs alone, so that in any units neither hides the
/// other.
constexpr Index kAlone = 2;

/// |dA| |x| and the like of a model's entries.
MatrixXd product(const StateSpace& of, const MatrixXd& x, const MatrixXd& u) {
  MatrixXd result(of.A.rows() + of.C.rows(), kAlone);
  result << of.A * x.cwiseAbs() + of.B * u.cwiseAbs(), of.C * x.cwiseAbs() + of.D * u.cwiseAbs();
  return result;
}

/// The largest |off| over the terms whose rounding is known; in groups at the level of `noise`,
/// where it is known, over the larger of rounding and noise.
double beside_terms(const MatrixXd& off, const ModelColumns& r, const Groups& groups,
                    const MatrixXd& noise = {}) {
  if (!off.allFinite() || !r.rounding.allFinite() || !noise.allFinite()) return HUGE_VAL;
  const auto around = [&r](Index first, Index count, Index j) {
    return std::sqrt(r.value.middleRows(first, count).cwiseAbs().maxCoeff()) *
           std::sqrt(r.value.col(j).cwiseAbs().maxCoeff());
  };
  double worst = 0;
  for (const auto& [first, count] : groups)
    for (Index j = 0; j < kAlone && count > 0; ++j) {
      const auto largest = [first = first, count = count, j](const MatrixXd& m) {
        return m.col(j).segment(first, count).cwiseAbs().maxCoeff();
      };
      double size = largest(r.rounding);
      if (noise.size() > 0 && largest(r.value) <= kNoise * largest(noise))
        size = std::max(size, largest(noise));
      if (largest(r.value) == 0)  // hit to the last bit, as another order of sums may not
        size = std::max(size, kEpsilon * kLeastSize * around(first, count, j));
      if (size > 0) worst = std::max(worst, kEpsilon * (largest(off) / size));
    }
  return worst;
}

}  // namespace

double dense_difference(const Factored& d, const StateSpace& m) {
  const Index n = m.A.rows();
  solve::RowMatrix<double> x = MatrixXd::Zero(n, kAlone), u = MatrixXd::Zero(m.B.cols(), kAlone);
  SteadyRandom random;
  for (Index i = 0; i < n; ++i) x(i, 0) = random.next();
  for (Index i = 0; i < u.rows(); ++i) u(i, 1) = random.next();
  ModelColumns r = by_factors(d, x, u);
  MatrixXd off = r.value, of_model = MatrixXd::Zero(off.rows(), kAlone);
  const auto take = [&](const MatrixXd& matrix, Index first, Index column, const auto& factors) {
    for (Index j = 0; j < matrix.cols(); ++j) {  // once through memory
      const double factor = factors(j, column);
      off.col(column).segment(first, matrix.rows()) -= matrix.col(j) * factor;
      of_model.col(column).segment(first, matrix.rows()) +=
          matrix.col(j).cwiseAbs() * (kEpsilon * std::abs(factor));
    }
  };
  take(m.A, 0, 0, x), take(m.B, 0, 1, u), take(m.C, n, 0, x), take(m.D, n, 1, u);
  r.rounding = r.rounding.cwiseMax(of_model);
  const double worst = beside_terms(off, r, groups(d));
  if (worst <= kWarn || worst == HUGE_VAL) return worst;
  return beside_terms(off, r, groups(d), product(rounding_of(d, m), x, u));
}

}  // namespace titop::detail
