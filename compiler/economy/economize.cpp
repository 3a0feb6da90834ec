#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <titop/compiler/compile_graph.hpp>
#include <titop/compiler/economy/balanced.hpp>
#include <titop/compiler/economy/bodies.hpp>
#include <titop/compiler/economy/bound.hpp>
#include <titop/compiler/economy/ray.hpp>
#include <titop/compiler/economy/reduced_data.hpp>
#include <titop/compiler/economy/sharpen.hpp>
#include <titop/compiler/economy/twins.hpp>

/// `compile` for a scene, step by step.
namespace titop {
namespace {

using detail::kPhase;
using detail::ReducedData;
using detail::Small;
using Eigen::Index;
using std::numbers::pi;

constexpr double kShare = 0.1;         ///< of the accuracy: sum of effects of what bodies lose
constexpr double kMostOfBodies = 0.3;  ///< of the accuracy: what that may cost
constexpr int kTries = 4;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// All that one scene needs, for any accuracy.
class Economy {
 public:
  /// `finest`: of the accuracies that will be asked for.
  Economy(const Diagram& diagram, const Scene& scene, const Options& options, double finest)
      : scene_(scene), options_(options), finest_(finest), full_(nullptr), model_(nullptr) {
    detail::check(scene);
    const Graph graph = detail::restricted(diagram.graph(), scene);
    if (graph.inputs.empty() || graph.outputs.empty())
      throw Error(
          Code::bad_value,
          fmt::format("{} has no {}", graph.name, graph.inputs.empty() ? "input" : "output"),
          "a scene asks from inputs to outputs: give the diagram both");
    timed("compile", [&] {
      data_ = detail::compile_graph(graph, options);
      full_ = model_ = System(data_);
    });
    before_ = states_of(diagram);
    if (const int count = (full_.order() + 1) / 2; count <= scene.whole_up_to)
      read(graph);
    else
      reduce_bodies(graph, count);
    if (!balanced_) sequence_ = std::make_unique<detail::Sequence>(whole_, samples_, band_.high);
  }

  Economy(const Economy&) = delete;  // the sequence refers to what is here
  Economy& operator=(const Economy&) = delete;

  /// The first model of the sequence whose bound is at most this.
  ReducedSystem reach(double accuracy) {
    std::optional<ReducedSystem> system = try_reach(accuracy);
    if (!system) refuse(accuracy);
    return *std::move(system);
  }

  /// The same; none if rounding ends first.
  std::optional<ReducedSystem> try_reach(double accuracy) {
    const double start = now();
    if (balanced_) return try_balanced(accuracy);
    const std::optional<std::size_t> found = first_within(accuracy);
    if (!found) return std::nullopt;
    const std::size_t step = *found;
    ReducedData d{full_, sequence_->model(step), bounds_.at(step), steps_, {}, seconds_};
    d.steps.push_back({"whole", static_cast<int>(whole_.order() + whole_.far),
                       static_cast<int>(d.small.order()), d.bound.worst,
                       "modes of the band, and static-like vectors of those above it"});
    d.modes = detail::kept_modes(whole_, d.small);
    d.seconds.emplace_back("reduce", now() - start);
    return ReducedSystem(std::make_shared<const ReducedData>(std::move(d)));
  }

 private:
  template <class F>
  void timed(const char* name, F f) {
    const double start = now();
    f();
    seconds_.emplace_back(name, now() - start);
  }

  /// What model_ is made of: modes, or states where it is no structure.
  void read(const Graph& graph) {
    try {
      if (!scene_.keep_structure)
        throw detail::NoStructure(Code::bad_value, "the scene asks for balanced states", "");
      read_modes(graph);
    } catch (const detail::NoStructure& error) {
      why_ = error.mistakes().front().message;
      read_states(graph);
    }
  }

  /// Its dense model, told apart, and the full system's transfers as below.
  void read_states(const Graph& graph) {
    if (model_.order() > scene_.balance_up_to) {
      if (smaller_) refuse_states();
      return reduce_bodies(graph, (full_.order() + 1) / 2);
    }
    timed("split", [&] {
      before_ = std::max(before_, model_.order());  // what integrates positions is no block's
      if (steps_.empty()) note_structure((model_.order() + 1) / 2);
      model_.write(dense_);
      split_ = detail::split(dense_);
      band_ = detail::band_of(full_, scene_, split_.poles, split_.integrals);
    });
    take_samples();
    timed("balance", [&] {
      balanced_ = std::make_unique<detail::Balanced>(dense_, split_, samples_, band_.high);
    });
  }

  detail::Spectrum spectrum() const {
    return why_.empty() ? detail::Spectrum(whole_) : detail::Spectrum(dense_, split_);
  }

  /// The full system's transfers where it and what takes its place can have peaks.
  void take_samples() {
    timed("samples", [&] {
      samples_ = detail::sample(full_, scene_, spectrum(),
                                detail::sample_points(scene_, band_, spectrum(), {}, kPhase));
    });
  }

  /// Modes of the whole of model_.
  void read_modes(const Graph& graph) {
    timed("modes", [&] {
      detail::Coordinates c = detail::coordinates(model_, *data_);
      if (steps_.empty()) note_structure(c.size());
      const Index before = c.size();
      const detail::Twins twins = detail::join_twins(c, data_->graph());
      if (twins.removed > 0)
        note("symmetry", before, c.size(),
             fmt::format("{} move alike", fmt::join(twins.pairs, "; ")));
      if (c.size() > scene_.whole_up_to) refuse_size(c.size());
      whole_ = detail::whole(model_, c, detail::positions_read(graph));
      band_ = detail::band_of(model_, scene_, whole_);
      detail::sharpen(whole_, model_, 1.2 * band_.high);
      if (scene_.bound == BoundKind::theorem) detail::couple(whole_);
    });
    take_samples();
  }

  /// Too large for one eigenproblem: bodies first. What that costs is measured on the samples, and
  /// where it is too much less goes.
  void reduce_bodies(const Graph& graph, int count) {
    if (scene_.bound == BoundKind::theorem)
      throw Error(Code::bad_value,
                  fmt::format("{} has {} coordinates, and a theorem counts every pole of theirs",
                              graph.name, count),
                  fmt::format("raise Scene::{} (the cost grows with its cube), or take an estimate",
                              why_.empty() ? "whole_up_to" : "balance_up_to"));
    smaller_ = true;
    std::vector<detail::ModeEffects> effects;
    timed("bodies", [&] { effects = detail::mode_effects(graph, scene_, options_); });
    for (double share = kShare * finest_, tries = 1; true; share /= 10, ++tries) {
      const detail::SmallerBodies smaller = detail::smaller_bodies(graph, effects, share);
      bodies_ = fmt::format("{}", fmt::join(smaller.text, "; "));
      steps_.clear();
      note_structure(count);
      const int after = count - smaller.before + smaller.after;
      if (why_.empty() && after > scene_.whole_up_to) refuse_size(after);
      timed("compile", [&] {
        data_ = detail::compile_graph(smaller.graph, options_);
        model_ = System(data_);
      });
      note("bodies", count, after, bodies_);
      const std::size_t step = steps_.size() - 1;
      read(smaller.graph);
      steps_[step].error = bodies_error();
      if (steps_[step].error <= kMostOfBodies * finest_ || tries == kTries) return;
    }
  }

  /// What smaller bodies cost, on the samples.
  double bodies_error() const {
    Eigen::MatrixXd worst = Eigen::MatrixXd::Zero(samples_.peak.rows(), samples_.peak.cols());
    const std::vector<Eigen::MatrixXcd> H =
        detail::sample(model_, scene_, spectrum(), samples_.omega).H;
    for (std::size_t k = 0; k < H.size(); ++k)
      worst = worst.cwiseMax((H[k] - samples_.H[k]).cwiseAbs());
    return worst.cwiseQuotient(samples_.peak).maxCoeff();
  }

  /// The first balanced model whose bound is at most this.
  std::optional<ReducedSystem> try_balanced(double accuracy) {
    const double start = now();
    for (Index from = 0;;) {
      const auto choice = balanced_->find(from, accuracy * std::cos(kPhase / 2));
      if (!choice) return std::nullopt;
      detail::States model = balanced_->model(*choice);
      ErrorBound b = bound(*choice, model);
      from = choice->order + 1;
      if (!(b.worst <= accuracy)) continue;
      ReducedData d{full_, {}, std::move(b), steps_, {}, seconds_};
      note_balanced(d, *choice);
      d.modes = model.modes(dense_.states);
      d.seconds.emplace_back("reduce", now() - start);
      model.why = why_;
      d.states = std::move(model);
      return ReducedSystem(std::make_shared<const ReducedData>(std::move(d)));
    }
  }

  ErrorBound bound(const detail::Balanced::Choice& choice, const detail::States& model) const {
    ErrorBound b = bound(model.poles(), [&](std::complex<double> s) { return model.transfer(s); });
    if (const Eigen::MatrixXd any = balanced_->anywhere(choice); any.size() > 0 && !smaller_)
      b.anywhere = any.cwiseQuotient(b.peak).maxCoeff();
    return b;
  }

  /// What was kept, and how the rest was cut.
  void note_balanced(ReducedData& d, const detail::Balanced::Choice& choice) const {
    const Index integrals = balanced_->integrals(), kept = balanced_->kept();
    const auto count = [](Index n) { return static_cast<int>(n); };
    d.steps.push_back(
        {"kept", dense_.order(), count(integrals + kept + balanced_->stable()), 0,
         fmt::format(
             "no M, D, K, for {}; whole are {} integrals and {} states of poles on the axis "
             "or right of it ({} unstable), {} more neither move nor are seen",
             why_, integrals, kept, balanced_->unstable(), balanced_->silent())});
    d.steps.push_back(
        {"balanced", count(balanced_->stable()), count(choice.order), d.bound.worst,
         fmt::format("{}, {}: the least error at the least order that does",
                     choice.weighted ? "balanced behind low-passes at the band's end (no bound "
                                       "beforehand)"
                                     : "balanced over the whole axis",
                     choice.truncated ? "truncated (exact at infinite frequency)"
                                      : "the others at rest (exact at 0 Hz)")});
  }

  [[noreturn]] void refuse_balanced(double accuracy) const {
    const auto best = balanced_->best();
    const detail::States model = balanced_->model(best);
    const ErrorBound b = bound(best, model);
    throw Error(
        Code::bad_value,
        fmt::format(
            "an accuracy of {:.1e} cannot be met: {:.1e} is reached with {} states, from {} "
            "to {} at {:.4g} Hz",
            accuracy, b.worst, model.order(), b.input, b.output, b.hertz),
        fmt::format("ask for {:.0e}, or {} ends there", 2 * b.worst,
                    smaller_ ? "raise Scene::balance_up_to: what smaller bodies can do"
                             : "use compile(diagram): rounding in the balanced states"),
        {fmt::format("states are balanced because {}", why_)});
  }

  [[noreturn]] void refuse_states() const {
    throw Error(Code::bad_value,
                fmt::format("{} has {} states where its bodies have the fewest that do, more than "
                            "Scene::balance_up_to = {}",
                            full_.stage().graph.name, model_.order(), scene_.balance_up_to),
                "raise it (the cost grows with its cube), ask for less accuracy or a smaller band, "
                "or take what is no structure out of the scene",
                {fmt::format("states are balanced because {}", why_), bodies_});
  }

  [[noreturn]] void refuse_size(Index size) const {
    throw Error(Code::bad_value,
                fmt::format("{} has {} coordinates{}, more than Scene::whole_up_to = {}",
                            full_.stage().graph.name, size,
                            bodies_.empty() ? "" : " where its bodies have the fewest that do",
                            scene_.whole_up_to),
                "raise it (the cost grows with its cube), ask for less accuracy or a smaller band",
                bodies_.empty() ? std::vector<std::string>{} : std::vector{bodies_});
  }

  void note_structure(Index after) {
    note("structure", (before_ + 1) / 2, after,
         "what the scene's inputs reach and its outputs see, without tied coordinates");
  }

  void note(const char* name, Index before, Index after, std::string text) {
    steps_.push_back({name, static_cast<int>(before), static_cast<int>(after), 0, std::move(text)});
  }

  static int states_of(const Diagram& diagram) {
    int states = 0;
    for (const Node& n : diagram.graph().nodes)
      states += static_cast<int>(n.block->interface().states.size());
    return states;
  }

  const ErrorBound& bound_of(std::size_t step) {
    const auto found = bounds_.find(step);
    if (found != bounds_.end()) return found->second;
    const Small small = sequence_->model(step);
    return bounds_
        .emplace(step,
                 bound(small.poles(), [&](std::complex<double> s) { return small.transfer(s); }))
        .first->second;
  }

  /// The bound costs more than the error on the samples, which goes first.
  std::optional<std::size_t> first_within(double accuracy) {
    const double target = accuracy * std::cos(kPhase / 2);
    for (std::size_t k = 0; true; ++k) {
      const auto& steps = sequence_->steps();
      if (k == steps.size() && !sequence_->grow()) return std::nullopt;
      if (steps[k].error <= target && bound_of(k).worst <= accuracy) return k;
    }
  }

  [[noreturn]] void refuse(double accuracy) {
    if (balanced_) refuse_balanced(accuracy);
    const auto& steps = sequence_->steps();
    std::size_t best = 0;
    for (std::size_t k = 1; k < steps.size(); ++k)
      if (steps[k].error < steps[best].error) best = k;
    const ErrorBound& b = bound_of(best);
    throw Error(
        Code::bad_value,
        fmt::format("an accuracy of {:.1e} cannot be met: {:.1e} is reached with {} "
                    "coordinates, from {} to {} at {:.4g} Hz",
                    accuracy, b.worst, sequence_->model(best).order(), b.input, b.output, b.hertz),
        fmt::format("ask for {:.0e}, or {} ends there", 2 * b.worst,
                    bodies_.empty() ? "use compile(diagram): rounding in the modes of the whole"
                                    : "raise Scene::whole_up_to: what smaller bodies can do"),
        {fmt::format("most of what is missing moves in {}{}", where_missing(best, b),
                     bodies_.empty() ? "" : "; " + bodies_)});
  }

  /// The block with the largest part of the elastic energy of what the model leaves out there.
  std::string where_missing(std::size_t step, const ErrorBound& b) const {
    const Small small = sequence_->model(step);
    const std::complex<double> s = detail::on_ray(scene_, 2 * pi * b.hertz);
    const auto& names = full_.inputs();
    const Index m = std::find(names.begin(), names.end(), b.input) - names.begin();
    Eigen::VectorXcd left = -(small.V * small.response(s, m));
    for (Index j = 0; j < whole_.elastic(); ++j)
      left(j) += whole_.b(j, m) / (s * (s + whole_.damping(j)) + whole_.lambda(j));
    Index block = 0;
    const Eigen::MatrixXd parts = detail::participation(whole_, left.real());
    if (whole_.blocks.empty()) return "no block";
    const double share = parts.col(0).maxCoeff(&block);
    return fmt::format("{} ({:.0f} %)", whole_.blocks[at(block)], 100 * share);
  }

  /// Of a model with these poles and this transfer.
  ErrorBound bound(const std::vector<std::complex<double>>& poles,
                   const detail::TransferOf& transfer) const {
    ErrorBound b = detail::error_bound(full_, scene_, band_, spectrum(), poles, transfer);
    b.samples += static_cast<int>(samples_.s.size());
    return b;
  }

  Scene scene_;
  Options options_;
  double finest_ = 0;
  int before_ = 0;        ///< states of all blocks
  bool smaller_ = false;  ///< bodies lose modes first
  std::string why_;       ///< model_ is no structure; empty: it is
  StateSpace dense_;      ///< model_, where it is no structure
  detail::Split split_;   ///< of model_, where it is no structure
  std::unique_ptr<detail::Balanced> balanced_;
  std::string bodies_;   ///< what became of them; empty: they are as they were
  System full_, model_;  ///< as asked, and with smaller bodies; the same where these are not needed
  std::shared_ptr<const detail::SystemData> data_;  ///< of model_
  detail::Whole whole_;
  detail::Band band_;
  detail::Samples samples_;
  std::unique_ptr<detail::Sequence> sequence_;
  std::map<std::size_t, ErrorBound> bounds_;  ///< by step of the sequence, as far as asked for
  std::vector<EconomyStep> steps_;
  std::vector<std::pair<std::string, double>> seconds_;
};

/// Seconds of one transfer: the least of several runs, for what else the machine does only adds;
/// each over enough of them to be told from the clock's own step.
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

ReducedSystem compile(const Diagram& diagram, const Scene& scene, const Options& options) {
  return Economy(diagram, scene, options, scene.accuracy).reach(scene.accuracy);
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
  Economy economy(diagram, scene, options, *std::min_element(accuracies.begin(), accuracies.end()));
  for (const double accuracy : accuracies)
    if (const auto system = economy.try_reach(accuracy))
      result.push_back({accuracy, system->order(), system->bound().worst,
                        seconds_of(*system, 2 * pi * std::max(1e-3, scene.band_hz[1])), *system});
  return result;
}

}  // namespace titop
