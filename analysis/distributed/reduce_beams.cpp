#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/distributed/reduce_beams.hpp>
#include <titop/analysis/distributed/with_blocks.hpp>
#include <titop/analysis/reduction/bound.hpp>
#include <titop/analysis/reduction/compile_scene.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop {
namespace {

using std::numbers::pi;

constexpr double kShare = 0.25;  ///< of the accuracy: error of the finite beams
constexpr double kFiner = 1.5;   ///< more elements and modes, if it is larger
constexpr int kMostElements = 200;

const ExactBeam* exact_beam(const Block& block) {
  const auto* spec = dynamic_cast<const Specified<ExactBeam>*>(&block);
  return spec ? &spec->spec() : nullptr;
}

/// k L of a bending wave at omega.
double bending_wave(const ExactBeam& b, double I, double omega) {
  return std::pow(b.material.rho * b.section.area * omega * omega / (b.material.E * I), 0.25) *
         b.length;
}

/// Elements of the softer plane for a bending wave at omega: (k h)^4 / 720 is the error of its
/// omega^2.
double elements_for(const ExactBeam& b, double omega, double error) {
  return bending_wave(b, std::min(b.section.I_y, b.section.I_z), omega) /
         std::pow(720 * error, 0.25);
}

/// Modes of the beam clamped at P up to omega: in bending, as a rod and as a shaft the k-th is near
/// k L = (k - 1 / 2) pi.
int modes_up_to(const ExactBeam& b, double omega) {
  const Material& m = b.material;
  const Section& s = b.section;
  const double G = m.G ? *m.G : m.E / (2 * (1 + *m.nu)), polar = s.I_x ? *s.I_x : s.I_y + s.I_z,
               rod = omega * b.length * std::sqrt(m.rho / m.E),
               shaft = omega * b.length * std::sqrt(m.rho * polar / (G * s.J));
  int count = 0;
  for (const double x : {bending_wave(b, s.I_y, omega), bending_wave(b, s.I_z, omega), rod, shaft})
    count += static_cast<int>(std::min(x / pi + 0.5, 6.0 * kMostElements));
  return count;
}

/// The scene's graph with finite beams, so many times finer than the first guess.
class FiniteScene {
 public:
  FiniteScene(const Graph& exact, const Scene& scene) : exact_(exact), scene_(scene) {}

  Graph graph(double finer, std::vector<FiniteBeam>& beams) const {
    beams.clear();
    std::map<const Block*, std::pair<BlockPtr, FiniteBeam>> made;  // twins share their body
    std::vector<BlockPtr> blocks;
    for (const Node& node : exact_.nodes) {
      blocks.emplace_back();
      const ExactBeam* spec = exact_beam(*node.block);
      if (!spec) continue;
      const auto [found, added] = made.try_emplace(node.block.get());
      if (added) found->second = finite(*spec, finer);
      blocks.back() = found->second.first;
      beams.push_back(found->second.second);
      beams.back().name = node.name;
    }
    return detail::with_blocks(exact_, blocks);
  }

 private:
  std::pair<BlockPtr, FiniteBeam> finite(const ExactBeam& spec, double finer) const {
    const double omega = 2 * pi * scene_.band_hz[1];
    FiniteBeam beam;
    const double wanted = finer * elements_for(spec, omega, kShare * scene_.accuracy);
    beam.elements = static_cast<int>(std::ceil(std::clamp<double>(wanted, 2, kMostElements)));
    const int total = 6 * beam.elements;
    fe::ModeOptions modes;
    beam.modes = std::min(total, modes_up_to(spec, 2 * finer * omega));
    if (beam.modes + 12 < total) modes = {.kept = beam.modes, .residual = {"C", "P"}};
    const ModalData data = modal_data(with_elements(spec, beam.elements, modes));
    const auto count = static_cast<int>(data.omega.size());
    if (!modes.kept) beam.modes = count;
    beam.residuals = count - beam.modes;
    return {as_block(FlexibleBody(data)), beam};
  }

  const Graph& exact_;
  const Scene& scene_;
};

bool at_limit(const std::vector<FiniteBeam>& beams) {
  return std::ranges::all_of(beams,
                             [](const FiniteBeam& b) { return b.elements == kMostElements; });
}

void require_beams(const Graph& graph) {
  for (const Node& node : graph.nodes)
    if (exact_beam(*node.block)) return;
  throw Error(
      Code::bad_value, "the diagram has no distributed beam",
      "put ExactBeam in place of FlexibleBody{Beam}, or call compile(diagram, scene): other "
      "bodies keep their mesh");
}

[[noreturn]] void refuse(const ErrorBound& error, const std::string& subject) {
  throw Error(Code::bad_value,
              fmt::format("{} differ from the distributed ones by {:.2g} at {:.4g} Hz ({} by {})",
                          subject, error.worst, error.hertz, error.output, error.input),
              "raise Scene::accuracy, or lower the band's upper end");
}

[[noreturn]] void refuse_size(const ErrorBound& error, const std::vector<FiniteBeam>& beams) {
  std::vector<std::string> names;
  for (const FiniteBeam& beam : beams) names.push_back(beam.name);
  refuse(error, fmt::format("{} with {} elements", detail::some_names(names), kMostElements));
}

/// Accuracies of the reduction to try. The errors of beams and reduction seldom add: first the
/// whole. If they do, the first is e of peaks that are 1 + e times as large, and `compare` divides
/// the sum, which it samples, by cos(kPhase / 2).
std::array<double, 2> accuracies(double whole, double e) {
  return {whole, (whole - e) / (1 + e) * std::cos(detail::kPhase / 2)};
}

}  // namespace

ReducedBeams reduce_beams(const Diagram& diagram, const Scene& scene, const Options& options) {
  detail::check(scene);
  require_beams(diagram.graph());
  const Graph graph = detail::restricted(diagram.graph(), scene);
  const System exact(detail::compile_graph(graph, options));
  const FiniteScene finite(graph, scene);
  std::vector<FiniteBeam> beams;
  Graph with_beams;
  ErrorBound of_beams;
  for (double finer = 1;; finer *= kFiner) {
    with_beams = finite.graph(finer, beams);
    Options all = options;
    all.minimize_up_to = 0;
    of_beams = compare(System(detail::compile_graph(with_beams, all)), exact, scene);
    if (of_beams.worst <= kShare * scene.accuracy) break;
    if (!at_limit(beams)) continue;
    if (of_beams.worst < scene.accuracy) break;
    refuse_size(of_beams, beams);
  }
  Scene rest = scene;
  rest.inputs.clear(), rest.outputs.clear();  // the graph has them already
  ErrorBound error;
  for (const double accuracy : accuracies(scene.accuracy, of_beams.worst)) {
    rest.accuracy = accuracy;
    const ReducedSystem system =
        detail::compile_scene(with_beams, rest, options, detail::Order::least);
    error = compare(system, exact);
    if (error.worst <= scene.accuracy) return {system, beams, error, of_beams};
  }
  refuse(error, "the reduced beams");
}

std::string to_string(const ReducedBeams& reduced) {
  std::string text;
  for (const FiniteBeam& b : reduced.beams)
    text +=
        fmt::format("{:<12} {:>3} elements, {:>3} modes{}\n", b.name, b.elements, b.modes,
                    b.residuals > 0 ? fmt::format(" and {} residual vectors", b.residuals) : "");
  return text + fmt::format(
                    "{} states; against the distributed beams {:.2g} (estimate: {} by {} at {:.4g} "
                    "Hz), of which the finite beams {:.2g}\n",
                    reduced.system.order(), reduced.error.worst, reduced.error.output,
                    reduced.error.input, reduced.error.hertz, reduced.of_beams.worst);
}

}  // namespace titop
