#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/solve/transfer_blocks.hpp>
#include <titop/graph/linalg/index.hpp>
#include <type_traits>

/// Errors of an evaluation, and blocks that are 0. The rest is in evaluate.cpp.
namespace titop::detail {
namespace {

using linalg::at;

}  // namespace

template <class T>
solve::RowMatrix<T> Evaluation<T>::rounding() const {
  return outputs_of(change_by_rounding(), solve::RowMatrix<T>::Zero(u_.rows(), u_.cols()), nullptr);
}

template <class T>
solve::RowMatrix<T> Evaluation<T>::rounding_of_values(std::span<const int> first) const {
  return values_of(change_by_rounding(), solve::RowMatrix<T>::Zero(u_.rows(), u_.cols()), first);
}

namespace {

/// The share of a block in double that finer arithmetic leaves of a 0, at most: T has 53 bits more,
/// some of which the elimination may lose.
constexpr double kLeftOfNoise = 0x1p-40;

/// Sizes of the blocks in double, at pick_s; 0 if double has no pivot.
Eigen::MatrixXd sizes_in_double(const Factored& d, const PortGroups& rows, const PortGroups& cols) {
  using Double = std::complex<double>;
  try {
    return block_sizes(Evaluation<Double>(d, pick_s(d), unit_inputs<Double>(d)).outputs(), rows,
                       cols);
  } catch (const Error&) {
    return Eigen::MatrixXd::Zero(rows.size(), cols.size());
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
    const auto rows = groups_of_outputs(d, all_outputs(d)),
               cols = groups_of_inputs(d, all_inputs(d));
    const Eigen::MatrixXd size = block_sizes(solve::in_double(point.outputs()), rows, cols),
                          off = block_sizes(solve::in_double(point.rounding()), rows, cols);
    const double epsilon = solve::Scalar<T>::epsilon(),
                 of_data = kRoundings * solve::Scalar<double>::epsilon() / epsilon;
    const Eigen::ArrayXXd of_rounding =
        (kNoise * off).cwiseMax(kLeftOfNoise * sizes_in_double(d, rows, cols)).array();
    const Eigen::MatrixX<bool> zeros = !(size.array() > of_rounding);
    if (!zeros.all())
      return !(size.array() > of_rounding.max(of_data * off.array())
                                  .max(kNoise * epsilon * beside_blocks(size).array()));
  } catch (const Error&) {  // no pivot, or numbers that T has not
  }
  return {};
}

}  // namespace

const Eigen::MatrixX<bool>& Factored::zero_blocks() const {
  return zeros.get([&] {
    auto found = zeros_in<std::complex<solve::DoubleDouble>>(*this);
    if (!found) found = zeros_in<solve::Complex50>(*this);
    if (found) return std::move(*found);
    return Eigen::MatrixX<bool>(
        Eigen::MatrixX<bool>::Constant(groups_of_outputs(*this, all_outputs(*this)).size(),
                                       groups_of_inputs(*this, all_inputs(*this)).size(), true));
  });
}

void Factored::clear_zero_outputs(solve::RowMatrix<double>& outputs) const {
  const std::vector<Eigen::Index> rows = groups_of_outputs(*this, all_outputs(*this)).first;
  for (Eigen::Index i = 0; i < zero_blocks().rows(); ++i)
    if (zero_blocks().row(i).all())
      outputs.middleRows(rows[at(i)], rows[at(i + 1)] - rows[at(i)]).setZero();
}

template <class T>
PortGroups Evaluation<T>::groups_of_columns() const {
  if (!ports_) return {{0, u_.cols()}, {0}};
  return groups_of_inputs(data_, *ports_);
}

template <class T>
double Evaluation<T>::relative_to_results(const solve::RowMatrix<T>& change) const {
  const solve::RowMatrix<T> none = solve::RowMatrix<T>::Zero(u_.rows(), u_.cols());
  const bool known = !std::is_same_v<T, double> && ports_;
  const PortGroups rows = groups_of_outputs(data_, all_outputs(data_)), cols = groups_of_columns();
  return relative_change(
      solve::in_double(outputs()), solve::in_double(outputs_of(change, none, nullptr)), rows, cols,
      [&](Eigen::Index i, Eigen::Index j) {
        return !known || data_.zero_blocks()(rows.index[at(i)], cols.index[at(j)])
                   ? ZeroBlock::assumed
                   : ZeroBlock::no;
      });
}

template <class T>
Eigen::ArrayXd Evaluation<T>::sizes_of_unknowns(
    const solve::RowMatrix<std::complex<double>>& unknowns) const {
  const solve::Plan& plan = *data_.skeleton->as_written().plan;
  const std::vector<Eigen::Index> cols = groups_of_columns().first;
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

template <class T>
Eigen::VectorXd Evaluation<T>::unit_sizes() const {
  const std::vector<std::int16_t>& exponents = data_.scale()->of_unknowns;
  Eigen::VectorXd sizes(std::ssize(exponents));
  for (Eigen::Index i = 0; i < sizes.size(); ++i) sizes(i) = std::ldexp(1.0, exponents[at(i)]);
  return sizes;
}

template <class T>
Eigen::VectorXd Evaluation<T>::sums_of(const Eigen::VectorXd& sizes) const {
  const solve::RowMatrix<T> x = solve::lifted<T>(sizes),
                            none = solve::RowMatrix<T>::Zero(x.rows(), 1);
  solve::RowMatrix<double> sums;
  rows_.residual(none, x, &sums);
  return sums.col(0);
}

#define TITOP_INSTANTIATE(T)                                                                  \
  template solve::RowMatrix<T> Evaluation<T>::rounding() const;                               \
  template solve::RowMatrix<T> Evaluation<T>::rounding_of_values(std::span<const int>) const; \
  template double Evaluation<T>::relative_to_results(const solve::RowMatrix<T>&) const;       \
  template Eigen::ArrayXd Evaluation<T>::sizes_of_unknowns(                                   \
      const solve::RowMatrix<std::complex<double>>&) const;                                   \
  template Eigen::VectorXd Evaluation<T>::unit_sizes() const;                                 \
  template Eigen::VectorXd Evaluation<T>::sums_of(const Eigen::VectorXd&) const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
