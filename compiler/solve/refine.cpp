#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/steady_random.hpp>
#include <type_traits>

/// Error estimate and refinement of an evaluation. The rest is in evaluate.cpp.
namespace titop::detail {
namespace {

using linalg::at;

using solve::lifted;

/// Most steps of refinement: at kShrinks each they lead to 1e-18.
constexpr int kSteps = 30;
/// If steps shrink by less, refinement ends: at the rounding of T, or without a result if that is
/// not reached.
constexpr double kShrinks = 0.25;
/// If the first step changes no block of the unknowns by more, convergence is certain by then;
/// otherwise a second step must confirm it.
constexpr double kPlain = 1e-9;

}  // namespace

template <class T>
double Evaluation<T>::improve() {
  const solve::RowMatrix<T> correction = factors_->solve(rows_.residual(rhs_, unknowns_));
  unknowns_ += correction;
  return relative_to_outputs(correction);
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::rounding_of(const solve::RowMatrix<double>& magnitudes) {
  SteadyRandom random;
  auto result = solve::unwritten<T>(magnitudes.rows(), magnitudes.cols());
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    const double unit = random.unit() * solve::Scalar<T>::epsilon();
    for (Eigen::Index j = 0; j < result.cols(); ++j)
      result(i, j) = solve::lift<T>(unit * magnitudes(i, j));
  }
  return result;
}

/// One solution of twice the columns serves both.
template <class T>
typename Evaluation<T>::Losses Evaluation<T>::losses() {
  solve::RowMatrix<double> magnitudes;
  const solve::RowMatrix<T> residual = rows_.residual(rhs_, unknowns_, &magnitudes);
  const auto m = residual.cols();
  auto both = solve::unwritten<T>(residual.rows(), 2 * m);
  both << residual, rounding_of(magnitudes);
  const solve::RowMatrix<T> changes = factors_->solve(both);
  unknowns_ += changes.leftCols(m);
  return {relative_to_outputs(changes.leftCols(m)), relative_to_outputs(changes.rightCols(m))};
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::change_by_rounding() const {
  solve::RowMatrix<double> magnitudes;
  rows_.residual(rhs_, unknowns_, &magnitudes);
  return factors_->solve(rounding_of(magnitudes));
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::rounding() const {
  return outputs_of(change_by_rounding(), solve::RowMatrix<T>::Zero(u_.rows(), u_.cols()), nullptr);
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::rounding_of_values(std::span<const int> first) const {
  return values_of(change_by_rounding(), solve::RowMatrix<T>::Zero(u_.rows(), u_.cols()), first);
}

namespace {

/// The first rows of groups that share a unit: ports, dual vectors in halves; and the end.
template <class List>
std::vector<Eigen::Index> groups(const List& list, const std::vector<int>& first, int begin,
                                 Eigen::Index end) {
  std::vector<Eigen::Index> result;
  for (std::size_t i = 0; i < list.size(); ++i) {
    result.push_back(first[i] - begin);
    if (list[i].size == 6) result.push_back(first[i] - begin + 3);
  }
  std::sort(result.begin(), result.end());
  result.push_back(end);
  return result;
}

/// Largest entries of the blocks that these groups make.
template <class Matrix>
Eigen::MatrixXd block_sizes(const Matrix& m, const std::vector<Eigen::Index>& rows,
                            const std::vector<Eigen::Index>& cols) {
  const auto n = [](const auto& list) { return static_cast<Eigen::Index>(list.size()) - 1; };
  Eigen::MatrixXd result(n(rows), n(cols));
  for (Eigen::Index i = 0; i < result.rows(); ++i)
    for (Eigen::Index j = 0; j < result.cols(); ++j)
      result(i, j) = m.block(rows[at(static_cast<int>(i))], cols[at(static_cast<int>(j))],
                             rows[at(static_cast<int>(i) + 1)] - rows[at(static_cast<int>(i))],
                             cols[at(static_cast<int>(j) + 1)] - cols[at(static_cast<int>(j))])
                         .cwiseAbs()
                         .maxCoeff();
  return result;
}

template <class T>
Eigen::MatrixXcd rounded(const solve::RowMatrix<T>& m) {
  return m.unaryExpr([](const T& x) -> std::complex<double> { return solve::Scalar<T>::round(x); });
}

std::vector<Eigen::Index> groups_of_outputs(const Factored& d) {
  return groups(d.graph().outputs, d.layout().output_first, 0, std::ssize(d.layout().outputs));
}

std::vector<Eigen::Index> groups_of_inputs(const Factored& d) {
  return groups(d.graph().inputs, d.layout().input_first, 0, std::ssize(d.layout().inputs));
}

/// Geometric means of the largest entries in a block's row and column.
Eigen::MatrixXd beside(const Eigen::MatrixXd& size) {
  if (size.size() == 0) return size;
  return size.rowwise().maxCoeff().cwiseSqrt() * size.colwise().maxCoeff().cwiseSqrt();
}

/// The share of a block in double that finer arithmetic leaves of a 0, at most: T has 53 bits more,
/// some of which the elimination may lose.
constexpr double kLeftOfNoise = 0x1p-40;

/// Sizes of the blocks in double, at pick_s; 0 if double has no pivot.
Eigen::MatrixXd sizes_in_double(const Factored& d, const std::vector<Eigen::Index>& rows,
                                const std::vector<Eigen::Index>& cols) {
  using Double = std::complex<double>;
  try {
    return block_sizes(Evaluation<Double>(d, pick_s(d), unit_inputs<Double>(d)).outputs(), rows,
                       cols);
  } catch (const Error&) {
    return Eigen::MatrixXd::Zero(std::ssize(rows) - 1, std::ssize(cols) - 1);
  }
}

/// Blocks that the rounding of T, or of the data, changes altogether: zeros by structure, by
/// symmetry, or by rotations of frames, whose cos(pi / 2) is 6e-17. Of unknowns that are 0 the rows
/// have no terms: their rounding is relative to other blocks, or they are 0 if they are smaller
/// than in double by most of the digits that T has more. None if T has no digit of any block.
template <class T>
std::optional<Eigen::MatrixX<bool>> zeros_in(const Factored& d) {
  try {
    const Evaluation<T> point(d, solve::Scalar<T>::from(pick_s(d)), unit_inputs<T>(d));
    const auto rows = groups_of_outputs(d), cols = groups_of_inputs(d);
    const Eigen::MatrixXd size = block_sizes(rounded<T>(point.outputs()), rows, cols),
                          off = block_sizes(rounded<T>(point.rounding()), rows, cols);
    const double epsilon = solve::Scalar<T>::epsilon(),
                 of_data = kRoundings * solve::Scalar<double>::epsilon() / epsilon;
    const Eigen::ArrayXXd of_rounding =
        (kNoise * off).cwiseMax(kLeftOfNoise * sizes_in_double(d, rows, cols)).array();
    const Eigen::MatrixX<bool> zeros = !(size.array() > of_rounding);
    if (!zeros.all())
      return !(size.array() >
               of_rounding.max(of_data * off.array()).max(kNoise * epsilon * beside(size).array()));
  } catch (const Error&) {  // no pivot, or numbers that T has not
  }
  return {};
}

}  // namespace

const Eigen::MatrixX<bool>& Factored::zero_blocks() const {
  std::call_once(zeros_once, [&] {
    auto found = zeros_in<std::complex<solve::DoubleDouble>>(*this);
    if (!found) found = zeros_in<solve::Complex50>(*this);
    const auto n = [](const auto& list) { return static_cast<Eigen::Index>(list.size()) - 1; };
    zeros = found ? std::move(*found)
                  : Eigen::MatrixX<bool>::Constant(n(groups_of_outputs(*this)),
                                                   n(groups_of_inputs(*this)), true);
  });
  return zeros;
}

void Factored::clear_zero_outputs(solve::RowMatrix<double>& outputs) const {
  const std::vector<Eigen::Index> rows = groups_of_outputs(*this);
  for (Eigen::Index i = 0; i < zero_blocks().rows(); ++i)
    if (zero_blocks().row(i).all())
      outputs.middleRows(rows[at(i)], rows[at(i + 1)] - rows[at(i)]).setZero();
}

template <class T>
std::vector<Eigen::Index> Evaluation<T>::groups_of_columns() const {
  if (u_.cols() != u_.rows()) return {0, u_.cols()};  // not one column per input
  return groups_of_inputs(data_);
}

template <class T>
double Evaluation<T>::relative_to_outputs(const solve::RowMatrix<T>& unknowns) const {
  const solve::RowMatrix<T> none = solve::RowMatrix<T>::Zero(u_.rows(), u_.cols());
  const Eigen::MatrixXcd y = rounded<T>(outputs());
  const Eigen::MatrixXcd change = rounded<T>(outputs_of(unknowns, none, nullptr));
  if (!y.allFinite() || !change.allFinite()) return std::numeric_limits<double>::infinity();
  const auto rows = groups_of_outputs(data_), cols = groups_of_columns();
  const bool known = !std::is_same_v<T, double> && u_.cols() == u_.rows();
  const Eigen::MatrixXd size = block_sizes(y, rows, cols), off = block_sizes(change, rows, cols);
  // A block that is 0 by symmetry is rounding alone: it counts relative to its neighbours.
  const Eigen::MatrixXd around = beside(size);
  double worst = 0;
  for (Eigen::Index i = 0; i < size.rows(); ++i)
    for (Eigen::Index j = 0; j < size.cols(); ++j) {
      if (off(i, j) <= kUnderflow) continue;
      const bool noise = size(i, j) <= kNoise * off(i, j) && (!known || data_.zero_blocks()(i, j));
      // If all are 0 there is no size to compare with: no digit is known.
      const double of = noise ? around(i, j) : size(i, j);
      worst = std::max(worst, of > 0 ? off(i, j) / of : 1);
    }
  return worst;
}

template <class T>
Eigen::ArrayXd Evaluation<T>::sizes_of_unknowns(
    const solve::RowMatrix<std::complex<double>>& unknowns) const {
  const solve::Plan& plan = *data_.skeleton->as_written().plan;
  const auto cols = groups_of_columns();
  Eigen::ArrayXd sizes(plan.unknowns * u_.cols());  // room enough
  Eigen::Index n = 0;
  for (std::size_t v = 0; v < plan.first.size(); ++v)
    for (int i = 0; i < plan.structure.variable_size[v]; i += plan.structure.variable_unit[v])
      for (std::size_t j = 0; j + 1 < cols.size(); ++j) {
        double largest = 0;
        for (int row = plan.first[v] + i; row < plan.first[v] + i + plan.structure.variable_unit[v];
             ++row)
          for (Eigen::Index col = cols[j]; col < cols[j + 1]; ++col)
            largest = std::max(largest, solve::size_of(unknowns(row, col)));
        sizes(n++) = largest;
      }
  return sizes.head(n);
}

namespace {

bool at_most(const Eigen::ArrayXd& change, const Eigen::ArrayXd& limit) {
  return (change <= limit.max(kUnderflow)).all();
}

}  // namespace

/// The step of refinement from here. `rounding`, if given: about the error of the outputs by the
/// rounding of T: at mass ratios of 1e18, 32 digits leave few.
template <class T>
solve::RowMatrix<std::complex<double>> Evaluation<T>::change_by(
    const Evaluation<std::complex<double>>& coarse, double* rounding) const {
  using D = std::complex<double>;
  const auto down = [](const solve::RowMatrix<T>& m) {
    return solve::RowMatrix<D>(
        m.unaryExpr([](const T& x) -> D { return solve::Scalar<T>::round(x); }));
  };
  if (!rounding) return coarse.solve(down(rows_.residual(rhs_, unknowns_)));
  solve::RowMatrix<double> magnitudes;
  const solve::RowMatrix<T> residual = rows_.residual(rhs_, unknowns_, &magnitudes);
  const auto m = residual.cols();
  solve::RowMatrix<D> both(residual.rows(), 2 * m);
  both << down(residual), down(rounding_of(magnitudes));
  const solve::RowMatrix<D> changes = coarse.solve(both);
  *rounding = kRoundings * relative_to_outputs(lifted<T>(changes.rightCols(m)));
  return changes.leftCols(m);
}

/// Every step multiplies the error by I - F^-1 L (F: the factors, L: the matrix), and so the step
/// itself: a component in which F is inaccurate shrinks slowly, or not at all, and small steps do
/// not imply a small error. Convergence is judged by each of the unknowns, not by the outputs, of
/// which that component may be a small fraction.
template <class T>
void Evaluation<T>::refine(const Evaluation<std::complex<double>>& coarse) {
  unknowns_ = lifted<T>(coarse.unknowns());
  const Eigen::ArrayXd start = sizes_of_unknowns(coarse.unknowns());  // the step from 0
  Eigen::ArrayXd sizes_before;
  double before = 1, rounding = 0;
  bool leads = false;
  for (int step = 0; step < kSteps; ++step) {
    // If the first step is sufficient, it is so small that the rounding of T, far finer, is
    // negligible.
    const solve::RowMatrix<std::complex<double>> change =
        change_by(coarse, step == 1 ? &rounding : nullptr);
    const solve::RowMatrix<T> correction = lifted<T>(change);
    unknowns_ += correction;
    const double now = relative_to_outputs(correction);
    if (!leads) {
      const Eigen::ArrayXd sizes = sizes_of_unknowns(change);
      // A 0 with rounding is changed altogether by the first step, and not by later ones.
      leads = step == 0 ? at_most(sizes, kPlain * start)
                        : at_most(sizes, kShrinks * sizes_before.max(0x1p-53 * start));
      sizes_before = sizes;
    }
    refinement_error_ = leads || std::isinf(now) ? std::max(now, rounding) : 1;
    if (std::isinf(now) || (step > 0 && !leads)) return;
    // Prediction of the next step's change: this one's, times the same factor.
    const bool settled =
        now == 0 || (now <= kEnough && now * (now / before) <= solve::Scalar<T>::epsilon());
    if (leads && (settled || (step > 0 && !(now <= kShrinks * before)))) return;
    before = now;
  }
}

#define TITOP_INSTANTIATE(T)                                                                  \
  template double Evaluation<T>::improve();                                                   \
  template Evaluation<T>::Losses Evaluation<T>::losses();                                     \
  template solve::RowMatrix<T> Evaluation<T>::rounding() const;                               \
  template solve::RowMatrix<T> Evaluation<T>::rounding_of_values(std::span<const int>) const; \
  template void Evaluation<T>::refine(const Evaluation<std::complex<double>>&);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
