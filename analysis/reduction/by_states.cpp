#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/reduction/balanced.hpp>
#include <titop/analysis/reduction/reduction.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;

class ByStates : public Reduction {
 public:
  explicit ByStates(Setting& setting) : setting_(setting) {
    setting_.timed("split", [&] {
      setting_.states =
          std::max(setting_.states, setting_.model.order());  // integrals of positions
      setting_.note_structure((setting_.model.order() + 1) / 2);
      dense_ = setting_.model.state_space();
      split_ = split(dense_);
      StateSpace written;
      setting_.model.write(written);
      split_.reading = split_.reading.cwiseMax(reading(written));
      setting_.band = band_of(setting_.full, setting_.scene, split_.poles, split_.integrals);
    });
    setting_.take_samples(spectrum());
    refuse_growing(setting_.full, setting_.scene, setting_.band, setting_.samples);
  }

  SampledSpectrum spectrum() const override { return {dense_, split_}; }

  std::optional<ReducedData> reach(double accuracy) override {
    const Balanced& sequence = balanced();
    const double start = now();
    for (Index from = 0;;) {
      const auto choice = sequence.find(from, accuracy * std::cos(kPhase / 2));
      if (!choice) return std::nullopt;
      States model = sequence.model(*choice);
      ErrorBound b = bound(*choice, model);
      from = choice->order + 1;
      if (!(b.worst <= accuracy)) continue;
      ReducedData d = setting_.result({}, std::move(b));
      note(d, *choice);
      d.modes = model.modes(dense_.states);
      d.seconds.emplace_back("reduce", now() - start);
      model.why = setting_.why;
      d.states = std::move(model);
      return d;
    }
  }

  [[noreturn]] void refuse(double accuracy) override {
    const Balanced::Choice best = balanced().best();
    const States model = balanced().model(best);
    const ErrorBound b = bound(best, model);
    throw Error(
        Code::bad_value,
        fmt::format("an accuracy of {:.1e} cannot be met: {:.1e} is reached with {} states, from "
                    "{} to {} at {:.4g} Hz",
                    accuracy, b.worst, model.order(), b.input, b.output, b.hertz),
        setting_.way_out(b.worst, "balance_up_to", "the balanced states"),
        {fmt::format("states are balanced because {}", setting_.why)});
  }

 private:
  /// Begun at the first call: if bodies lose modes, only for the last of several tries.
  const Balanced& balanced() {
    if (!balanced_)
      setting_.timed("balance", [&] {
        balanced_.emplace(dense_, split_, setting_.samples, setting_.band.high);
      });
    return *balanced_;
  }

  ErrorBound bound(const Balanced::Choice& choice, const States& model) {
    ErrorBound b = setting_.bound(spectrum(), model.poles(),
                                  [&](std::complex<double> s) { return model.transfer(s); });
    if (const Eigen::MatrixXd any = balanced().anywhere(choice); any.size() && !setting_.smaller)
      b.anywhere = any.cwiseQuotient(b.peak).maxCoeff();
    return b;
  }

  /// Notes the kept states and the reduction of the others.
  void note(ReducedData& d, const Balanced::Choice& choice) {
    const Balanced& from = balanced();
    const auto count = [](Index n) { return static_cast<int>(n); };
    d.steps.push_back(
        {"kept", setting_.model.order(), count(from.integrals() + from.kept() + from.stable()), 0,
         fmt::format(
             "no M, D, K, because {}; kept whole: {} integrals and {} states of poles on the axis "
             "or right of it ({} unstable){}; {} more are unreachable or unobservable",
             setting_.why, from.integrals(), from.kept(), from.unstable(),
             split_.near > kUndamped ? fmt::format(", with those up to a damping ratio of {:.0e} "
                                                   "that cannot be separated from them",
                                                   split_.near)
                                     : "",
             from.silent())});
    d.steps.push_back(
        {"balanced", count(from.stable()), count(choice.order), d.bound.worst,
         fmt::format("{}, {}: the least error at the least sufficient order",
                     choice.weighted ? "balanced behind low-passes at the band's end (no bound "
                                       "beforehand)"
                                     : "balanced over the whole axis",
                     choice.truncated ? "truncated (exact at infinite frequency)"
                                      : "singular perturbation (exact at 0 Hz)")});
  }

  Setting& setting_;
  StateSpace dense_;
  Split split_;
  std::optional<Balanced> balanced_;
};

}  // namespace

std::unique_ptr<Reduction> by_states(Setting& setting) {
  return std::make_unique<ByStates>(setting);
}

}  // namespace titop::detail
