// Margins, norms, zeros and discrete models against Octave's control package.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <titop/analysis/control/discrete.hpp>
#include <titop/analysis/control/margins.hpp>
#include <titop/analysis/control/zeros.hpp>
#include <titop/analysis/norms/h2.hpp>
#include <titop/analysis/norms/hinf.hpp>

#include "control/transfer_functions.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

using namespace titop;
using namespace titop_test;

namespace {

using Coefficients = std::vector<double>;

std::string row(const Coefficients& list) { return fmt::format("[{:.17g}]", fmt::join(list, " ")); }

std::string check(const char* octave, double value) {
  return fmt::format("near ({}, {});\n", octave,
                     std::isinf(value) ? "Inf" : fmt::format("{:.17g}", value));
}

/// The least value on a fine grid: not below, and above by the grid's step only.
std::string at_most(const char* octave, const MarginAt& m) {
  return fmt::format(
      "v = {0};\nassert (v >= {1:.17g} * (1 - 1e-9) && v <= {1:.17g} * (1 + 1e-6));\n", octave,
      m.value);
}

/// Octave's text of a loop, with this library's results.
std::string loop_text(const Coefficients& num, const Coefficients& den) {
  const StateSpace L = ratio(num, den);
  const LoopMargins m = margins(L).loops.at(0);
  std::string text =
      fmt::format("sys = tf ({}, {});\n[g, p, wg, wp] = margin (sys);\n", row(num), row(den));
  text += check("g", m.larger_gain.value) + check("p", degrees(m.phase.value));
  if (std::isfinite(m.larger_gain.value)) text += check("wg", m.larger_gain.omega);
  text += check("wp", m.phase.omega);
  // Octave's norm (..., Inf) misses the peak of S for (6 s + 4) / (s^2 (s / 20 + 1)): a grid.
  text += "w = logspace (-4, 4, 400001); L = squeeze (freqresp (sys, w));\n";
  text += at_most("min (abs (1 + L))", m.nearest) +
          at_most("2 * min (abs (1 + L) ./ abs (1 - L))", {m.disk.alpha, m.disk.omega});
  const StateSpace T = ratio(num, [&] {
    Coefficients sum = den;
    for (std::size_t i = 0; i < num.size(); ++i) sum[den.size() - num.size() + i] += num[i];
    return sum;
  }());
  text += check("norm (feedback (sys, 1), Inf, 1e-10)", norm_hinf(T).value);
  text += check("norm (feedback (sys, 1), 2)", norm_h2(T));
  double zeros = 0;  // sum of all zeros
  for (const auto& s : transmission_zeros(L)) zeros += s.real();
  text += check("sum (real (zero (sys)))", zeros);
  const DiscreteModel held = discretize(L, 0.05),
                      tustin = discretize(L, 0.05, Discretization::tustin, 3);
  text += check("abs (freqresp (c2d (ss (sys), 0.05, 'zoh'), 2))", std::abs(held.at(2)(0, 0)));
  text +=
      check("abs (freqresp (c2d (ss (sys), 0.05, 'prewarp', 3), 2))", std::abs(tustin.at(2)(0, 0)));
  return text;
}

}  // namespace

TEST_CASE("ten loops in Octave") {
  if (std::system("octave-cli -q --eval 'pkg load control' >/dev/null 2>&1") != 0)
    return titop_test::skip("Octave with its control package is not installed");
  std::string text =
      "pkg load control\nfunction near (a, b)\n  assert (isequal (a, b) || abs (a - b) <= 1e-6 * "
      "max (abs (b), 1e-3))\nend\n";
  text += loop_text({1.5}, {1, 3, 2, 0});
  text += loop_text({8}, {1, 6, 12, 8, 0});
  text += loop_text({2, 1}, {1, 0.2, 9, 0});
  text += loop_text({6, 4}, {0.05, 1, 0, 0});
  text += loop_text({12}, {1, 3, 20, 9});
  text += loop_text({5, 40}, {1, 12, 30, 7});
  text += loop_text({0.3, 0.02, 4}, {1, 0.5, 9, 1, 0});
  text += loop_text({9, 6, 36}, {0.1, 1.2, 30, 36, 0});
  text += loop_text({30}, {0.01, 1, 2, 5});
  text += loop_text({1, 0.1}, {1, 0.2, 1.44, 0.1});
  text += "printf ('well\\n');\n";
  const Folder folder;
  folder.write("loops.m", text);
  const int code = folder.run("octave-cli -q loops.m");
  INFO(folder.read("log.txt"));
  CHECK(code == 0);
  CHECK(folder.read("log.txt").find("well") != std::string::npos);
}
