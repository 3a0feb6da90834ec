#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <titop/analysis/reduction/ray.hpp>

/// Where a scene's band begins and ends; outputs without a gain at 0.
namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kGrows = 1.5;   ///< per octave: between 1, a gain at 0, and 2, a pole at 0
constexpr double kOfPeak = 0.5;  ///< of the peak: no rounding in a pair that is 0

[[noreturn]] void refuse_integral(const System& system, const char* subject, Index output,
                                  Index input) {
  throw Error(
      Code::bad_value,
      fmt::format("{} reads {} that {} drives: it has no gain at 0 Hz, where the scene's "
                  "band starts",
                  system.outputs()[static_cast<std::size_t>(output)], subject,
                  system.inputs()[static_cast<std::size_t>(input)]),
      "start Scene::band_hz above 0, read an acceleration instead, or leave this output out");
}

/// A band from 0 has no place for outputs that grow without end there.
void refuse_integrals(const System& system, const Whole& w) {
  for (Index j = w.elastic(); j < w.order(); ++j) {
    Index m = 0;
    if (w.b.row(j).cwiseAbs().maxCoeff(&m) == 0) continue;
    for (Index i = 0; i < w.ca.rows(); ++i)
      if (w.cq(i, j) != 0 || w.cv(i, j) != 0)
        refuse_integral(system,
                        w.cq(i, j) != 0 ? "the position of a motion without stiffness"
                                        : "the rate of a motion without stiffness",
                        i, m);
  }
}

/// False if a pole at 0, though without effect, hides the gain of a system that is too large to be
/// minimized.
bool has_gain(const System& system) try {
  system.static_gain();
  return true;
} catch (const Error& error) {
  if (!error.has(Code::singular)) throw;
  return false;
}

}  // namespace

double start_of(const std::vector<Complex>& poles, double high) {
  double lowest = high > 0 ? high : 1;
  for (const Complex& p : poles)
    if (p != 0.0 && std::abs(p) < lowest) lowest = std::abs(p);
  return kStart * lowest;
}

Band band_of(const System& system, const Scene& scene, const Whole& w) {
  Band band{2 * std::numbers::pi * scene.band_hz[0], 2 * std::numbers::pi * scene.band_hz[1], 0};
  if (band.low > 0 || w.loose == 0) return band;
  if (!w.loose_coupled) refuse_integrals(system, w);  // else by samples: refuse_growing
  band.start = start_of(SampledSpectrum(w).poles, band.high);
  return band;
}

Band band_of(const System& system, const Scene& scene, const std::vector<Complex>& poles,
             const SpectralPart& integrals) {
  Band band{2 * std::numbers::pi * scene.band_hz[0], 2 * std::numbers::pi * scene.band_hz[1], 0};
  const bool integral = std::find(poles.begin(), poles.end(), 0.0) != poles.end();
  if (band.low > 0 || (!integral && has_gain(system))) return band;
  const MatrixXd one = integrals.C * integrals.B,
                 size = integrals.C.cwiseAbs() * integrals.B.cwiseAbs(),
                 two = integrals.C * integrals.A * integrals.B;
  for (Index i = 0; i < one.rows(); ++i)
    for (Index m = 0; m < one.cols(); ++m)
      if (std::abs(one(i, m)) > kNothing * size(i, m) || two(i, m) != 0)
        refuse_integral(system, "an integral", i, m);
  band.start = start_of(poles, band.high);
  return band;
}

void refuse_growing(const System& system, const Scene& scene, const Band& band,
                    const Samples& samples) {
  if (band.low > 0 || band.start == 0) return;
  const MatrixXd here = samples.H.front().cwiseAbs(),
                 next = system.transfer(on_ray(scene, 2 * band.start)).cwiseAbs();
  for (Index i = 0; i < here.rows(); ++i)
    for (Index m = 0; m < here.cols(); ++m)
      if (here(i, m) > kOfPeak * samples.peak(i, m) && here(i, m) > kGrows * next(i, m))
        refuse_integral(system, "an integral", i, m);
}

}  // namespace titop::detail
