#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <titop/compiler/system/damping_of_bodies.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

constexpr double kUnlike = 5;         ///< times less or more
constexpr double kShareOfMode = 0.5;  ///< of bodies in a mode that is theirs

struct RangeOfXi {
  double least = HUGE_VAL, largest = 0;
  void take(const RangeOfXi& other) {
    least = std::min(least, other.least);
    largest = std::max(largest, other.largest);
  }
};

/// Of each damped body, by its name.
std::map<std::string, RangeOfXi> xi_of_bodies_by_name(const SystemData& data) {
  std::map<std::string, RangeOfXi> all;
  for (std::size_t i = 0; i < data.numbers.blocks.size(); ++i) {
    const Modal* modal = data.numbers.blocks[i]->modal.get();
    if (!modal || modal->damping.size() == 0 || !(modal->damping.maxCoeff() > 0)) continue;
    const Eigen::ArrayXd xi = modal->damping.array() / (2 * modal->stiffness.array().sqrt());
    all[data.graph().nodes[i].name] = {xi.minCoeff(), xi.maxCoeff()};
  }
  return all;
}

/// True if an equation reads a rate, or a one-way block has states: a damper or a controller, which
/// may damp any mode.
bool has_dampers(const Graph& g) {
  const auto reads_rate = [&](const Term& t) {
    return t.of == Term::Of::rate ||
           (t.of == Term::Of::signal &&
            g.signals[linalg::at(t.signal)].quantity == Quantity::velocity);
  };
  const auto controls = [](const Node& n) {
    return !n.block->interface().inputs.empty() && !n.block->interface().states.empty();
  };
  return std::any_of(g.nodes.begin(), g.nodes.end(), controls) ||
         std::any_of(g.equations.begin(), g.equations.end(), [&](const Equation& e) {
           return std::any_of(e.terms.begin(), e.terms.end(), reads_rate);
         });
}

/// "boom, tip"
std::string names_of(const Pole& p) {
  std::string names;
  for (const auto& [name, share] : p.blocks) names += (names.empty() ? "" : ", ") + name;
  return names;
}

/// With their damping, their blocks, and the xi of the bodies among these.
std::string modes_of(const std::vector<const Pole*>& list) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, list.size()); ++i)
    text += fmt::format("{}the mode at {:.4g} rad/s of {} has damping {:.2g} (its bodies: xi {})",
                        i == 0 ? "" : ", ", list[i]->omega, names_of(*list[i]), list[i]->damping,
                        xi_of_bodies(*list[i]));
  if (list.size() > most) text += fmt::format(", and {} more", list.size() - most);
  return text;
}

}  // namespace

bool has_damped_bodies(const SystemData& data) { return !xi_of_bodies_by_name(data).empty(); }

void compare_with_bodies(const SystemData& data, std::vector<Pole>& poles) {
  const std::map<std::string, RangeOfXi> bodies = xi_of_bodies_by_name(data);
  if (bodies.empty()) return;
  const bool by_bodies_alone = !has_dampers(*data.skeleton->stage.source);
  for (Pole& p : poles) {
    if (!p.pair) continue;
    RangeOfXi of_mode;
    double share = 0;
    bool alone = by_bodies_alone;
    for (const auto& [name, part] : p.blocks) {
      const auto body = bodies.find(name);
      alone = alone && body != bodies.end();
      if (body == bodies.end()) continue;
      share += part;
      of_mode.take(body->second);
    }
    const bool less = share >= kShareOfMode && p.damping * kUnlike < of_mode.least;
    const bool more = share > 0 && alone && p.damping > kUnlike * of_mode.largest;
    if (less || more) p.least_xi = of_mode.least, p.largest_xi = of_mode.largest;
  }
}

std::vector<Note> damping_notes(const std::vector<Pole>& poles) {
  std::vector<const Pole*> less, more;
  for (const Pole& p : poles)
    if (p.unlike_bodies()) (p.damping < p.least_xi ? less : more).push_back(&p);
  std::vector<Note> notes;
  for (const auto* list : {&less, &more})
    if (!list->empty())
      notes.push_back(
          {Note::Kind::info, "dense",
           modes_of(*list) +
               ": xi is that of modes clamped at P; damping_of_assembly prescribes that "
               "of assembled modes"});
  return notes;
}

}  // namespace titop::detail
