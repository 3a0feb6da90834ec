#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/reduction/reduced_data.hpp>
#include <titop/graph/pole.hpp>

namespace titop {

int ReducedSystem::order() const {
  return data_->states ? static_cast<int>(data_->states->order()) : state_space().order();
}
const std::vector<std::string>& ReducedSystem::inputs() const& { return data_->full.inputs(); }
const std::vector<std::string>& ReducedSystem::outputs() const& { return data_->full.outputs(); }
const System& ReducedSystem::full() const& { return data_->full; }
const Scene& ReducedSystem::scene() const& { return data_->scene; }
const std::vector<Note>& ReducedSystem::notes() const& { return data_->notes; }
const ErrorBound& ReducedSystem::bound() const& { return data_->bound; }
const std::vector<ReductionStep>& ReducedSystem::steps() const& { return data_->steps; }
const std::vector<KeptMode>& ReducedSystem::modes() const& { return data_->modes; }

Eigen::MatrixXcd ReducedSystem::transfer(std::complex<double> s) const {
  if (data_->states) return data_->states->transfer(s);
  Eigen::MatrixXcd H = data_->small.transfer(s);
  if (!H.allFinite()) throw pole_at(s, fmt::format("{}, reduced,", full().stage().graph.name));
  return H;
}

const std::vector<std::pair<std::string, double>>& ReducedSystem::seconds() const& {
  return data_->seconds;
}

std::string to_string(const ReducedSystem& system) {
  std::string text = fmt::format("{}: {} states of {}\n", system.full().stage().graph.name,
                                 system.order(), system.full().order());
  const Scene& q = system.scene();
  text += fmt::format(
      "  required  {:.1e} of each pair's own peak, {:g} to {:g} Hz, on s = ({:g} + {:.6g} j) "
      "omega\n",
      q.accuracy, q.band_hz[0], q.band_hz[1], q.damping_floor,
      std::sqrt(1 - q.damping_floor * q.damping_floor));
  for (const ReductionStep& s : system.steps())
    text += fmt::format("  {:<9} {:>5} -> {:>4} {}, {}: {}\n", s.name, s.before, s.after,
                        s.name == "kept" || s.name == "balanced" ? "states" : "coordinates",
                        s.error == 0 ? "exact" : fmt::format("error {:.1e}", s.error), s.text);
  const ErrorBound& b = system.bound();
  text += fmt::format(
      "  bound     {:.1e}{}, {} of {} transfers\n", b.worst,
      b.input.empty() ? "" : fmt::format(" from {} to {} at {:.4g} Hz", b.input, b.output, b.hertz),
      b.kind == BoundKind::theorem ? "a theorem" : "an estimate", b.samples);
  if (b.anywhere >= 0)
    text += fmt::format("            {:.1e} everywhere right of the axis, a theorem\n", b.anywhere);
  for (std::size_t k = 0; k < system.modes().size(); ++k) {
    const KeptMode& m = system.modes()[k];
    std::string blocks;
    for (const auto& [name, share] : m.blocks)
      blocks += fmt::format("{}{} {:.0f} %", blocks.empty() ? "" : ", ", name, 100 * share);
    text +=
        fmt::format("  mode{:<5} {:>12.6g} Hz, damping {:.3g}, {}: {}\n", k + 1, m.hertz, m.damping,
                    m.exact      ? "mode"
                    : m.balanced ? "balanced"
                                 : "vector",
                    blocks);
  }
  for (const Note& note : system.notes()) text += "  " + note.text + "\n";
  return text;
}

}  // namespace titop
