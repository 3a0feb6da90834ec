#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <ranges>
#include <titop/analysis/reduction/rate_feedback.hpp>
#include <titop/analysis/reduction/reduction.hpp>
#include <titop/analysis/reduction/sequence.hpp>
#include <titop/analysis/reduction/sharpen.hpp>
#include <titop/analysis/reduction/spare.hpp>
#include <titop/analysis/reduction/twins.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <utility>

namespace titop::detail {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr double kMore = 1.5;  ///< of the coordinates that suffice: from these some are spared

class ByModes : public Reduction {
 public:
  ByModes(Setting& setting, const Graph& graph) : setting_(setting) {
    setting_.timed("modes", [&] {
      if (const auto rates = rate_feedback(graph, nominal_values(graph)))
        read_with_rotors(*rates);
      else
        read_at_rest(graph);
    });
    setting_.take_samples(whole_);
    if (whole_.loose_coupled)
      refuse_growing(setting_.full, setting_.scene, setting_.band, setting_.samples);
  }

  SampledSpectrum spectrum() const override { return whole_; }

  std::optional<ReducedData> reach(double accuracy) override {
    const double start = now();
    const std::optional<std::size_t> step = first_within(accuracy);
    if (!step) return std::nullopt;
    ReducedData d = setting_.order == Order::least ? least_model(*step, accuracy) : model_of(*step);
    d.steps.push_back({"whole", static_cast<int>(whole_.order() + whole_.far),
                       static_cast<int>(d.small.order()), d.bound.worst,
                       "modes of the band, and static-like vectors of those above it"});
    d.modes = kept_modes(whole_, d.small);
    d.seconds.emplace_back("reduce", now() - start);
    return d;
  }

  [[noreturn]] void refuse(double accuracy) override {
    const auto& steps = sequence().steps();
    const auto best = std::min_element(steps.begin(), steps.end(),
                                       [](auto& a, auto& b) { return a.error < b.error; });
    const auto step = static_cast<std::size_t>(best - steps.begin());
    const ErrorBound& b = bound_of(step);
    const bool can_balance = setting_.full.order() <= setting_.scene.balance_up_to;
    throw Error(
        Code::bad_value,
        fmt::format("an accuracy of {:.1e} cannot be met: {:.1e} is reached with {} "
                    "coordinates, from {} to {} at {:.4g} Hz",
                    accuracy, b.worst, sequence().model(step).order(), b.input, b.output, b.hertz),
        setting_.way_out(b.worst, "whole_up_to", "the modes of the whole") +
            (can_balance ? ", or balance states: Scene::keep_structure = false" : ""),
        {fmt::format("most of the missing motion is in {}{}", where_missing(step, b),
                     setting_.bodies.empty() ? "" : "; " + setting_.bodies)});
  }

 private:
  /// Modes up to here are made sharper [rad/s].
  double beyond() const { return 1.2 * (2 * pi * setting_.scene.band_hz[1]); }

  void read_at_rest(const Graph& graph) {
    read_whole(setting_.model, *setting_.data, graph, nullptr);
    setting_.band = band_of(setting_.model, setting_.scene, whole_);
    sharpen(whole_, setting_.model, beyond());
    if (setting_.scene.bound == BoundKind::theorem) couple(whole_);
  }

  /// The same of the structure at rest, with its momenta and dampers added afterwards.
  void read_with_rotors(const RateFeedback& rates) {
    const auto at_rest = compiled(rates.graph);
    const System system(at_rest);
    read_whole(system, *at_rest, rates.graph, &rates);
    sharpen(whole_, system, beyond());
    close(whole_, rates);
    couple(whole_);
    setting_.band = band_of(setting_.model, setting_.scene, whole_);
    if (!rates.momenta.empty())
      setting_.note("rotors", whole_.order(), whole_.order(),
                    fmt::format("momenta of {} in a skew matrix", rates.momenta));
  }

  /// The structure at rest; there is no such form if its passes refuse it.
  std::shared_ptr<const SystemData> compiled(const Graph& at_rest) const try {
    Options options = setting_.options;
    options.dump_to.clear();
    return compile_graph(at_rest, options);
  } catch (const Error& error) {
    throw NoStructure(Code::bad_value,
                      "with its rotors at rest: " + error.mistakes().front().message,
                      "take balanced states");
  }

  /// `whole_` of this system, which was compiled from the graph, at rest if it has rotors.
  void read_whole(const System& system, const SystemData& data, const Graph& graph,
                  const RateFeedback* rates) {
    Coordinates c = coordinates(system, data);
    if (rates) scale_masses(c, *rates);
    setting_.note_structure(c.size());
    join(c, data.graph());
    if (c.size() > setting_.scene.whole_up_to) refuse_size(setting_, c.size());
    whole_ = whole(system, c, positions_read(graph));
  }

  void join(Coordinates& c, const Graph& graph) {
    const Index before = c.size();
    const TwinReduction twins = join_twins(c, graph);
    if (twins.removed > 0)
      setting_.note("symmetry", before, c.size(),
                    fmt::format("{} move alike", fmt::join(twins.pairs, "; ")));
  }

  /// Begun at the first call: if bodies lose modes, only for the last of several tries.
  Sequence& sequence() {
    if (!sequence_) sequence_.emplace(whole_, setting_.samples, setting_.band.high);
    return *sequence_;
  }

  ErrorBound bound_of(const Small& small) const {
    return setting_.bound(whole_, small.poles(),
                          [&](std::complex<double> s) { return small.transfer(s); });
  }

  const ErrorBound& bound_of(std::size_t step) {
    const auto found = bounds_.find(step);
    if (found != bounds_.end()) return found->second;
    return bounds_.emplace(step, bound_of(sequence().model(step))).first->second;
  }

  /// The model of this step, whose bound is at most the accuracy.
  ReducedData model_of(std::size_t step) {
    return setting_.result(sequence().model(step), bounds_.at(step));
  }

  /// The same, or a model with fewer coordinates, whose bound is too: of a sequence with half as
  /// many again, without those that can be spared.
  ReducedData least_model(std::size_t step, double accuracy) {
    const std::size_t count = sequence().choice(step).size();
    std::size_t last = step;
    while (static_cast<double>(sequence().choice(last).size()) <
               kMore * static_cast<double>(count) &&
           (last + 1 < sequence().steps().size() || sequence().grow()))
      ++last;
    const auto fewer =
        spared(sequence(), setting_.samples, sequence().choice(last), target_of(accuracy));
    for (const Sequence::Choice& choice : fewer | std::views::reverse) {
      if (choice.size() >= count) break;
      Small small = sequence().model(choice);
      ErrorBound bound = bound_of(small);
      if (bound.worst <= accuracy) return setting_.result(std::move(small), std::move(bound));
    }
    return model_of(step);
  }

  /// Largest error on the samples.
  static double target_of(double accuracy) { return accuracy * std::cos(kPhase / 2); }

  /// The bound costs more than the error on the samples, which goes first.
  std::optional<std::size_t> first_within(double accuracy) {
    const double target = target_of(accuracy);
    for (std::size_t k = 0; true; ++k) {
      const auto& steps = sequence().steps();
      if (k == steps.size() && !sequence().grow()) return std::nullopt;
      if (steps[k].error <= target && bound_of(k).worst <= accuracy) return k;
    }
  }

  /// The block with the largest share of the elastic energy of the model's error there.
  std::string where_missing(std::size_t step, const ErrorBound& b) {
    const Small small = sequence().model(step);
    const std::complex<double> s = on_ray(setting_.scene, 2 * pi * b.hertz);
    const auto& names = setting_.full.inputs();
    const Index m = std::find(names.begin(), names.end(), b.input) - names.begin();
    Eigen::VectorXcd left = -(small.V * small.response(s, m));
    for (Index j = 0; j < whole_.elastic(); ++j)
      left(j) += whole_.b(j, m) / (s * (s + whole_.damping(j)) + whole_.lambda(j));
    if (whole_.blocks.empty() || left.size() == 0) return "no block";
    // At a resonance the error is 90 degrees out of phase: rotate it to the phase of its largest
    // entry.
    Index most = 0;
    (left.array().abs() * whole_.lambda.head(left.size()).array().sqrt()).maxCoeff(&most);
    if (left(most) != 0.0) left *= std::abs(left(most)) / left(most);
    Index block = 0;
    const double share = participation(whole_, left.real()).col(0).maxCoeff(&block);
    return fmt::format("{} ({:.0f} %)", whole_.blocks[static_cast<std::size_t>(block)],
                       100 * share);
  }

  Setting& setting_;
  Whole whole_;
  std::optional<Sequence> sequence_;
  std::map<std::size_t, ErrorBound> bounds_;  ///< by step of the sequence, as far as computed
};

}  // namespace

std::unique_ptr<Reduction> by_modes(Setting& setting, const Graph& graph) {
  return std::make_unique<ByModes>(setting, graph);
}

}  // namespace titop::detail
