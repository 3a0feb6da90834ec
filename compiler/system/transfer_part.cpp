#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/solve/transposed_evaluation.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <type_traits>

namespace titop::detail {
namespace {

using Double = std::complex<double>;
using Extended = std::complex<long double>;
using Twofold = std::complex<solve::DoubleDouble>;

/// NaN if one of them is.
double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }

struct TransferRequest {
  const Factored& data;
  Double s;
  const PartOfTransfer& part;
  TransferCost& cost;
};

/// The part of the transfer in T; its end adds to the cost.
template <class T>
class Answer {
 public:
  Answer(const TransferRequest& r, solve::Refinement refinement)
      : request_(r), forward_(r.data, point(), unit_columns(), refinement, r.part.inputs) {
    if (!r.part.outputs.empty()) transposed_.emplace(forward_, r.part.outputs, refinement);
    ++r.cost.factorisations;
  }
  /// The factors of `coarse`, all else in T.
  Answer(const TransferRequest& r, const Answer<Double>& coarse)
      : request_(r), forward_(r.data, point(), unit_columns(), coarse.forward_, r.part.inputs) {
    if (coarse.transposed_) transposed_.emplace(forward_, r.part.outputs, *coarse.transposed_);
  }
  Answer(const Answer&) = delete;
  ~Answer() {
    request_.cost.columns += forward_.columns_solved();
    if (transposed_) request_.cost.rows += transposed_->columns_solved();
  }

  double improve() {
    const double change = forward_.improve();
    return transposed_ ? worse(change, transposed_->improve()) : change;
  }
  typename RefinedSolution<T>::Losses losses() {
    const auto f = forward_.losses();
    if (!transposed_) return f;
    const auto t = transposed_->losses();
    return {worse(f.change, t.change), worse(f.rounding, t.rounding)};
  }
  /// Whether the final unknowns solve the equations.
  bool holds() const { return forward_.holds() && (!transposed_ || transposed_->holds()); }
  double refinement_error() const {
    const double error = forward_.refinement_error();
    return transposed_ ? worse(error, transposed_->refinement_error()) : error;
  }
  double weakest_pivot() const { return forward_.weakest_pivot(); }
  int weakest_variable() const { return forward_.weakest_variable(); }

  TransferPart rounded() const {
    TransferPart part{solve::in_double(forward_.outputs()), {}, {}};
    if (transposed_) part.rows = solve::in_double(transposed_->inputs()).transpose();
    return part;
  }

 private:
  template <class>
  friend class Answer;
  T point() const { return solve::Scalar<T>::from(request_.s); }
  solve::RowMatrix<T> unit_columns() const {
    return unit_inputs<T>(request_.data, request_.part.inputs);
  }

  TransferRequest request_;
  Evaluation<T> forward_;
  std::optional<TransposedEvaluation<T>> transposed_;
};

bool is_finite(const TransferPart& part) {
  return part.columns.allFinite() && part.rows.allFinite();
}

/// ": the weakest pivot, 1e-9 of its terms, is that of hub.child.accel"; empty if no pivot has lost
/// digits.
std::string weakest_words(const Factored& d, double pivot, int variable) {
  const int signal = variable < 0 ? -1 : d.skeleton->as_written().variables[linalg::at(variable)];
  if (signal < 0) return {};
  return fmt::format(": the weakest pivot, {:.1g} of its terms, is that of {}", pivot,
                     name_of(d.graph(), signal));
}

/// The error if `error` of an answer by these factors is too large, or if its unknowns do not solve
/// the equations (1).
template <class T>
Error not_refined(const TransferRequest& r, const Answer<T>& factored, double error) {
  constexpr bool kFinest = std::is_same_v<T, solve::Complex50>;
  const std::string place =
      fmt::format("{} at s = {}{:+}j: ", r.data.graph().name, r.s.real(), r.s.imag());
  if (std::isinf(error))
    return {Code::not_finite, place + "numbers exceed the range of this precision",
            "take Precision::digits50, an s of smaller or larger modulus, or other units"};
  return {Code::singular,
          place + "refinement does not reach 12 digits" +
              weakest_words(r.data, factored.weakest_pivot(), factored.weakest_variable()),
          kFinest ? "take another s: 50 digits are too few beside a pole this near"
                  : "take Precision::as_needed or Precision::digits50, or another s"};
}

/// The law of every precision: an answer is given only if its final unknowns solve the equations.
/// (Overflow is refused by the caller.)
template <class T>
TransferPart judged(const TransferRequest& r, const Answer<T>& answer) {
  TransferPart part = answer.rounded();
  if (is_finite(part) && !answer.holds()) throw not_refined(r, answer, 1);
  return part;
}

TransferPart standard(const TransferRequest& r) {
  Answer<Double> point(r, solve::Refinement::none);
  point.improve();
  return judged(r, point);
}

TransferPart digits50(const TransferRequest& r) {
  return judged(r, Answer<solve::Complex50>(r, solve::Refinement::settled));
}

template <class T>
TransferPart refined(const TransferRequest& r) {
  const Answer<Double> coarse(r, solve::Refinement::none);
  const Answer<T> result(r, coarse);
  if (const double error = result.refinement_error(); !(error <= kEnough))
    throw not_refined(r, coarse, error);
  return result.rounded();
}

/// Relative error in T after one step of refinement, whose change was `losses`: the largest of
/// those by the weakest pivot, by rounding of the results, and by the remainder after that step,
/// which takes another step to compute; 1 if the final unknowns do not solve the equations.
template <class T>
double lost_by(Answer<T>& e, const typename RefinedSolution<T>::Losses& losses) {
  const double left = losses.change <= kEnough ? 0 : e.improve();
  if (std::isnan(left) || std::isnan(losses.rounding)) return HUGE_VAL;
  const double lost = std::max(
      {solve::Scalar<T>::epsilon() / e.weakest_pivot(), kRoundings * losses.rounding, left});
  return lost <= kEnough && !e.holds() ? 1 : lost;
}

/// Finer than double, whose error is `lost`: refined if its own rounding (2000 times finer) is
/// small enough and it converges, else refined in double-double if that converges, else 50 digits.
TransferPart finer(const TransferRequest& r, const Answer<Double>& plain, double lost) {
  const double kFiner = solve::Scalar<Extended>::epsilon() / solve::Scalar<Double>::epsilon();
  if (lost * kFiner <= kEnough) {
    const Answer<Extended> once(r, plain);
    if (once.refinement_error() <= kEnough) return once.rounded();
  }
  const Answer<Twofold> twice(r, plain);
  if (twice.refinement_error() <= kEnough) return twice.rounded();
  return digits50(r);
}

/// In T, if double has no pivot; none if T has too few digits for it, or if the last place
/// of the data decides all digits of the results, as at a pole.
template <class T>
std::optional<TransferPart> without_pivot(const TransferRequest& r) {
  try {
    Answer<T> point(r, solve::Refinement::settled);
    const auto losses = point.losses();
    const double in_double =
        losses.rounding / solve::Scalar<T>::epsilon() * solve::Scalar<Double>::epsilon();
    if (lost_by(point, losses) <= kEnough && in_double <= linalg::kOneDigit) return point.rounded();
  } catch (const Error&) {  // a pole of a block, or no pivot here either
  }
  return {};
}

/// The coarsest precision whose rounding changes the results by no more than kEnough. Intermediate
/// results of grids lose more digits than the outputs: the last pivots of a wide front may have
/// none in double, far from any pole.
TransferPart as_needed(const TransferRequest& r) {
  std::optional<Answer<Double>> plain;
  try {
    plain.emplace(r, solve::Refinement::settled);
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    auto part = without_pivot<Twofold>(r);
    if (!part) part = without_pivot<solve::Complex50>(r);
    if (!part) throw;
    return *part;
  }
  const double lost = lost_by(*plain, plain->losses());
  if (lost <= kEnough) return plain->rounded();
  return finer(r, *plain, lost);
}

TransferPart with(const TransferRequest& r, Precision precision) {
  switch (precision) {
    case Precision::standard: return standard(r);
    case Precision::refined: return refined<Extended>(r);
    case Precision::twofold: return refined<Twofold>(r);
    case Precision::digits50: return digits50(r);
    case Precision::as_needed: return as_needed(r);
  }
  return {};
}

}  // namespace

TransferPart transfer_part(const SystemData& data, Double s, const PartOfTransfer& part,
                           Precision precision) {
  TransferCost cost;
  TransferPart result = with({data, s, part, cost}, precision);
  result.cost = cost;
  if (!is_finite(result))
    refuse_overflow(
        fmt::format("the transfer of {} at s = {}{:+}j", data.graph().name, s.real(), s.imag()));
  return result;
}

Eigen::MatrixXcd transfer_of(const SystemData& data, Double s, Precision precision) {
  return transfer_part(data, s, {all_inputs(data), {}}, precision).columns;
}

std::optional<Eigen::MatrixXcd> transfer_if_any(const SystemData& data, Double s) {
  try {
    return transfer_of(data, s);
  } catch (const Error& error) {
    if (!error.has(Code::singular) && !error.has(Code::not_finite)) throw;
    return {};
  }
}

Eigen::MatrixXcd in_long_double(const SystemData& data, Double s) {
  TransferCost cost;
  const PartOfTransfer all{all_inputs(data), {}};
  return Answer<Extended>({data, s, all, cost}, solve::Refinement::none).rounded().columns;
}

}  // namespace titop::detail
