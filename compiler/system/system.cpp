#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/compiler/certificate/without_rounding.hpp>
#include <titop/compiler/realization/write_model.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

int System::order() const { return data_->states.order(); }
const std::vector<std::string>& System::states() const& { return data_->state_names(); }
const std::vector<std::string>& System::inputs() const& { return data_->layout().inputs; }
const std::vector<std::string>& System::outputs() const& { return data_->layout().outputs; }
const Stage& System::stage() const& { return data_->skeleton->stage; }
const std::vector<Note>& System::notes() const& { return data_->noted(); }

System::Rates System::apply(const VectorXd& x, const VectorXd& u) const {
  if (x.size() != order() || u.size() != static_cast<Eigen::Index>(inputs().size()))
    throw Error(Code::size, fmt::format("apply: x has {} entries, u has {}", x.size(), u.size()),
                fmt::format("x needs {}, u needs {}", order(), inputs().size()));
  const VectorXd all = data_->states.expanded(x, u);
  solve::RowMatrix<double> known(all.size() + u.size(), 1);
  known << all, u;
  const detail::RateColumns r = detail::rates(*data_, known);
  return {data_->states.kept_rows(VectorXd(r.xdot)), r.y};
}

namespace {

using Double = std::complex<double>;
using Extended = std::complex<long double>;
using Twofold = std::complex<solve::DoubleDouble>;

template <class T>
MatrixXcd rounded(const solve::RowMatrix<T>& m) {
  return m.unaryExpr([](const T& x) -> Double { return solve::Scalar<T>::round(x); });
}

using detail::kEnough;
using detail::kOneDigit;
using detail::unit_inputs;

template <class T>
MatrixXcd transfer_in(const detail::SystemData& d, Double s, solve::Refinement refinement) {
  return rounded<T>(
      detail::Evaluation<T>(d, solve::Scalar<T>::from(s), unit_inputs<T>(d), refinement).outputs());
}

MatrixXcd standard_transfer(const detail::SystemData& d, Double s) {
  detail::Evaluation<Double> point(d, s, unit_inputs<Double>(d));
  point.improve();
  return rounded<Double>(point.outputs());
}

/// The factors of `coarse`, all else in T.
template <class T>
detail::Evaluation<T> refined(const detail::SystemData& d, Double s,
                              const detail::Evaluation<Double>& coarse) {
  return {d, solve::Scalar<T>::from(s), unit_inputs<T>(d), coarse};
}

template <class T>
MatrixXcd refined_transfer(const detail::SystemData& d, Double s) {
  const detail::Evaluation<Double> coarse(d, s, unit_inputs<Double>(d));
  const auto result = refined<T>(d, s, coarse);
  if (const double error = result.refinement_error(); !(error <= kEnough))
    throw detail::not_refined(d, s, error);
  return rounded<T>(result.outputs());
}

/// Relative error in T after one step of refinement, whose change was `losses`: the largest of
/// those by the weakest pivot, by rounding of the outputs, and by the remainder after that step,
/// which takes another step to compute.
template <class T>
double lost_by(detail::Evaluation<T>& e, const typename detail::Evaluation<T>::Losses& losses) {
  const double left = losses.change <= kEnough ? 0 : e.improve();
  if (std::isnan(left) || std::isnan(losses.rounding)) return HUGE_VAL;
  return std::max({solve::Scalar<T>::epsilon() / e.weakest_pivot(),
                   detail::kRoundings * losses.rounding, left});
}

/// Finer than double, whose error is `lost`: refined if its own rounding (2000 times finer) is
/// small enough and it converges, else refined in double-double if that converges, else 50 digits.
MatrixXcd finer_transfer(const detail::SystemData& d, Double s,
                         const detail::Evaluation<Double>& plain, double lost) {
  const double kFiner = solve::Scalar<Extended>::epsilon() / solve::Scalar<Double>::epsilon();
  if (lost * kFiner <= kEnough) {
    const auto once = refined<Extended>(d, s, plain);
    if (once.refinement_error() <= kEnough) return rounded<Extended>(once.outputs());
  }
  const auto twice = refined<Twofold>(d, s, plain);
  if (twice.refinement_error() <= kEnough) return rounded<Twofold>(twice.outputs());
  return transfer_in<solve::Complex50>(d, s, solve::Refinement::settled);
}

/// In T, if double has no pivot; none if T has too few digits for it, or if the last place
/// of the data decides all digits of the outputs, as at a pole.
template <class T>
std::optional<MatrixXcd> transfer_without_pivot(const detail::SystemData& d, Double s) {
  try {
    detail::Evaluation<T> point(d, solve::Scalar<T>::from(s), unit_inputs<T>(d),
                                solve::Refinement::settled);
    const auto losses = point.losses();
    const double in_double =
        losses.rounding / solve::Scalar<T>::epsilon() * solve::Scalar<Double>::epsilon();
    if (lost_by(point, losses) <= kEnough && in_double <= kOneDigit)
      return rounded<T>(point.outputs());
  } catch (const Error&) {  // a pole of a block, or no pivot here either
  }
  return {};
}

/// The coarsest precision whose rounding changes the outputs by no more than kEnough. Intermediate
/// results of grids lose more digits than the outputs: the last pivots of a wide front may have
/// none in double, far from any pole.
MatrixXcd transfer_as_needed(const detail::SystemData& d, Double s) {
  std::optional<detail::Evaluation<Double>> plain;
  try {
    plain.emplace(d, s, unit_inputs<Double>(d), solve::Refinement::settled);
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;
    auto G = transfer_without_pivot<Twofold>(d, s);
    if (!G) G = transfer_without_pivot<solve::Complex50>(d, s);
    if (!G) throw;
    return *G;
  }
  const double lost = lost_by(*plain, plain->losses());
  if (lost <= kEnough) return rounded<Double>(plain->outputs());
  return finer_transfer(d, s, *plain, lost);
}

}  // namespace

namespace {

MatrixXcd transfer_with(const detail::SystemData& d, Double s, Precision precision) {
  switch (precision) {
    case Precision::standard: return standard_transfer(d, s);
    case Precision::refined: return refined_transfer<Extended>(d, s);
    case Precision::twofold: return refined_transfer<Twofold>(d, s);
    case Precision::extended: return transfer_in<Extended>(d, s, solve::Refinement::none);
    case Precision::digits50:
      return transfer_in<solve::Complex50>(d, s, solve::Refinement::settled);
    case Precision::as_needed: return transfer_as_needed(d, s);
  }
  return {};
}

}  // namespace

MatrixXcd System::transfer(std::complex<double> s, Precision precision) const {
  MatrixXcd G = transfer_with(*data_, s, precision);
  if (!G.allFinite())
    detail::refuse_overflow(
        fmt::format("the transfer of {} at s = {}{:+}j", data_->graph().name, s.real(), s.imag()));
  return G;
}

std::optional<MatrixXcd> detail::transfer_if_any(const System& system, Double s) {
  try {
    return system.transfer(s);
  } catch (const Error& error) {
    if (!error.has(Code::singular) && !error.has(Code::not_finite)) throw;
    return {};
  }
}

std::vector<MatrixXcd> System::frequency_response(std::span<const double> omega, int threads,
                                                  Precision precision) const {
  std::vector<MatrixXcd> result(omega.size());
  detail::parallel(omega.size(), threads, [&] {
    return [&](std::size_t i) { result[i] = transfer({0, omega[i]}, precision); };
  });
  return result;
}

MatrixXd System::static_gain() const {
  try {
    return transfer(0).real();
  } catch (const Error& error) {
    // A block may have a pole at 0 that the system has not: a hinge with a spring.
    if (!error.has(Code::singular)) throw;
    return state_space().transfer(0).real();
  }
}

const detail::DenseModel& System::dense() const {
  std::call_once(data_->dense_once, [&] { data_->dense = detail::dense_model(*this, *data_); });
  return data_->dense;
}

const StateSpace& System::state_space() const& { return dense().model; }

const OrderVerdict& System::order_verdict() const& { return dense().order; }

const std::vector<std::pair<std::string, double>>& System::dense_seconds() const& {
  return dense().seconds;
}

void System::write(StateSpace& model, int threads) const {
  detail::write_dense(*data_, model, threads);
}

void System::write(Descriptor& form) const { detail::write_descriptor(*data_, form); }

Descriptor System::descriptor() const {
  Descriptor form;
  write(form);
  return form;
}

std::vector<Pole> System::poles() const {
  const StateSpace& model = state_space();
  const bool whole = model.order() > 0 && !order_verdict().judged;
  return titop::poles(model, whole ? detail::rounding_of(*data_, model).A : MatrixXd());
}

namespace {

Certificate with_dense(Certificate c, double against_factors, const detail::DenseError& error) {
  c.dense_against_factors = against_factors;
  c.dense_error = error.beside_largest.error;
  c.dense_error_s = error.beside_largest.s;
  c.dense_error_where_small = error.where_small.error;
  c.dense_error_where_small_s = error.where_small.s;
  return c;
}

}  // namespace

Certificate System::certificate() const { return data_->checked().certificate; }

Certificate System::dense_certificate() const {
  return with_dense(certificate(), dense().against_factors, dense().error);
}

Certificate System::certificate(const StateSpace& written) const {
  detail::require_written(*data_, written);
  return with_dense(certificate(), detail::dense_difference(*data_, written),
                    detail::dense_error(*data_, written));
}

namespace {

std::string lines_of(const std::vector<Note>& notes) {
  std::string text;
  for (const Note& n : notes)
    text += fmt::format("  {:<9} {:<10} {}\n", n.pass, to_string(n.kind), n.text);
  return text;
}

}  // namespace

std::string System::log() const {
  const auto count = [](std::size_t n, const char* subject) {
    return fmt::format("{} {}{}", n, subject, n == 1 ? "" : "s");
  };
  return fmt::format("{}: {}, {}, {}\n", data_->graph().name, count(states().size(), "state"),
                     count(inputs().size(), "input"), count(outputs().size(), "output")) +
         lines_of(notes());
}

const std::vector<Note>& System::dense_notes() const& { return dense().notes; }

std::string System::dense_log() const { return lines_of(dense_notes()); }

const std::vector<std::pair<std::string, double>>& System::seconds() const& {
  return data_->seconds;
}

const detail::Check& detail::SystemData::checked() const {
  std::call_once(check_once, [&] { check = certify(*this); });
  return check;
}

const std::vector<Note>& detail::SystemData::noted() const {
  std::call_once(notes_once, [&] {
    all_notes = notes;
    all_notes.insert(all_notes.end(), checked().notes.begin(), checked().notes.end());
  });
  return all_notes;
}

}  // namespace titop
