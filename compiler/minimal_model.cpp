#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/compare.hpp>
#include <titop/compiler/exact_order.hpp>
#include <titop/compiler/system_data.hpp>

/// The dense model of a system, minimized: nothing is removed on trust.
namespace titop::detail {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// The minimal order where exact arithmetic is asked for and has found it; -1: not.
int exact_order_of(const SystemData& d, int states) {
  if (states > d.skeleton->options.exact_up_to) return -1;
  // Blocks' states that follow from others count there, and so do integrators of positions.
  const ExactOrder exact =
      exact_order(*d.skeleton->stage.source, {.states = 4 * d.skeleton->options.exact_up_to},
                  d.numbers.parameters);
  d.dense_notes.push_back({Note::Kind::info, "minimize", to_string(exact)});
  return exact.decided ? exact.order : -1;
}

/// Beside the slowest, a middle and the fastest of the modes that leave, and the most visible one.
std::vector<std::complex<double>> near_modes(std::vector<JudgedMode> modes) {
  std::sort(modes.begin(), modes.end(),
            [](const JudgedMode& a, const JudgedMode& b) { return a.omega < b.omega; });
  const auto most = std::max_element(
      modes.begin(), modes.end(),
      [](const JudgedMode& a, const JudgedMode& b) { return a.visibility < b.visibility; });
  std::vector<std::complex<double>> points;
  for (const double omega :
       {modes.front().omega, modes[modes.size() / 2].omega, modes.back().omega, most->omega})
    points.emplace_back(0.1 * omega, omega);
  return points;
}

/// The verdict where its modes stay after all. A mode of visibility v changes the transfer by up to
/// 10 v at these points: where some that were judged not to matter did more, the verdict keeps the
/// change that was measured, although nothing is removed, and the certificate calls it a fault.
OrderVerdict back_to(int order, double judged, OrderVerdict v) {
  v.order = v.highest = order;
  v.undecided.insert(v.undecided.end(), v.removed.begin(), v.removed.end());
  v.removed.clear();
  v.to_fewer = std::min(v.to_fewer, v.to_more);
  v.to_more = 0;
  if (v.change <= 100 * judged) v.change = -1;  // rounding
  return v;
}

}  // namespace

void minimize_checked(const System& system, const SystemData& d, StateSpace& dense) {
  const double resolution = d.skeleton->options.resolution;
  Minimized m = minimize(dense, {.resolution = resolution,
                                 .exact_order = exact_order_of(d, dense.order()),
                                 .energy = d.states.trivial() ? MatrixXd() : potential_energy(d)});
  const bool removed = !m.order.removed.empty();
  if (removed && !dense.inputs.empty() && !dense.outputs.empty()) {
    std::vector<MatrixXcd> before, after;
    const std::vector<std::complex<double>> points = near_modes(m.order.removed);
    for (const std::complex<double> s : points) {
      before.push_back(system.transfer(s));
      after.push_back(m.model.transfer(s));
    }
    Measure by =
        measure(*d.skeleton->stage.source, terms(dense, points).cwiseMax(terms(m.model, points)));
    m.order.change = difference(after, before, by, system, points).relative;
    m.notes.front() = to_string(m.order);
  }
  if (m.order.change > std::max(1e-8, 10 * resolution)) {
    const OrderVerdict kept = back_to(dense.order(), std::max(1e-8, resolution), m.order);
    d.dense_notes.push_back(
        {Note::Kind::warning, "minimize",
         fmt::format("nothing was removed, since that changes the transfer by {:.1e}: {}",
                     m.order.change, to_string(kept))});
    d.dense_order = kept;
    return;
  }
  for (std::string& text : m.notes)
    d.dense_notes.push_back(
        {removed ? Note::Kind::removed : Note::Kind::info, "minimize", std::move(text)});
  d.dense_order = std::move(m.order);
  dense = std::move(m.model);
}

}  // namespace titop::detail
