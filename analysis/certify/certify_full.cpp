#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/certify/certify_full.hpp>
#include <titop/analysis/certify/faults.hpp>
#include <titop/analysis/certify/passivity.hpp>
#include <titop/analysis/certify/poles.hpp>
#include <titop/analysis/certify/reciprocity.hpp>
#include <titop/analysis/certify/reversed_momenta.hpp>
#include <titop/analysis/certify/structure.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/without_rounding.hpp>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/definition/transfer.hpp>
#include <titop/compiler/minreal/order_of_stage.hpp>
#include <titop/compiler/system/elimination_terms.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/compiler/system/transfer_part.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/declared.hpp>
#include <utility>

namespace titop {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// s = (0.05 + j) w, w from a tenth of the lowest to ten times the highest, evenly in log w.
std::vector<Complex> grid_of(const FullCertificate::Grid& grid) {
  std::vector<Complex> list;
  const double ratio = grid.highest / grid.lowest;
  for (int k = 0; k < grid.points; ++k) {
    const double part = grid.points > 1 ? static_cast<double>(k) / (grid.points - 1) : 0.5;
    const double w = grid.lowest * std::pow(ratio, part);
    list.emplace_back(0.05 * w, w);
  }
  return list;
}

void set_range(const std::vector<double>& omegas, FullCertificate::Grid& grid) {
  grid.lowest = omegas.empty() ? 0.1 : 0.1 * omegas.front();
  grid.highest = omegas.empty() ? 10 : 10 * omegas.back();
}

/// Rows (or columns) of each output (or input), from the graph's order to the declared one.
template <class List>
std::vector<int> declared(const List& list) {
  const std::vector<int> first = detail::first_as_declared(list);
  std::vector<int> result;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (int k = 0; k < list[i].size; ++k) result.push_back(first[i] + k);
  return result;
}

std::vector<double> values_of(const System& system) {
  std::vector<double> values;
  for (const auto& [name, value] : system.parameters()) values.push_back(value);
  return values;
}

/// Outputs x inputs as declared.
template <class Matrix>
Matrix as_declared(const Graph& g, const Matrix& m) {
  Matrix result(m.rows(), m.cols());
  result(declared(g.outputs), declared(g.inputs)) = m;
  return result;
}

/// Points of the grid and the factors' transfers there; points without one are omitted, with a
/// note.
std::vector<MatrixXcd> factored_at(const System& system, std::vector<Complex>& points,
                                   FullCertificate::Grid& grid) {
  std::vector<MatrixXcd> list;
  std::vector<Complex> kept, left_out;
  for (const Complex s : points) {
    std::optional<MatrixXcd> G = detail::transfer_if_any(detail::data_of(system), s);
    (G ? kept : left_out).push_back(s);
    if (G) list.push_back(std::move(*G));
  }
  points = std::move(kept);
  grid.points = static_cast<int>(points.size());
  if (!left_out.empty())  // from the lowest s upwards
    grid.why_not += fmt::format(
        "{}the factors have no digit, or numbers overflow, at {} of {} "
        "points, the lowest |s| = {:.3g}",
        grid.why_not.empty() ? "" : "; ", left_out.size(), list.size() + left_out.size(),
        std::abs(left_out.front()));
  return list;
}

/// The graph's own equations, solved all at once without any pass.
std::vector<MatrixXcd> as_written(const Graph& g, const std::vector<double>& values,
                                  const std::vector<Complex>& points) {
  std::vector<MatrixXcd> list;
  for (const Complex s : points) list.push_back(as_declared(g, transfer(g, s, values)));
  return list;
}

/// The dense model also at the frequencies of its poles, up to as many as the grid has points: a
/// pole with little effect shows nowhere else.
void add_poles(const System& system, const std::vector<double>& omegas,
               std::vector<Complex>& points, std::vector<MatrixXcd>& factored) {
  const std::size_t most = points.size(), step = most > 0 ? (omegas.size() + most - 1) / most : 1;
  for (std::size_t k = 0; most > 0 && k < omegas.size(); k += step) {
    const Complex s(0.05 * omegas[k], omegas[k]);
    if (std::optional<MatrixXcd> G = detail::transfer_if_any(detail::data_of(system), s)) {
      points.push_back(s);
      factored.push_back(std::move(*G));
    }
  }
}

/// Each block over its own size, for the error of writing the model. Only blocks that may be
/// rounding alone, such as zeros by symmetry, are measured by the terms that cancel in them: the
/// measure's, and, if something differs, those of the elimination and of rounding in the model as
/// written (`before` `minimize`).
void check_dense(const System& system, const detail::Rounded& before,
                 const std::vector<Complex>& points, const std::vector<MatrixXcd>& factored,
                 detail::Measure measure, FullCertificate::Grid& grid) {
  const std::vector<MatrixXcd> dense = detail::transfers(system.state_space(), points);
  const MatrixXd terms = std::exchange(measure.terms, {});
  detail::add_rounding(measure, factored, detail::of_nothing(terms, factored));
  detail::Difference found =
      detail::difference(dense, factored, measure, detail::data_of(system), points);
  if (found.relative > detail::kWarn) {
    detail::add_rounding(
        measure, factored,
        detail::terms_of_rounding(before.model, before.rounding, detail::some_of(points)));
    found = detail::difference(dense, factored, measure);
  }
  grid.done = true;
  grid.dense = found.relative;
  grid.dense_s = points[found.point];
}

/// Solved all at once in double, the equations lose digits of their own, which is no error of the
/// model: all blocks are measured by the measure's terms if these are larger.
void check_written(const System& system, const Full& subject, const std::vector<Complex>& points,
                   const std::vector<MatrixXcd>& factored, detail::Measure measure,
                   FullCertificate::Grid& grid) {
  const Graph& g = *system.stage().source;
  int signals = 0;
  for (const Signal& s : g.signals) signals += s.size;
  if (signals > subject.written_up_to) return;
  try {
    const std::vector<double> values = values_of(system);
    const std::vector<MatrixXcd> written = as_written(g, values, points);
    detail::Difference found =
        detail::difference(written, factored, measure, detail::data_of(system), points);
    // At some points one order of sums may hit a 0 and the other not: all of them, if need be.
    for (const auto& at : {detail::some_of(points), points}) {
      if (!(found.relative > detail::kWarn)) break;
      detail::add_rounding(measure, factored, as_declared(g, detail::terms(g, at, values)));
      found = detail::difference(written, factored, measure);
    }
    grid.written = found.relative;
    grid.written_s = points[found.point];
  } catch (const Error&) {
    // Not solvable as written, if chains are closed twice: the factors' own residual remains.
  }
}

/// Passivity and reciprocity of forces and the accelerations at their points, over the grid and
/// around unstable poles. A failed check is repeated with rounding.
void check_pairs(const System& system, const Options& options, std::vector<Complex> points,
                 std::vector<MatrixXcd> factored,
                 const std::vector<certification::FoundPoles::Right>& growing, FullCertificate& c) {
  const Graph& g = *system.stage().source;
  const std::vector<double> values = values_of(system);
  const passes::DualPairs pairs = passes::dual_pairs(g, values);
  if (pairs.count > 0)
    for (const Complex s : certification::around(growing))
      if (std::optional<MatrixXcd> G = detail::transfer_if_any(detail::data_of(system), s)) {
        points.push_back(s);
        factored.push_back(std::move(*G));
      }
  const std::string no_structure = certification::why_no_structure(g, values);
  std::string not_reciprocal = no_structure;
  certification::DualTransfers transfers = certification::dual_transfers(pairs, points, factored);
  if (no_structure.empty() && pairs.in.size() > 1) try {
      transfers.reversed = certification::with_reversed_momenta(g, values, options, pairs, points);
    } catch (const Error& error) {
      not_reciprocal = "with all momenta reversed: " + error.mistakes().front().message;
    }
  const auto check = [&] {
    c.passivity = certification::check_passivity(pairs, transfers, no_structure.empty());
    c.reciprocity =
        certification::check_reciprocity(system, pairs, transfers, not_reciprocal, values);
  };
  check();
  if (c.passivity.least >= -certification::kPassive && c.reciprocity.asymmetry <= detail::kWarn)
    return;
  transfers = certification::with_rounding(system, pairs, std::move(transfers));
  check();
}

/// States that the dense model has not even before `minimize`; empty if there are none.
std::string what_is_set_aside(const Graph& g) {
  int states = 0;
  for (const Signal& s : g.signals)
    if (s.role == Signal::Role::state && !s.active) states += s.size;
  return states == 0 ? ""
                     : fmt::format(
                           "{} state{} that no input moves or no output sees, as the "
                           "structure shows (the log names the blocks)",
                           states, states == 1 ? "" : "s");
}

/// States removed as rounding may be present in the last bits of the data. That is no
/// fault of the model, but no order that double precision has decided either.
void reach_up_to(const ExactOrder& exact, OrderVerdict& v) {
  int before = v.order;
  for (const JudgedMode& m : v.removed) before += m.states;
  if (exact.decided && v.judged && exact.order <= before)
    v.highest = std::max(v.highest, exact.order);
}

/// Adds a fault to the list if a value is more than allowed, or no number.
void judge(std::vector<std::string>& faults, double value, double allowed, const std::string& text,
           const std::string& more = "") {
  if (!(value <= allowed)) faults.push_back(fmt::format("{} {:.1e}{}", text, value, more));
}

/// The model is 0 to the last bit, and so is the transfer by exact arithmetic: that of the factors,
/// rounding alone, has no digit to compare.
bool is_zero(const System& system, const FullCertificate& c) {
  const StateSpace& model = system.state_space();
  return c.exact.decided && c.exact.order == 0 && model.order() == 0 && model.D.isZero(0);
}

void list_faults(const System& system, FullCertificate& c) {
  const Graph& source = *system.stage().source;
  const bool zero = c.order.judged && is_zero(system, c);
  Certificate basic = c.basic;
  if (zero) basic.dense_error = -1;
  c.faults = certification::basic_faults(basic, zero ? -1 : c.grid.dense);
  const auto fault = [&c](double value, double allowed, const std::string& text) {
    judge(c.faults, value, allowed, text);
  };
  fault(zero ? -1 : c.grid.written, certification::kHolds,
        "the transfer differs from that of the equations as written by");
  fault(c.poles.error, certification::kPoleHolds,
        "poles of the dense model differ from the factors' by");
  if (c.passivity.structure) {
    fault(-c.passivity.least, certification::kPassive, "a structure is not passive, by");
    if (c.poles.right > 0 && certification::has_poles_of_bodies_only(source))
      c.faults.push_back(
          fmt::format("{} poles of a structure lie right of the axis, Re(s) / |s| up to {:.1e}",
                      c.poles.right, c.poles.rightmost.real() / std::abs(c.poles.rightmost)));
  }
  if (const auto& r = c.reciprocity; r.structure)
    fault(r.asymmetry, certification::kHolds,
          fmt::format("forces {} and {} on a structure are not reciprocal, by", r.first, r.second));
  if (c.exact.decided && c.order.judged &&
      (c.exact.order < c.order.lowest || c.exact.order > c.order.highest))
    c.faults.push_back(fmt::format("the minimal order is {}, not between {} and {}", c.exact.order,
                                   c.order.lowest, c.order.highest));
}

}  // namespace

std::vector<std::string> certification::basic_faults(const Certificate& c, double dense) {
  const std::string way_out =
      "; System::transfer, apply and simulate by Stepper::midpoint keep the digits, and so does a "
      "model of the required band, compile(d, Scene{.band_hz = {low, high}})";
  std::vector<std::string> faults;
  judge(faults, c.residual, kHolds, "equations as written are satisfied only to");
  judge(faults, c.apply_against_transfer, kHolds, "apply differs from the transfer by");
  judge(faults, c.dense_against_factors, kHolds, "the dense model differs from the factors by");
  judge(faults, c.dense_error, kDenseHolds,
        fmt::format("written as A, B, C, D the model loses digits: at s = {:.3g}{:+.3g}j outputs "
                    "change, relative to their largest value, by",
                    c.dense_error_s.real(), c.dense_error_s.imag()),
        way_out);
  judge(faults, dense, kDenseHolds, "the transfer of the dense model differs from the factors' by",
        c.dense_error > kDenseHolds ? "" : way_out);
  return faults;
}

FullCertificate certify(const System& system, const Full& subject) {
  require_state_space(system.stage().graph);
  FullCertificate c;
  const bool dense = system.order() <= subject.dense_up_to;
  std::vector<double> omegas;
  std::vector<certification::FoundPoles::Right> growing;
  detail::Rounded before;  // as written, before `minimize`
  if (dense) {
    c.order = system.order_verdict();
    system.write(before.model);
    before.rounding = detail::rounding_of(detail::data_of(system), before.model);
    certification::FoundPoles found =
        certification::check_poles(system, before.model, before.rounding.A);
    omegas = std::move(found.omegas);
    c.poles = std::move(found.poles);
    growing = certification::shown(found.right, system.state_space());
    c.poles.hidden = c.poles.right - static_cast<int>(growing.size());
    c.poles.why_not = what_is_set_aside(system.stage().graph);
  } else {
    c.poles.why_not = c.grid.why_not = fmt::format("{} states are more than {} (Full::dense_up_to)",
                                                   system.order(), subject.dense_up_to);
    c.order.order = c.order.highest = system.order();
  }
  c.basic = dense ? system.dense_certificate() : system.certificate();
  c.exact =
      minreal::order_of_stage(system.stage(), system.order(), subject.exact, values_of(system));
  reach_up_to(c.exact, c.order);
  set_range(omegas, c.grid);
  const bool transfers = !system.inputs().empty() && !system.outputs().empty();
  c.grid.points = transfers ? std::max(subject.points, 0) : 0;
  std::vector<Complex> points = grid_of(c.grid);
  const std::vector<MatrixXcd> factored = factored_at(system, points, c.grid);
  if (c.grid.points > 0) {
    detail::Measure measure = detail::measure(*system.stage().source, {});
    if (dense) {
      std::vector<Complex> of_dense = points;
      std::vector<MatrixXcd> there = factored;
      add_poles(system, omegas, of_dense, there);
      measure.terms = detail::terms(before.model, of_dense)
                          .cwiseMax(detail::terms(system.state_space(), of_dense));
      check_dense(system, before, of_dense, there, measure, c.grid);
    }
    check_written(system, subject, points, factored, measure, c.grid);
    check_pairs(system, detail::data_of(system).skeleton->options, points, factored, growing, c);
  } else {
    if (!transfers)
      c.grid.why_not = "without inputs, or without outputs, there is no transfer";
    else if (subject.points <= 0)
      c.grid.why_not = "no grid is requested (Full::points)";
    c.passivity.why_not = c.reciprocity.why_not = c.grid.why_not;
  }
  list_faults(system, c);
  return c;
}

}  // namespace titop
