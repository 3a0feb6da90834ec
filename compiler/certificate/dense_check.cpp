#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <titop/compiler/certificate/dense_check.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/surroundings.hpp>
#include <titop/compiler/certificate/tried_points.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/steady_random.hpp>

/// The transfer of the dense model against that of the factors, as far as rounding of its entries
/// changes it.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using linalg::kEpsilon;

using linalg::at;

using T = std::complex<double>;

constexpr Index kColumns = 8;  ///< inputs are tried one by one up to this many

constexpr double kBelow = 0.5;  ///< of the slowest mode that shows, known to a decade

constexpr Index kPolesUpTo = 600;  ///< states; more take seconds

/// Inputs of one unit side by side in one column, at random; in two if they are few: by chance one
/// sample of rounding may be small. Those of many units must share columns, scaled so that they
/// have effects of like size on the states; without states, on the outputs.
solve::RowMatrix<T> tried_inputs(const StateSpace& m, const std::vector<int>& units) {
  const Index n = std::ssize(units), columns = 2 * n <= kColumns ? 2 * n : std::min(n, kColumns);
  solve::RowMatrix<T> u = solve::RowMatrix<T>::Zero(m.B.cols(), columns);
  const MatrixXd& effect = m.order() > 0 ? m.B : m.D;
  SteadyRandom random;
  for (Index k = 0, first = 0; k < std::max(n, columns); ++k) {
    if (k == n) first = 0;
    const int size = units[at(k % n)];
    const double push = effect.middleCols(first, size).cwiseAbs().maxCoeff();
    const double scale = columns < n && push > 0 ? 1 / push : 1;
    for (const Index end = first + size; first < end; ++first)
      u(first, k % columns) = scale * T(random.next(), random.next());
  }
  return u;
}

/// Sizes of outputs of one unit, by columns of the inputs.
struct OutputSizes {
  MatrixXd value;     ///< by the factors
  MatrixXd rounding;  ///< of the factors
};

/// Error of the dense model at one s.
struct Sample {
  T s;
  bool below;             ///< all modes that show
  solve::RowMatrix<T> y;  ///< by the factors
  OutputSizes sizes;
  MatrixXd off;
};

/// A x of all of these: once through memory.
std::vector<solve::RowMatrix<T>> moved(const MatrixXd& A,
                                       const std::vector<solve::RowMatrix<T>>& x) {
  const Index m = x.front().cols();
  MatrixXd parts(A.cols(), 2 * m * std::ssize(x));
  for (Index i = 0; i < std::ssize(x); ++i)
    parts.middleCols(2 * m * i, 2 * m) << x[at(i)].real(), x[at(i)].imag();
  const MatrixXd product = A * parts;
  std::vector<solve::RowMatrix<T>> result(x.size(), solve::RowMatrix<T>(A.rows(), m));
  for (Index i = 0; i < std::ssize(x); ++i) {
    result[at(i)].real() = product.middleCols(2 * m * i, m);
    result[at(i)].imag() = product.middleCols(2 * m * i + m, m);
  }
  return result;
}

/// The outputs in finer arithmetic, rounded; none if that has no digit either.
std::optional<solve::RowMatrix<T>> finer_outputs(const Factored& d, T s,
                                                 const solve::RowMatrix<T>& u) try {
  using Twofold = std::complex<solve::DoubleDouble>;
  const solve::RowMatrix<Twofold> inputs = solve::lifted<Twofold>(u);
  const Evaluation<Twofold> point(d, solve::Scalar<Twofold>::from(s), inputs,
                                  solve::Refinement::settled);
  const solve::RowMatrix<Twofold> y = point.outputs();
  solve::RowMatrix<T> rounded(y.rows(), y.cols());
  for (Index i = 0; i < y.size(); ++i) rounded(i) = solve::Scalar<Twofold>::round(y(i));
  if (!rounded.allFinite()) return {};
  return rounded;
} catch (const Error&) {
  return {};
}

/// C x + D u - y, as far as it exceeds the rounding of these sums; wrong entries of C and D exceed
/// it. If rounding of y may hide a difference above kWarn, y is computed in finer arithmetic.
solve::RowMatrix<T> off_by_outputs(const Factored& d, const StateSpace& m, T s,
                                   const solve::RowMatrix<T>& x, const solve::RowMatrix<T>& u,
                                   const solve::RowMatrix<T>& y, const MatrixXd& rounding,
                                   const std::vector<int>& units) {
  const solve::RowMatrix<T> model = m.C * x + m.D * u;
  const MatrixXd terms =
      m.C.cwiseAbs() * x.cwiseAbs() + m.D.cwiseAbs() * u.cwiseAbs() + MatrixXd(y.cwiseAbs());
  const auto beyond = [&](const solve::RowMatrix<T>& off, const MatrixXd& of_outputs) {
    const MatrixXd least = kNoise * (kEpsilon * terms + of_outputs);
    return solve::RowMatrix<T>((off.cwiseAbs().array() <= least.array()).select(T(0), off));
  };
  const solve::RowMatrix<T> all = model - y, off = beyond(all, rounding);
  const MatrixXd size = by_unit(y, units), hidden = by_unit(all - off, units);
  const MatrixXd noise = kNoise * by_unit(rounding.cast<T>(), units);
  if (!(size.array() > noise.array() && hidden.array() > kWarn * size.array()).any()) return off;
  const std::optional<solve::RowMatrix<T>> exact = finer_outputs(d, s, u);
  return exact ? beyond(model - *exact, MatrixXd::Zero(y.rows(), y.cols())) : off;
}

/// The residual of the factors' states in the equations of the dense model, A x + B u - s x, mapped
/// to the outputs by the factors. Points where these have no digit (springs along directions that
/// chains lock, far below all modes) give no verdict on the model: they go to `not_tried`.
std::vector<Sample> sample(const Factored& d, const StateSpace& m, const solve::RowMatrix<T>& u,
                           const Measure& units, std::vector<T>& not_tried) {
  const Tried where = tried(d, m.A, u, units.rows);
  std::vector<T> list;
  std::deque<Evaluation<T>> points;
  std::vector<solve::RowMatrix<T>> x;
  for (const T s : where.s) {
    try {
      points.emplace_back(d, s, u);
    } catch (const Error& error) {
      if (!error.has(Code::singular)) throw;
      not_tried.push_back(s);
      continue;
    }
    list.push_back(s);
    x.push_back(d.states.model_states(points.back().states(), u, s));
  }
  if (list.empty()) return {};
  const std::vector<solve::RowMatrix<T>> Ax = moved(m.A, x);
  std::vector<Sample> result;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const solve::RowMatrix<T> left = Ax[i] + m.B * u - list[i] * x[i];
    const auto& y = points[i].outputs();
    const MatrixXd rounding = points[i].rounding().cwiseAbs();
    const solve::RowMatrix<T> change =
        points[i].forced(d.states.expanded(left)) +
        off_by_outputs(d, m, list[i], x[i], u, y, rounding, units.rows);
    result.push_back({list[i],
                      std::abs(list[i]) < kBelow * where.slowest,
                      y,
                      {by_unit(y, units.rows), by_unit(rounding.cast<T>(), units.rows)},
                      by_unit(change, units.rows)});
  }
  return result;
}

/// An output that has digits in the factors at some s gives no verdict where it has none, such as
/// far below the modes of closed chains: it does not count there, and the s is reported.
void leave_out_lost(std::vector<Sample>& samples, std::vector<T>& not_tried) {
  const auto known = [](const Sample& p) {
    return Eigen::ArrayXX<bool>(p.sizes.value.array() > kAnotherDigit * p.sizes.rounding.array());
  };
  Eigen::ArrayXX<bool> anywhere = known(samples.front());
  for (const Sample& p : samples) anywhere = anywhere || known(p);
  for (Sample& p : samples) {
    const Eigen::ArrayXX<bool> lost = anywhere && !known(p);
    if (!lost.any()) continue;
    for (MatrixXd* m : {&p.off, &p.sizes.value, &p.sizes.rounding}) *m = lost.select(0, *m);
    if (!p.below) not_tried.push_back(p.s);
  }
}

/// Adds the error of double in the outputs to their rounding: an output that is 0 because states
/// cancel may be rounding alone. Without digits in finer arithmetic the estimate by double stays.
void find_rounding(Sample& p, const Factored& d, const solve::RowMatrix<T>& u,
                   const std::vector<int>& units) {
  if (const std::optional<solve::RowMatrix<T>> y = finer_outputs(d, p.s, u))
    p.sizes.rounding = p.sizes.rounding.cwiseMax(by_unit(p.y - *y, units));
}

constexpr Index kAnsweredUpTo = 100;  ///< states

/// The estimate itself may round at a point of very small mass: the residual is multiplied by 1e24
/// and cancels again. The dense model's own transfer gives an upper bound, with a factor
/// for one answer that is closer by chance than it should be.
void bound_by_answer(Sample& p, const StateSpace& m, const solve::RowMatrix<T>& u,
                     const std::vector<int>& units) {
  if (m.order() == 0) return;  // the difference is that of D
  const linalg::Solution x = linalg::solve(
      p.s * Eigen::MatrixXcd::Identity(m.order(), m.order()) - m.A, Eigen::MatrixXcd(m.B * u));
  if (!(x.rcond > 0) || !x.z.allFinite()) return;
  p.off = p.off.cwiseMin(kRoundingFactor * by_unit(m.C * x.z + m.D * u - p.y, units));
}

/// The largest error relative to the output's own size. An output at rounding level (0 by symmetry)
/// is measured by its neighbours or its cancelling terms, also independent of units. So is an
/// output below `of_neighbours` of those in its row and column.
DenseError::Worst relative(const MatrixXd& off, const OutputSizes& sizes, double of_neighbours) {
  const MatrixXd& size = sizes.value;
  if (!off.allFinite() || !size.allFinite()) return {HUGE_VAL};
  const VectorXd of_row = size.rowwise().maxCoeff(), of_column = size.colwise().maxCoeff();
  DenseError::Worst worst;
  for (Index i = 0; i < off.rows(); ++i)
    for (Index j = 0; j < off.cols(); ++j) {
      if (off(i, j) <= kUnderflow) continue;
      const double around = std::sqrt(of_row(i)) * std::sqrt(of_column(j));
      const bool noise =
          size(i, j) <= std::max(kNoise * sizes.rounding(i, j), of_neighbours * around);
      const double beside = std::max(around, sizes.rounding(i, j) / kEpsilon);
      if (const double error = off(i, j) / (noise ? beside : size(i, j)); error > worst.error)
        worst = {error, {}, static_cast<int>(i), static_cast<int>(j)};
    }
  return worst;
}

/// Below all visible modes an output of free motion grows, or falls, with a power of s without
/// limit, and so does the error of the dense model: there only the error relative to the output at
/// the same s counts.
DenseError worst_of(const std::vector<Sample>& samples) {
  DenseError worst;
  OutputSizes largest{MatrixXd::Zero(samples.front().off.rows(), samples.front().off.cols()),
                      MatrixXd::Zero(samples.front().off.rows(), samples.front().off.cols())};
  const bool all = std::ranges::all_of(samples, &Sample::below);
  const auto counts = [all](const Sample& p) { return all || !p.below; };
  for (const Sample& p : samples)
    if (counts(p)) {
      largest.value = largest.value.cwiseMax(p.sizes.value);
      largest.rounding = largest.rounding.cwiseMax(p.sizes.rounding);
    }
  const auto keep = [](const DenseError::Worst& found, T s, DenseError::Worst& so_far) {
    if (found.error > so_far.error) so_far = found, so_far.s = s;
  };
  for (const Sample& p : samples) {
    if (counts(p)) keep(relative(p.off, largest, kProductRounding), p.s, worst.beside_largest);
    keep(relative(p.off, p.sizes, 0), p.s, worst.where_small);
  }
  return worst;
}

/// The worst error relative to the output at the same s, for |s| from half the slowest pole of A
/// on: below all poles an output falls with a power of s, and no motion of the model is there. With
/// a pole at 0 (free motion, integrals) all s count, and so they do if the poles are too many.
DenseError::Worst where_used(const std::vector<Sample>& samples, const MatrixXd& A) {
  double lowest = 0;
  try {
    if (A.rows() > 0 && A.rows() <= kPolesUpTo)
      lowest = kBelow * linalg::eigenvalues(A).cwiseAbs().minCoeff();
  } catch (const Error&) {  // no poles: all s count
  }
  DenseError::Worst worst;
  for (const Sample& p : samples) {
    if (std::abs(p.s) < lowest) continue;
    const DenseError::Worst found = relative(p.off, p.sizes, 0);
    if (found.error > worst.error) worst = found, worst.s = p.s;
  }
  return worst;
}

/// Columns of the inputs tried become units of inputs.
DenseError by_input(DenseError e, int units) {
  for (DenseError::Worst* w : {&e.beside_largest, &e.where_small, &e.where_used})
    w->input = units <= kColumns && w->input >= 0 ? w->input % units : -1;
  return e;
}

}  // namespace

DenseError dense_error(const Factored& d, const StateSpace& m) {
  if (m.B.cols() == 0 || m.C.rows() == 0) return {{-1}, {-1}};
  const Measure units = measure(d.graph(), {});
  const solve::RowMatrix<T> u = tried_inputs(m, units.cols);
  std::vector<T> not_tried;
  std::vector<Sample> samples = sample(d, m, u, units, not_tried);
  if (samples.empty())
    return {.beside_largest = {-1}, .where_small = {-1}, .not_tried = std::move(not_tried)};
  leave_out_lost(samples, not_tried);
  DenseError found = worst_of(samples);
  const double worst = std::max(found.beside_largest.error, found.where_small.error);
  if (worst > kWarn && m.order() <= kAnsweredUpTo) {
    for (Sample& p : samples) {
      bound_by_answer(p, m, u, units.rows);
      find_rounding(p, d, u, units.rows);
    }
    found = worst_of(samples);
  }
  if (found.where_small.error > kSixDigits) found.where_used = where_used(samples, m.A);
  found = by_input(found, static_cast<int>(units.cols.size()));
  found.not_tried = std::move(not_tried);
  return found;
}

}  // namespace titop::detail
