#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <titop/compiler/compile_graph.hpp>
#include <titop/compiler/economy/ray.hpp>
#include <titop/compiler/economy/reduced_data.hpp>
#include <titop/compiler/economy/sharpen.hpp>
#include <titop/compiler/economy/twins.hpp>

/// `compile` for a scene, step by step.
namespace titop {
namespace {

using detail::ReducedData;
using detail::Small;
using Eigen::Index;
using std::numbers::pi;

constexpr double kPhase = 1;  ///< step of the phase grid: a bound of 1 / cos(1 / 2) = 1.14 samples

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// All that one scene needs, for any accuracy.
class Economy {
 public:
  Economy(const Diagram& diagram, const Scene& scene, const Options& options)
      : scene_(scene), full_(nullptr) {
    detail::check(scene);
    const Graph graph = detail::restricted(diagram.graph(), scene);
    if (graph.inputs.empty() || graph.outputs.empty())
      throw Error(
          Code::bad_value,
          fmt::format("{} has no {}", graph.name, graph.inputs.empty() ? "input" : "output"),
          "a scene asks from inputs to outputs: give the diagram both");
    timed("compile", [&] {
      data_ = detail::compile_graph(graph, options);
      full_ = System(data_);
    });
    timed("modes", [&] {
      detail::Coordinates c = detail::coordinates(full_, *data_);
      note("structure", coordinates_of(diagram), c.size(),
           "what the scene's inputs reach and its outputs see, without tied coordinates");
      const Index before = c.size();
      const detail::Twins twins = detail::join_twins(c, data_->graph());
      if (twins.removed > 0)
        note("symmetry", before, c.size(),
             fmt::format("{} move alike", fmt::join(twins.pairs, "; ")));
      if (c.size() > scene.whole_up_to)
        throw Error(Code::bad_value,
                    fmt::format("{} has {} coordinates, more than Scene::whole_up_to = {}",
                                graph.name, c.size(), scene.whole_up_to),
                    "raise it (the cost grows with its cube), or give bodies fewer modes and "
                    "residual vectors at the points that carry load (fe::ModeOptions)");
      whole_ = detail::whole(full_, c, detail::positions_read(graph));
      band_ = detail::band_of(full_, scene, whole_);
      detail::sharpen(whole_, full_, 1.2 * band_.high);
      if (scene.bound == BoundKind::theorem) detail::couple(whole_);
    });
    timed("samples", [&] {
      samples_ = detail::sample(full_, scene, whole_,
                                detail::sample_points(scene, band_, whole_, {}, kPhase));
    });
    sequence_ = std::make_unique<detail::Sequence>(whole_, samples_, band_.high);
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
    const std::optional<std::size_t> found = first_within(accuracy);
    if (!found) return std::nullopt;
    const std::size_t step = *found;
    ReducedData d{full_, sequence_->model(step), bounds_.at(step), steps_, {}, seconds_};
    d.steps.push_back({"whole", static_cast<int>(whole_.order() + whole_.far),
                       static_cast<int>(d.small.order()), d.bound.worst,
                       "modes of the band, and static-like vectors of those above it"});
    d.modes = modes(d.small);
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

  void note(const char* name, Index before, Index after, std::string text) {
    steps_.push_back({name, static_cast<int>(before), static_cast<int>(after), 0, std::move(text)});
  }

  static int coordinates_of(const Diagram& diagram) {
    int states = 0;
    for (const Node& n : diagram.graph().nodes)
      states += static_cast<int>(n.block->interface().states.size());
    return (states + 1) / 2;
  }

  const ErrorBound& bound_of(std::size_t step) {
    const auto found = bounds_.find(step);
    if (found != bounds_.end()) return found->second;
    return bounds_.emplace(step, bound(sequence_->model(step))).first->second;
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
        fmt::format("ask for {:.0e}, or use compile(diagram): rounding in the modes of the "
                    "whole ends there",
                    2 * b.worst),
        {fmt::format("most of what is missing moves in {}", where_missing(best, b))});
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

  ErrorBound bound(const Small& small) const {
    const auto points = detail::sample_points(scene_, band_, whole_, small.poles(), kPhase);
    const detail::Samples check = detail::sample(full_, scene_, whole_, points);
    ErrorBound b;
    b.kind = scene_.bound;
    b.samples = static_cast<int>(points.size() + samples_.s.size());
    b.pairs = Eigen::MatrixXd::Zero(check.peak.rows(), check.peak.cols());
    double worst = -1;
    for (std::size_t k = 0; k < check.s.size(); ++k) {
      const Eigen::MatrixXd e =
          detail::difference(check, small, k).cwiseAbs().cwiseQuotient(check.peak);
      b.pairs = b.pairs.cwiseMax(e);
      Index i = 0, j = 0;
      if (const double here = e.maxCoeff(&i, &j); !(here <= worst)) {
        worst = here;
        b.output = full_.outputs()[at(i)];
        b.input = full_.inputs()[at(j)];
        b.hertz = check.omega[k] / (2 * pi);
      }
    }
    b.peak = check.peak;
    b.pairs = b.pairs / std::cos(kPhase / 2) + detail::rounding(whole_, check);
    b.worst = b.pairs.maxCoeff();
    return b;
  }

  std::vector<KeptMode> modes(const Small& m) const {
    std::vector<KeptMode> result;
    const Eigen::MatrixXd shares = detail::participation(whole_, m.V);
    for (Index j = 0; j < m.order(); ++j) {
      KeptMode mode;
      const double omega = std::sqrt(m.k(j));
      mode.hertz = omega / (2 * pi);
      if (m.Z.size() > 0 && omega > 0) mode.damping = m.Z(j, j) / (2 * omega);
      mode.exact = m.V.col(j).cwiseAbs().maxCoeff() == 1;
      for (Index i = 0; i < shares.rows(); ++i)
        if (shares(i, j) >= 0.05) mode.blocks.emplace_back(whole_.blocks[at(i)], shares(i, j));
      std::stable_sort(mode.blocks.begin(), mode.blocks.end(),
                       [](const auto& a, const auto& b) { return a.second > b.second; });
      result.push_back(std::move(mode));
    }
    return result;
  }

  Scene scene_;
  std::shared_ptr<const detail::SystemData> data_;
  System full_;
  detail::Whole whole_;
  detail::Band band_;
  detail::Samples samples_;
  std::unique_ptr<detail::Sequence> sequence_;
  std::map<std::size_t, ErrorBound> bounds_;  ///< by step of the sequence, as far as asked for
  std::vector<EconomyStep> steps_;
  std::vector<std::pair<std::string, double>> seconds_;
};

/// Seconds of one transfer, over enough of them to be told from the clock's own step.
double seconds_of(const ReducedSystem& m, double omega) {
  constexpr int count = 200;
  const double start = now();
  double sum = 0;
  for (int k = 0; k < count; ++k) sum += std::abs(m.transfer({0.01 * omega, omega + k})(0, 0));
  return std::isfinite(sum) ? (now() - start) / count : 0;
}

}  // namespace

ReducedSystem compile(const Diagram& diagram, const Scene& scene, const Options& options) {
  return Economy(diagram, scene, options).reach(scene.accuracy);
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
  Economy economy(diagram, scene, options);
  std::vector<WhatIf> result;
  for (const double accuracy : accuracies)
    if (const auto system = economy.try_reach(accuracy))
      result.push_back({accuracy, system->order(), system->bound().worst,
                        seconds_of(*system, 2 * pi * std::max(1e-3, scene.band_hz[1])), *system});
  return result;
}

}  // namespace titop
