#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <titop/analysis/reduction/bound.hpp>
#include <titop/analysis/reduction/reduced_data.hpp>

/// The two methods of reduction. For the library's own files only.
namespace titop::detail {

/// Seconds on a monotonic clock.
inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Coordinates of a model in second order: those of one sequence, so that more accuracy never gives
/// a smaller order; or without those that can be spared.
enum class Order { nested, least };

/// State of a reduction, common to all methods: the scene, the compiled model, and the results so
/// far.
struct Setting {
  Setting(const Scene& asked, const Options& how, double least_accuracy, int of_blocks)
      : scene(asked), options(how), finest(least_accuracy), states(of_blocks) {}

  Scene scene;
  Options options;
  double finest;          ///< smallest accuracy that will be required
  int states;             ///< of all blocks
  System full{nullptr};   ///< as in the scene
  System model{nullptr};  ///< with smaller bodies; the same if these are not needed
  std::shared_ptr<const SystemData> data;  ///< of `model`
  Order order = Order::nested;
  bool smaller = false;  ///< bodies have lost modes first, if they had any
  std::string bodies;    ///< which ones; empty: none
  std::string why;       ///< `model` is no structure; empty: it is
  Band band;
  Samples samples;  ///< the full system's transfers where it or `model` can have peaks
  std::vector<Note> notes;
  std::vector<ReductionStep> steps;
  std::vector<std::pair<std::string, double>> seconds;

  template <class F>
  void timed(const char* name, F f) {
    const double start = now();
    f();
    seconds.emplace_back(name, now() - start);
  }
  /// Returns its place in `steps`.
  std::size_t note(const char* name, Eigen::Index before, Eigen::Index after, std::string text);
  /// The first of all steps, down to so many coordinates; once.
  void note_structure(Eigen::Index after);
  /// Fills `samples` for a model with this spectrum.
  void take_samples(const SampledSpectrum& spectrum);
  /// Bound for a reduced model with these poles and this transfer, and a whole with this spectrum.
  ErrorBound bound(const SampledSpectrum& spectrum, const std::vector<std::complex<double>>& poles,
                   const TransferOf& transfer) const;
  /// The results so far, with this model; `modes` are filled later.
  ReducedData result(Small small, ErrorBound bound) const;
  /// Way out for an accuracy that cannot be met; `limit`: the member of Scene to raise if bodies
  /// have lost modes; `rounding_in`: otherwise, the computation that rounding limits.
  std::string way_out(double reached, const char* limit, const char* rounding_in) const;
};

/// `Setting::model`, ready to be reduced to any accuracy: a better model has no smaller order.
class Reduction {
 public:
  virtual ~Reduction() = default;
  virtual SampledSpectrum spectrum() const = 0;
  /// The smallest model whose bound is at most this; none if rounding prevents it.
  virtual std::optional<ReducedData> reach(double accuracy) = 0;
  /// Throws bad_value: the accuracy that can be met, and the obstacle.
  [[noreturn]] virtual void refuse(double accuracy) = 0;
};

/// Modes of the whole and static-like vectors, in second order, of the setting's model, which was
/// compiled from this graph. Fills `band` and `samples`, adds to `steps` and `seconds`. Throws
/// NoStructure if there is no M, D, K; bad_value for more coordinates than Scene::whole_up_to, and
/// the errors of band_of.
std::unique_ptr<Reduction> by_modes(Setting& setting, const Graph& graph);

/// Balanced states, if there is no structure. Fills `band` and `samples`, adds to `steps` and
/// `seconds`, and to `states` those that integrate positions. Throws the errors of `split` and
/// band_of.
std::unique_ptr<Reduction> by_states(Setting& setting);

/// Throws bad_value: `size` coordinates are more than Scene::whole_up_to.
[[noreturn]] void refuse_size(const Setting& setting, Eigen::Index size);

}  // namespace titop::detail
