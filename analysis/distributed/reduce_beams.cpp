#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/distributed/reduce_beams.hpp>
#include <titop/analysis/distributed/with_blocks.hpp>
#include <titop/analysis/reduction/compile_scene.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/compiler/system/compile_graph.hpp>

namespace titop {
namespace {

using std::numbers::pi;

constexpr double kShare = 0.5;  ///< of the accuracy: error of the finite beams
constexpr double kFiner = 1.5;  ///< more elements and modes, if it is larger
constexpr int kMostElements = 200;
constexpr int kTries = 4;  ///< reductions, each of half the accuracy of the one before

const ExactBeam* exact_beam(const Block& block) {
  const auto* spec = dynamic_cast<const Specified<ExactBeam>*>(&block);
  return spec ? &spec->spec() : nullptr;
}

/// Number of elements with which a bending wave of the softer plane at omega has this relative
/// error of omega^2, (k h)^4 / 720.
double elements_for(const ExactBeam& b, double omega, double error) {
  const double I = std::min(b.section.I_y, b.section.I_z);
  const double wave =
      std::pow(b.material.rho * b.section.area * omega * omega / (b.material.E * I), 0.25);
  return wave * b.length / std::pow(720 * error, 0.25);
}

/// The scene's graph with finite beams, `finer` times finer than the first mesh.
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
    beam.elements = std::clamp(static_cast<int>(std::ceil(wanted)), 2, kMostElements);
    const ModalData all = modal_data(with_elements(spec, beam.elements));
    const auto total = static_cast<int>(all.omega.size());
    const double limit = 2 * finer * omega;
    beam.modes =
        static_cast<int>(std::ranges::count_if(all.omega, [&](double w) { return w <= limit; }));
    beam.residuals = 12;
    if (beam.modes + beam.residuals >= total) {
      beam.modes = total, beam.residuals = 0;
      return {as_block(FlexibleBody(all)), beam};
    }
    const fe::ModeOptions modes{.kept = beam.modes, .residual = {"C", "P"}};
    return {as_block(FlexibleBody(with_elements(spec, beam.elements, modes))), beam};
  }

  const Graph& exact_;
  const Scene& scene_;
};

bool at_limit(const std::vector<FiniteBeam>& beams) {
  return std::ranges::all_of(beams,
                             [](const FiniteBeam& b) { return b.elements == kMostElements; });
}

[[noreturn]] void refuse(const ErrorBound& error, const char* subject) {
  throw Error(Code::bad_value,
              fmt::format("{} differ from the distributed ones by {:.2g} at {:.4g} Hz ({} by {})",
                          subject, error.worst, error.hertz, error.output, error.input),
              "raise Scene::accuracy, or lower the band's upper end");
}

}  // namespace

ReducedBeams reduce_beams(const Diagram& diagram, const Scene& scene, const Options& options) {
  detail::check(scene);
  const Graph graph = detail::restricted(diagram.graph(), scene);
  const System exact(detail::compile_graph(graph, options));
  const FiniteScene finite(graph, scene);
  std::vector<FiniteBeam> beams;
  Graph with_beams = finite.graph(1, beams);
  ErrorBound of_beams;
  for (double finer = 1;; finer *= kFiner) {
    with_beams = finite.graph(finer, beams);
    Options all = options;
    all.minimize_up_to = 0;
    of_beams = compare(System(detail::compile_graph(with_beams, all)), exact, scene);
    if (of_beams.worst <= kShare * scene.accuracy) break;
    if (at_limit(beams)) refuse(of_beams, "beams of 200 elements");
  }
  Scene rest = scene;
  rest.inputs.clear(), rest.outputs.clear();  // the graph has them already
  rest.accuracy = scene.accuracy - of_beams.worst;
  for (int k = 1;; ++k, rest.accuracy /= 2) {
    const ReducedSystem system = detail::compile_scene(with_beams, rest, options);
    const ErrorBound error = compare(system, exact);
    if (error.worst <= scene.accuracy) return {system, beams, error, of_beams};
    if (k == kTries) refuse(error, "the reduced beams");
  }
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
