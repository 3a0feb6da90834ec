// Margins of fifty textbook and two hundred random loops, of thirty pairs of loops at once, and
// norms of forty random models, against Octave's control package.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <titop/analysis/norms/h2.hpp>
#include <titop/analysis/norms/hinf.hpp>

#include "control/grid_margins.hpp"
#include "control/transfer_functions.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;

namespace {

// Its norm (..., Inf) may miss a narrow peak: then its own gain at our frequency is above it.
constexpr const char* kFunctions = R"(pkg load control
1;
function near (name, a, b)
  if ! (isequal (a, b) || abs (a - b) <= 1e-6 * abs (b))
    error ("%s: %.17g in Octave, %.17g", name, a, b);
  end
end
function n = gain_at (sys, w)
  if isinf (w) n = norm (ss (sys).d); else n = norm (freqresp (sys, w)); end
end
function n = peak (sys, w)
  n = max (norm (sys, Inf, 1e-10), gain_at (sys, w));
end
)";

std::string number(double x) { return std::isinf(x) ? "Inf" : fmt::format("{:.17g}", x); }

std::string matrix(const MatrixXd& M) {
  std::string text = "reshape ([";
  for (Index i = 0; i < M.size(); ++i) text += number(M.data()[i]) + " ";
  return text + fmt::format("], {}, {})", M.rows(), M.cols());
}

std::string model(const StateSpace& m) {
  return fmt::format("ss ({}, {}, {}, {})", matrix(m.A), matrix(m.B), matrix(m.C), matrix(m.D));
}

std::string near(const char* name, const std::string& octave, double value) {
  return fmt::format("near ('{}', {}, {});\n", name, octave, number(value));
}

/// Octave's gain margin: of the crossings of the negative axis at frequencies above 0 the least
/// factor above 1, else the largest below.
double gain_of(const LoopMargins& m) {
  double above = HUGE_VAL, below = 0;
  for (const LoopCrossing& c : m.negative) {
    if (!(c.omega > 0) || std::isinf(c.omega)) continue;
    const double factor = -1 / c.L.real();
    if (factor >= 1)
      above = std::min(above, factor);
    else
      below = std::max(below, factor);
  }
  return std::isinf(above) && below > 0 ? below : above;
}

/// Octave's phase margin: the least lag, 0 to 360 degrees, at a crossing of the unit circle.
double lag_of(const LoopMargins& m) {
  double least = HUGE_VAL;
  for (const LoopCrossing& c : m.unit)
    if (c.omega > 0) least = std::min(least, 180 + degrees(std::arg(c.L)));
  return std::isinf(least) ? 180 : least;
}

/// Sensitivities of the loops at once: 1 + L, S - T, and T in the 2-norm if L has no direct term.
std::string sensitivities(const StateSpace& L, const std::string& octave, const MarginAt& nearest,
                          const DiskMargin& disk) {
  std::string text =
      fmt::format("L = {};\nI = eye ({});\nS = feedback (I, L);\n", octave, L.B.cols());
  text += near("S", fmt::format("peak (S, {})", number(nearest.omega)), 1 / nearest.value);
  text += near("S - T", fmt::format("max (1, peak (2 * S - I, {}))", number(disk.omega)),
               2 / disk.alpha);  // a disk margin is 2 at most
  if (L.D.isZero(0)) {
    StateSpace T = L;
    T.A -= L.B * L.C;
    text += near("T", "norm (feedback (L, I), 2)", norm_h2(T));
  }
  return text;
}

std::string loop_text(const StateSpace& L, const std::string& octave) {
  const Margins m = margins(L);
  CHECK(m.stable);
  const LoopMargins& l = m.loops.at(0);
  return sensitivities(L, octave, l.nearest, l.disk) + "[g, p] = margin (L);\n" +
         near("gain", "g", gain_of(l)) + near("phase", "p", lag_of(l));
}

/// Runs it, unless Octave is missing.
void run(const std::string& text) {
  if (std::system("octave-cli -q --eval 'pkg load control' >/dev/null 2>&1") != 0)
    return titop_test::skip("Octave with its control package is not installed");
  const Folder folder;
  folder.write("loops.m", kFunctions + text + "printf ('well\\n');\n");
  const int code = folder.run("octave-cli -q loops.m");
  INFO(folder.read("log.txt"));
  CHECK(code == 0);
  CHECK(folder.read("log.txt").find("well") != std::string::npos);
}

/// num / den, coefficients from the highest power.
struct Ratio {
  std::vector<double> num, den;
};

/// The families of tests/control/margins.cpp, whose margins have closed forms.
std::vector<Ratio> textbook() {
  std::vector<Ratio> all;
  for (const double k : {1e-3, 0.7, 1.0, 40.0}) all.push_back({{k}, {1, 0}});
  for (const double z : {0.05, 0.3, 0.7, 1.0, 2.0})
    for (const double w : {0.01, 1.0, 300.0}) all.push_back({{w * w}, {1, 2 * z * w, 0}});
  for (const double k : {0.1, 0.9, 7.9}) all.push_back({{k}, {1, 3, 3, 1}});
  for (const double a : {0.5, 2.0})
    for (const double b : {1.0, 30.0}) all.push_back({{a * b * (a + b) / 5}, {1, a + b, a * b, 0}});
  for (const double k : {0.04, 1.0, 25.0})
    for (const double T : {0.2, 1.5, 6.0}) all.push_back({{k * T, k}, {1, 0, 0}});
  for (const double a : {0.1, 2.0})
    for (const double k : {1.2, 3.0, 50.0}) all.push_back({{k * a}, {1, -a}});
  all.push_back({{3, 3}, {1, -1, 0}});
  all.push_back({{1, 2, 1}, {1, 0, 0, 0}});
  all.push_back({{1, 2, 1}, {0.0025, 0.1, 1, 0, 0, 0}});
  for (const double a : {0.3, 3.0, 30.0, 300.0}) all.push_back({{a / 2}, {1, a, 0}});
  all.push_back({{0.02, 0}, {1, 0, 49}});
  all.push_back({{-1, -1}, {2, 8}});
  all.push_back({{2, 0.5}, {1, 1}});
  all.push_back({{2, 3}, {1, 4, 3}});
  return all;
}

}  // namespace

TEST_CASE("fifty textbook loops in Octave") {
  const std::vector<Ratio> all = textbook();
  CHECK(all.size() >= 50);
  std::string text;
  for (const auto& [num, den] : all)
    text += loop_text(ratio(num, den), fmt::format("tf ([{:.17g}], [{:.17g}])", fmt::join(num, " "),
                                                   fmt::join(den, " ")));
  run(text);
}

TEST_CASE("two hundred random loops in Octave") {
  Rng rng(81);
  std::string text;
  for (int done = 0, unstable_plants = 0; done < 200 || unstable_plants < 20;) {
    const bool unstable_plant = rng.chance(0.4);
    const double size = std::pow(10, rng.between(-2, 0.5));
    const StateSpace L = model_of(random_parts(rng, unstable_plant, rng.chance(0.4), size));
    const Margins m = margins(L);
    if (!m.stable) continue;
    ++done, unstable_plants += m.nyquist.open_right > 0;
    text += loop_text(L, model(L));
  }
  run(text);
}

TEST_CASE("thirty random pairs of loops at once in Octave") {
  Rng rng(82);
  std::string text;
  for (int done = 0; done < 30;) {
    const Index n = 4 + rng.below(8);
    StateSpace L;
    L.A = rng.matrix(n, n);
    L.A.diagonal().array() -= 2;
    L.B = rng.matrix(n, 2), L.C = rng.matrix(2, n), L.D = MatrixXd::Zero(2, 2);
    const Margins m = margins(L);
    if (!m.stable) continue;
    ++done;
    text += sensitivities(L, model(L), m.nearest, m.disk);
  }
  run(text);
}

TEST_CASE("norms of forty random models in Octave") {
  Rng rng(83);
  std::string text;
  for (int k = 0; k < 40; ++k) {
    const Index n = 2 + rng.below(12), inputs = 1 + rng.below(3), outputs = 1 + rng.below(3);
    StateSpace m;
    m.A = rng.matrix(n, n);
    const double right = m.A.eigenvalues().real().maxCoeff();
    m.A.diagonal().array() -= right + std::pow(10, rng.between(-4, 0));  // poles near the axis
    m.B = rng.matrix(n, inputs), m.C = rng.matrix(outputs, n), m.D = rng.matrix(outputs, inputs);
    const HinfNorm largest = norm_hinf(m);
    text += "m = " + model(m) + ";\n";
    text += near("norm_hinf", fmt::format("peak (m, {})", number(largest.omega)), largest.value);
    m.D.setZero();
    text += near("norm_h2", "norm (" + model(m) + ", 2)", norm_h2(m));
  }
  run(text);
}
