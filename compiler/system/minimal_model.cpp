#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/without_rounding.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/minreal/effect.hpp>
#include <titop/compiler/minreal/order_of_stage.hpp>
#include <titop/compiler/minreal/to_order.hpp>
#include <titop/compiler/realization/energy.hpp>
#include <titop/compiler/solve/frequency.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/compiler/system/steps.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/name_order.hpp>

/// The dense model of a system, minimized; the removal is checked on the transfer.
namespace titop::detail {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

/// The reason by the certificate of the factors why the order may be in doubt; null: none.
const char* digits_lost(const SystemData& d) {
  if (d.checked().digits_lost) return "digits are lost (see certify)";
  return d.checked().rounding_alone ? "some output is rounding alone" : nullptr;
}

/// The model with only those inputs and outputs whose dynamics are not rounding: in some entry, the
/// change with s agrees with finer arithmetic to six digits.
StateSpace with_certain_ports(const SystemData& d, const StateSpace& m) {
  const std::complex<double> s = pick_s(d);
  const auto transfers = [&](std::complex<double> z) {
    return std::pair(transfer_of(d, z), detail::refined_transfers(m, {z}).front());
  };
  const auto [exact, dense] = transfers(s);
  Eigen::MatrixX<bool> certain = Eigen::MatrixX<bool>::Zero(exact.rows(), exact.cols());
  for (const double factor : {0.1, 10.0}) {
    const auto [other_exact, other_dense] = transfers(factor * s);
    const MatrixXd size = exact.cwiseAbs().cwiseMax(other_exact.cwiseAbs());
    const MatrixXd change = (other_exact - exact).cwiseAbs();
    const MatrixXd off = (other_dense - dense - (other_exact - exact)).cwiseAbs();
    certain = certain.array() ||
              (change.array() > kWarn * size.array() && off.array() <= kSixDigits * change.array());
  }
  StateSpace part{m.A, {}, {}, {}, m.states, {}, {}, m.rates};
  std::vector<int> in, out;
  for (int l = 0; l < certain.cols(); ++l)
    if (certain.col(l).any()) in.push_back(l), part.inputs.push_back(m.inputs[at(l)]);
  for (int i = 0; i < certain.rows(); ++i)
    if (certain.row(i).any()) out.push_back(i), part.outputs.push_back(m.outputs[at(i)]);
  part.B = m.B(Eigen::all, in);
  part.C = m.C(out, Eigen::all);
  part.D = m.D(out, in);
  return part;
}

/// True if some output is 0 in finer arithmetic, and rounding in the dense model: the self-check
/// compares outputs with their surroundings and may not see it.
bool has_output_of_rounding(const SystemData& d, const StateSpace& m) try {
  const std::complex<double> s = pick_s(d);
  const MatrixXd exact = transfer_of(d, s).cwiseAbs(),
                 dense = refined_transfers(m, {s}).front().cwiseAbs();
  return (exact.rowwise().maxCoeff().array() < kSixDigits * dense.rowwise().maxCoeff().array())
      .any();
} catch (const Error& error) {
  if (!error.has(Code::singular)) throw;
  return true;
}

/// Every port is judged by its own size, so one at rounding level would count as moved and seen. If
/// digits are lost, only states that the other ports need are certain: part of the inputs and
/// outputs needs no more states than all of them.
void doubt_lost_digits(const SystemData& d, const StateSpace& dense, MinimizeOptions options,
                       OrderVerdict& v, std::vector<Note>& notes) {
  if (v.exact || v.lowest == 0 || dense.inputs.empty() || dense.outputs.empty()) return;
  const char* lost = digits_lost(d);
  if (!lost && has_output_of_rounding(d, dense)) lost = "some output is rounding alone";
  if (!lost) return;
  options.resolution = std::max(options.resolution, kSixDigits);
  int certain = 0;
  try {
    const StateSpace part = with_certain_ports(d, dense);
    if (!part.inputs.empty()) certain = minimize(part, options).order.lowest;
  } catch (const Error& error) {
    if (!error.has(Code::singular)) throw;  // no transfer: nothing is certain
  }
  if (certain >= v.lowest) return;
  v.lowest = certain;
  notes.push_back(
      {Note::Kind::warning, "minimize",
       fmt::format("{}: of {} states, only {} are certainly needed", lost, v.order, certain)});
}

/// Error of the transfer without the removed modes, relative to the transfer at the same s.
/// Relative to its maximum over all s, the rigid motion of a free structure at low frequency would
/// hide errors near its modes.
struct Change {
  double by_modes = 0;  ///< relative to the terms of both models: no rounding is as large
  double in_all = 0;    ///< relative to itself, or for a 0 to the terms of the model as written
  std::vector<std::complex<double>> tried, left_out;  ///< where the factors have digits, and not
};

/// Near the removed modes and at the assembly's frequencies without rounding: entries that may be
/// rounding alone have frequencies of 1e-16 rad/s, where only they count. (The pole of a slow block
/// may be at a frequency where rigid bodies have no digits.) And a decade beyond these, where a
/// model that was written relative to fewer states may cancel more.
std::vector<std::complex<double>> points_of_change(const SystemData& d, const StateSpace& judged,
                                                   const Minimized& m) {
  std::vector<std::complex<double>> points = minreal::near_modes(m.order.removed, pick_s(d));
  std::vector<double> omegas = frequencies_of(states_by_name(judged).A);
  if (!omegas.empty()) {
    const auto [least, most] = std::minmax_element(omegas.begin(), omegas.end());
    const double below = *least / 10, above = *most * 10;
    omegas.insert(omegas.end(), {below, above});
  }
  for (const double omega : omegas) points.push_back(off_axis(omega));
  return points;
}

/// `judged`: the dense model without rounding.
Change change(const SystemData& d, const StateSpace& dense, const StateSpace& judged,
              const Minimized& m) {
  Change worst;
  for (const std::complex<double> s : points_of_change(d, judged, m)) {
    const std::optional<MatrixXcd> G = transfer_if_any(d, s);
    (G ? worst.tried : worst.left_out).push_back(s);
    if (!G) continue;
    const std::vector<std::complex<double>> here{s};
    const std::vector<MatrixXcd> exact{*G}, minimal = refined_transfers(m.model, here);
    const MatrixXd as_written = terms(dense, here);
    const auto off = [&](const std::vector<MatrixXcd>& of, const MatrixXd& terms_there) {
      Measure by = measure(*d.skeleton->stage.source, terms_there);
      return difference(of, exact, by, d, here).relative;
    };
    worst.by_modes =
        std::max(worst.by_modes, off(minimal, as_written.cwiseMax(terms(m.model, here))));
    const auto digits = [&](const std::vector<MatrixXcd>& of) {
      Measure by = measure(*d.skeleton->stage.source, {});
      add_rounding(by, exact, of_nothing(as_written, exact));
      return difference(of, exact, by, d, here).relative;
    };
    const double lost = digits(minimal);
    if (lost > worst.in_all && lost > kAnotherDigit * digits(refined_transfers(dense, here)))
      worst.in_all = lost;
  }
  return worst;
}

/// Limits of counting in exact arithmetic: half a millisecond if the order is decided, ten if it
/// is not.
constexpr ExactOptions kIfDecided{.states = 60, .unknowns = 100},
    kIfUndecided{.states = 100, .unknowns = 1000};

const ExactOptions& exact_limits(const OrderVerdict& v) {
  return v.decided() ? kIfDecided : kIfUndecided;
}

/// Removes states that exact arithmetic shows to be redundant, if it counts fewer than are kept and
/// the transfer keeps its digits without them: the change measured. None: nothing is removed. More
/// states than are kept may be due to rounding of the diagram's numbers.
std::optional<Change> lower_to(const ExactOrder& exact, const SystemData& d,
                               const StateSpace& dense, const StateSpace& judged, Minimized& m) {
  OrderVerdict& v = m.order;
  if (!exact.decided) return {};
  v.lowest = std::min(v.lowest, exact.order);
  if (exact.order >= v.order) {
    if (!v.exact) v.highest = std::min(v.highest, exact.order);
    return {};
  }
  std::optional<minreal::ModelOfOrder> found = minreal::to_order(judged, exact.order);
  if (!found) return {};
  Minimized fewer{std::move(found->model), v, std::move(found->notes)};
  fewer.order.order = fewer.order.highest = exact.order;
  fewer.order.undecided.clear();
  fewer.order.removed.push_back({0, v.order - exact.order, found->tolerance, found->tolerance,
                                 "exact arithmetic counts it out"});
  const double allowed = std::max(kUnchanged, 10 * d.skeleton->options.resolution);
  Change by = change(d, dense, judged, fewer);
  if (by.tried.empty() || std::max(by.by_modes, by.in_all) > allowed) return {};
  fewer.order.change = by.by_modes;
  fewer.notes.insert(fewer.notes.begin(), to_string(fewer.order));
  m = std::move(fewer);
  return by;
}

/// Without a transfer no change is measured: modes within rounding stay undecided.
void doubt_unmeasured(OrderVerdict& v) {
  for (const JudgedMode& mode : v.removed)
    if (mode.bound > 0 && !v.exact) v.highest += mode.states;
}

/// Notes the points at which the change was not measured; without any measurement no mode is
/// removed.
void say_left_out(const Change& by, std::vector<Note>& notes) {
  if (by.left_out.empty()) return;
  const auto smaller = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
  notes.push_back(
      {Note::Kind::unchecked, "minimize",
       fmt::format("the change of the transfer is measured at {} of {} points: at the others, the "
                   "lowest |s| = {:.3g}, the factors have no digit",
                   by.tried.size(), by.tried.size() + by.left_out.size(),
                   std::abs(*std::min_element(by.left_out.begin(), by.left_out.end(), smaller)))});
}

/// The minimal model, if its transfer keeps the digits of the written one. `m`: without a model.
void minimize_checked(const SystemData& d, const Realization& written, Minimal& m) {
  const StateSpace& dense = *written.model;
  const Options& given = d.skeleton->options;
  // Small diagrams are counted before any mode is judged, others afterwards.
  const bool asked = dense.order() <= given.exact_up_to;
  ExactOrder exact;
  const auto count = [&](const ExactOptions& limits) {
    exact = minreal::order_of_stage(d.skeleton->stage, dense.order(), limits, d.numbers.parameters);
  };
  if (asked) {
    // Blocks' states that follow from others count there, and so do integrators of positions.
    count({.states = std::max(60, 4 * given.exact_up_to)});
    m.notes.push_back({Note::Kind::info, "minimize", to_string(exact)});
  }
  const auto [judged, rounding] = without_rounding(d, dense);
  const MinimizeOptions options{.resolution = given.resolution,
                                .exact_order = exact.decided ? exact.order : -1,
                                .energy = d.states.trivial() ? MatrixXd() : potential_energy(d),
                                .rounding = rounding};
  Minimized minimal = minreal::minimize_unmeasured(judged, options);
  doubt_lost_digits(d, judged, options, minimal.order, m.notes);
  // If entries have fewer digits, a mode's part may be rounding.
  if (written.error.beside_largest.error > linalg::kThreeDigits && !minimal.order.exact)
    minimal.order.highest = dense.order();
  if (!asked) count(exact_limits(minimal.order));
  std::optional<Change> by = lower_to(exact, d, dense, judged, minimal);
  const bool ports = !dense.inputs.empty() && !dense.outputs.empty();
  if (!ports) doubt_unmeasured(minimal.order);
  const bool removed = !minimal.order.removed.empty();
  if (!by && removed && ports) by = change(d, dense, judged, minimal);
  if (by) {
    minimal.order.change = by->by_modes;
    say_left_out(*by, m.notes);
  }
  if (!minimal.notes.empty()) minimal.notes.front() = to_string(minimal.order);
  const bool untried = by && by->tried.empty();
  const double lost = untried ? 1 : by ? by->in_all : 0;  // not measured: put all back
  if (minreal::put_back(dense, given.resolution, lost, minimal)) {
    if (untried)
      minimal.notes.back() =
          "nothing was removed: near the removed modes the factors have no digit";
    if (!asked && !exact.decided) count(exact_limits(minimal.order));
    if (!lower_to(exact, d, dense, judged, minimal)) {
      m.notes.push_back({Note::Kind::warning, "minimize",
                         fmt::format("{}: {}", minimal.notes.back(), minimal.notes.front())});
      m.order = std::move(minimal.order);
      return;
    }
  }
  for (std::string& text : minimal.notes)
    m.notes.push_back(
        {removed ? Note::Kind::removed : Note::Kind::info, "minimize", std::move(text)});
  m.order = std::move(minimal.order);
  if (removed) m.model = std::make_shared<const StateSpace>(std::move(minimal.model));
}

}  // namespace

}  // namespace titop::detail

titop::detail::Minimal titop::steps::minimize(const detail::SystemData& data,
                                              const detail::Realization& written) {
  const Options& options = data.skeleton->options;
  const int states = written.model->order();
  detail::Minimal m{.model = written.model};
  m.order.order = m.order.highest = states;
  m.order.judged = states == 0;
  const int up_to =
      options.minimize_up_to > 0 ? std::max(options.minimize_up_to, options.exact_up_to) : 0;
  if (states > up_to)
    m.notes.push_back({Note::Kind::info, "minimize",
                       fmt::format("not run: {} states are more than {} (Options::minimize_up_to)",
                                   states, up_to)});
  else if (states > 0)
    detail::minimize_checked(data, written, m);
  return m;
}
