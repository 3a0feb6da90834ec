#include <fmt/format.h>

#include <titop/analysis/reduction/reduction.hpp>

namespace titop::detail {

std::size_t Setting::note(const char* name, Eigen::Index before, Eigen::Index after,
                          std::string text) {
  steps.push_back({name, static_cast<int>(before), static_cast<int>(after), 0, std::move(text)});
  return steps.size() - 1;
}

void Setting::note_structure(Eigen::Index after) {
  if (steps.empty())
    note("structure", (states + 1) / 2, after,
         "reachable from the scene's inputs and observable at its outputs, without dependent "
         "coordinates");
}

void Setting::take_samples(const SampledSpectrum& spectrum) {
  timed("samples", [&] {
    samples = sample(full, scene, spectrum, sample_points(scene, band, spectrum, {}, kPhase));
  });
}

ErrorBound Setting::bound(const SampledSpectrum& spectrum,
                          const std::vector<std::complex<double>>& poles,
                          const TransferOf& transfer) const {
  ErrorBound b = error_bound(full, scene, band, spectrum, poles, transfer);
  b.samples += static_cast<int>(samples.s.size());
  return b;
}

ReducedData Setting::result(Small small, ErrorBound error) const {
  return {scene, full, std::move(small), std::move(error), notes, steps, {}, seconds, {}};
}

std::string Setting::way_out(double reached, const char* limit, const char* rounding_in) const {
  const std::string less = 2 * reached < 1 ? fmt::format("ask for {:.0e}, or ", 2 * reached) : "";
  return less + (!bodies.empty()
                     ? fmt::format(
                           "raise Scene::{}: bodies with fewer modes reach no smaller error", limit)
                     : fmt::format("use compile(diagram): rounding in {} limits the accuracy",
                                   rounding_in));
}

void refuse_size(const Setting& setting, Eigen::Index size) {
  throw Error(Code::bad_value,
              fmt::format("{} has {} coordinates{}, more than Scene::whole_up_to = {}",
                          setting.full.stage().graph.name, size,
                          setting.bodies.empty()
                              ? ""
                              : " with the fewest modes of its bodies that meet the accuracy",
                          setting.scene.whole_up_to),
              "raise it (the cost grows with its cube), lower the accuracy or narrow the band",
              setting.bodies.empty() ? std::vector<std::string>{} : std::vector{setting.bodies});
}

}  // namespace titop::detail
