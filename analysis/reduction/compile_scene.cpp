#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/analysis/reduction/bodies.hpp>
#include <titop/analysis/reduction/compile_scene.hpp>
#include <titop/analysis/reduction/oscillators.hpp>
#include <titop/analysis/reduction/reach_of_data.hpp>
#include <titop/analysis/reduction/reduction.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/closed_form.hpp>

/// `compile` for a scene, step by step.
namespace titop {
namespace {

using detail::now;
using detail::Reduction;
using std::numbers::pi;

constexpr double kShare = 0.1;         ///< of the accuracy: effects of modes that bodies lose
constexpr double kMostOfBodies = 0.3;  ///< of the accuracy: largest error of smaller bodies
constexpr int kTries = 4;

int states_of(const Graph& graph) {
  int states = 0;
  for (const Node& n : graph.nodes) states += static_cast<int>(n.block->interface().states.size());
  return states;
}

/// One scene, compiled and made ready for any accuracy: bodies first if the whole is too large,
/// then modes of the whole, or states if it is no structure.
class SceneReduction {
 public:
  /// `finest`: the smallest accuracy that will be required.
  SceneReduction(const Graph& whole, const Scene& scene, const Options& options, double finest,
                 detail::Order order = detail::Order::nested)
      : setting_(scene, options, finest, states_of(whole)) {
    setting_.order = order;
    detail::check(scene);
    const Graph graph = detail::restricted(whole, scene);
    if (graph.inputs.empty() || graph.outputs.empty())
      throw Error(
          Code::bad_value,
          fmt::format("{} has no {}", graph.name, graph.inputs.empty() ? "input" : "output"),
          "a reduced model needs an input and an output: declare both in the diagram");
    require_state_space(graph);
    compile_model(graph);
    setting_.full = setting_.model;
    setting_.notes = detail::reach_of_data(*setting_.data, scene);
    const int count = (setting_.full.order() + 1) / 2;
    if (!scene.keep_structure)
      setting_.why = "the scene requires balanced states (Scene::keep_structure)";
    if (!scene.keep_structure || count <= scene.whole_up_to) reduction_ = read(graph);
    if (!reduction_) reduce_bodies(graph, count);
  }

  SceneReduction(const SceneReduction&) = delete;  // the reduction has references into this
  SceneReduction& operator=(const SceneReduction&) = delete;

  /// The smallest model whose bound is at most this.
  ReducedSystem reach(double accuracy) {
    std::optional<ReducedSystem> system = try_reach(accuracy);
    if (!system) reduction_->refuse(accuracy);
    return *std::move(system);
  }

  /// The same; none if rounding ends first.
  std::optional<ReducedSystem> try_reach(double accuracy) {
    std::optional<detail::ReducedData> data = reduction_->reach(accuracy);
    if (!data) return std::nullopt;
    if (auto fewer = in_fewer_states(*data, accuracy)) data = std::move(fewer);
    data->scene.accuracy = accuracy;
    return ReducedSystem(std::make_shared<const detail::ReducedData>(*std::move(data)));
  }

 private:
  /// Balanced states instead of a structure with more states than the minimal model, such as one
  /// whose momenta are constant; looked at if the structure has kept most of the full model.
  std::optional<detail::ReducedData> in_fewer_states(const detail::ReducedData& data,
                                                     double accuracy) {
    const int full = setting_.full.order();
    if (data.states) return std::nullopt;
    const int order = data.small.states();
    if (2 * order <= full || full > setting_.options.minimize_up_to) return std::nullopt;
    const int minimal = setting_.full.state_space().order();
    if (order <= minimal) return std::nullopt;
    detail::Setting balanced = setting_;
    balanced.model = setting_.full;
    balanced.steps.clear();
    balanced.why =
        fmt::format("the second-order form has {} states, the minimal model {}", order, minimal);
    try {
      std::optional<detail::ReducedData> fewer = detail::by_states(balanced)->reach(accuracy);
      const bool better = fewer && fewer->states->order() <= minimal;
      return better ? std::move(fewer) : std::nullopt;
    } catch (const Error&) {  // states cannot be balanced: the structure stays
      return std::nullopt;
    }
  }

  void compile_model(const Graph& graph) {
    setting_.timed("compile", [&] {
      Options options = setting_.options;  // of states, the minimal ones are balanced
      options.minimize_up_to = std::max(options.minimize_up_to, setting_.scene.balance_up_to);
      setting_.data = detail::compile_graph(graph, options);
      setting_.model = System(setting_.data);
    });
  }

  /// The model's modes; nothing if it is no structure.
  std::unique_ptr<Reduction> read_structure(const Graph& graph) {
    try {
      return detail::by_modes(setting_, graph);
    } catch (const detail::NoStructure& error) {
      setting_.why = error.mistakes().front().message;
      return nullptr;
    }
  }

  /// Likewise, of a graph whose Lti have their oscillators as coordinates and rates; otherwise the
  /// model stays.
  std::unique_ptr<Reduction> read_oscillators(const Graph& graph) {
    const System model = setting_.model;
    const auto data = setting_.data;
    compile_model(graph);
    auto reduction = read_structure(graph);
    if (!reduction) setting_.model = model, setting_.data = data;
    return reduction;
  }

  /// The model's modes, or its states if it is no structure; nothing if these are too many and
  /// bodies can still become smaller.
  std::unique_ptr<Reduction> read(const Graph& graph) {
    if (setting_.scene.keep_structure) {
      const std::optional<Graph> same = detail::in_coordinates(graph);
      if (auto reduction = same ? read_oscillators(*same) : read_structure(graph)) return reduction;
    }
    if (setting_.model.order() <= setting_.scene.balance_up_to) return detail::by_states(setting_);
    if (setting_.smaller) refuse_states();
    return nullptr;
  }

  /// Too large for one eigenproblem: reduces the bodies first. The error is measured on the
  /// samples; if it is too large, fewer modes are dropped.
  void reduce_bodies(const Graph& graph, int count) {
    if (setting_.scene.bound == BoundKind::theorem)
      throw Error(
          Code::bad_value,
          fmt::format("{} has {} coordinates: BoundKind::theorem would need all their poles",
                      graph.name, count),
          fmt::format("raise Scene::{} (the cost grows with its cube), or use BoundKind::estimate",
                      setting_.why.empty() ? "whole_up_to" : "balance_up_to"));
    setting_.smaller = true;
    std::vector<detail::ModeEffects> effects;
    setting_.timed(
        "bodies", [&] { effects = detail::mode_effects(graph, setting_.scene, setting_.options); });
    for (double share = kShare * setting_.finest, tries = 1; true; share /= 10, ++tries) {
      const detail::SmallerBodies smaller = detail::smaller_bodies(graph, effects, share);
      setting_.bodies = fmt::format("{}", fmt::join(smaller.text, "; "));
      setting_.steps.clear();
      setting_.note_structure(count);
      const int after = count - smaller.before + smaller.after;
      if (setting_.why.empty() && after > setting_.scene.whole_up_to) refuse_size(setting_, after);
      compile_model(smaller.graph);
      const std::size_t step = setting_.note("bodies", count, after, setting_.bodies);
      reduction_ = read(smaller.graph);
      const double cost = setting_.steps[step].error = bodies_error();
      if (cost <= kMostOfBodies * setting_.finest || tries == kTries) return;
    }
  }

  /// Error of smaller bodies, on the samples.
  double bodies_error() const {
    const detail::Samples& samples = setting_.samples;
    Eigen::MatrixXd worst = Eigen::MatrixXd::Zero(samples.peak.rows(), samples.peak.cols());
    const std::vector<Eigen::MatrixXcd> H =
        detail::sample(setting_.model, setting_.scene, reduction_->spectrum(), samples.omega).H;
    for (std::size_t k = 0; k < H.size(); ++k)
      worst = worst.cwiseMax((H[k] - samples.H[k]).cwiseAbs());
    return worst.cwiseQuotient(samples.peak).maxCoeff();
  }

  [[noreturn]] void refuse_states() const {
    throw Error(Code::bad_value,
                fmt::format("{} has {} states with the fewest modes of its bodies that meet the "
                            "accuracy, more than Scene::balance_up_to = {}",
                            setting_.full.stage().graph.name, setting_.model.order(),
                            setting_.scene.balance_up_to),
                "raise it (the cost grows with its cube), lower the accuracy, narrow the band, or "
                "remove controllers and filters from the scene",
                {fmt::format("states are balanced because {}", setting_.why), setting_.bodies});
  }

  detail::Setting setting_;
  std::unique_ptr<Reduction> reduction_;
};

/// Seconds of one transfer: the least of several runs, since other load only adds time; each run is
/// long compared with the clock's resolution.
double seconds_of(const ReducedSystem& m, double omega) {
  constexpr int runs = 9, count = 50;
  double least = HUGE_VAL, sum = 0;
  for (int run = 0; run < runs; ++run) {
    const double start = now();
    for (int k = 0; k < count; ++k) sum += std::abs(m.transfer({0.01 * omega, omega + k})(0, 0));
    least = std::min(least, (now() - start) / count);
  }
  return std::isfinite(sum) ? least : 0;
}

}  // namespace

ReducedSystem detail::compile_scene(const Graph& graph, const Scene& scene, const Options& options,
                                    Order order) {
  return SceneReduction(graph, scene, options, scene.accuracy, order).reach(scene.accuracy);
}

ReducedSystem compile(const Diagram& diagram, const Scene& scene, const Options& options) {
  return detail::compile_scene(diagram.graph(), scene, options, detail::Order::nested);
}

std::vector<WhatIf> what_if(const Diagram& diagram, const Scene& scene,
                            std::span<const double> accuracies, const Options& options) {
  std::vector<Mistake> mistakes;
  for (Scene one = scene; const double accuracy : accuracies) {
    one.accuracy = accuracy;
    try {
      detail::check(one);
    } catch (const Error& error) {
      mistakes.insert(mistakes.end(), error.mistakes().begin(), error.mistakes().end());
    }
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  std::vector<WhatIf> result;
  if (accuracies.empty()) return result;
  SceneReduction reduction(diagram.graph(), scene, options,
                           *std::min_element(accuracies.begin(), accuracies.end()));
  for (const double accuracy : accuracies)
    if (const auto system = reduction.try_reach(accuracy))
      result.push_back({accuracy, system->order(), system->bound().worst,
                        seconds_of(*system, 2 * pi * std::max(1e-3, scene.band_hz[1])), *system});
  return result;
}

}  // namespace titop
