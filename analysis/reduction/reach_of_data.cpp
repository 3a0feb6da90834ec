#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <titop/analysis/reduction/reach_of_data.hpp>

namespace titop::detail {
namespace {

constexpr double kReach = 1.5;  ///< times the band's upper end: range of a body's data

}  // namespace

std::vector<Note> reach_of_data(const SystemData& data, const Scene& scene) {
  std::vector<Note> notes;
  const double needed = kReach * scene.band_hz[1];
  for (const int i : data.layout().state_nodes) {
    const auto node = static_cast<std::size_t>(i);
    const Dynamics& m = *data.numbers.blocks[node];
    if (!m.modes || m.modes->stiffness.size() == 0) continue;
    const double highest = std::sqrt(m.modes->stiffness.maxCoeff()) / (2 * std::numbers::pi);
    if (highest < needed)
      notes.push_back(
          {Note::Kind::warning, "reduction",
           fmt::format("the modes of {} end at {:.4g} Hz, the band at {:.4g} Hz: give it its modes "
                       "up to {:.4g} Hz (more of them, or a finer mesh); the bound does not "
                       "contain modes that the data lack",
                       data.graph().nodes[node].name, highest, scene.band_hz[1], needed)});
  }
  return notes;
}

}  // namespace titop::detail
