#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <titop/analysis/bracket/interface_bracket.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {

namespace {

using Interval = InterfaceBracket::Interval;

constexpr const char* kNoTheorem =
    "the theorem does not hold for this scene: keep the modes of its bodies, leave out laws, and "
    "pair a force with the displacement of its own point";

void require(bool holds, std::string mistake, const char* hint) {
  if (!holds) throw Error(Code::bad_value, std::move(mistake), hint);
}

/// Frequencies of one model, ascending.
struct Frequencies {
  std::vector<double> elastic;
  std::size_t rigid = 0;  ///< motions without stiffness
};

Frequencies frequencies(const System& system) {
  Frequencies result;
  for (const Pole& pole : system.poles()) {
    require(pole.pair || pole.omega == 0,
            fmt::format("the scene has a real pole at {:.4g} rad/s", pole.s.real()),
            "leave out filters and dampers: the theorem is that of an undamped structure");
    if (pole.pair)
      result.elastic.push_back(pole.omega);
    else
      ++result.rigid;
  }
  std::ranges::sort(result.elastic);
  return result;
}

/// below <= above, up to rounding.
Interval interval(double below, double above, const std::string& subject) {
  require(below <= (1 + linalg::kHalfDigits) * above,
          fmt::format("the {} is {:.7g} with released interfaces, {:.7g} with constrained ones",
                      subject, below, above),
          kNoTheorem);
  return {below, above};
}

std::vector<Interval> of_frequencies(const System& constrained, const System& released, int modes) {
  const Frequencies above = frequencies(constrained), below = frequencies(released);
  require(above.rigid == below.rigid,
          fmt::format("the scene has {} motions without stiffness if its interfaces are "
                      "constrained, {} if they are released",
                      above.rigid, below.rigid),
          "build the same scene for both; average and moments hold all six motions of a body");
  const auto count = static_cast<std::size_t>(std::max(modes, 0));
  require(count <= std::min(above.elastic.size(), below.elastic.size()),
          fmt::format("{} modes are asked of a scene with {} and {}", modes, above.elastic.size(),
                      below.elastic.size()),
          "ask for fewer, or keep more modes of its bodies");
  std::vector<Interval> result;
  for (std::size_t k = 0; k < count; ++k)
    result.push_back(interval(below.elastic[k], above.elastic[k],
                              fmt::format("frequency of mode {} [rad/s]", k + 1)));
  return result;
}

std::vector<Interval> of_compliances(const System& constrained, const System& released,
                                     const std::vector<std::pair<int, int>>& pairs) {
  std::vector<Interval> result;
  if (pairs.empty()) return result;
  const Eigen::MatrixXd stiff = constrained.static_gain(), soft = released.static_gain();
  for (const auto& [input, output] : pairs) {
    require(input >= 0 && input < stiff.cols() && output >= 0 && output < stiff.rows(),
            fmt::format("the pair of input {} and output {} is not in a scene with {} and {}",
                        input, output, stiff.cols(), stiff.rows()),
            "they count from 0, every component of a port by itself");
    const double below = stiff(output, input), above = soft(output, input);
    require(below <= (1 + linalg::kHalfDigits) * above,
            fmt::format("the compliance of input {} and output {} is {:.7g} with constrained "
                        "interfaces, {:.7g} with released ones",
                        input, output, below, above),
            kNoTheorem);
    result.push_back({below, above});
  }
  return result;
}

double difference(const System& constrained, const System& released,
                  const std::vector<double>& omega) {
  if (omega.empty()) return 0;
  const auto a = constrained.frequency_response(omega), b = released.frequency_response(omega);
  Eigen::MatrixXd size = a[0].cwiseAbs(), apart = (a[0] - b[0]).cwiseAbs();
  for (std::size_t k = 1; k < omega.size(); ++k) {
    size = size.cwiseMax(a[k].cwiseAbs());
    apart = apart.cwiseMax((a[k] - b[k]).cwiseAbs());
  }
  // Entries that are zero by nature, beside those of their row and column, have no relative
  // difference.
  const Eigen::MatrixXd zero = linalg::kAxisRounding * size.rowwise().maxCoeff().cwiseSqrt() *
                               size.colwise().maxCoeff().cwiseSqrt();
  return (size.array() > zero.array()).select(apart.cwiseQuotient(size), 0.0).maxCoeff();
}

/// Models of other interfaces are not equal to the last digit.
bool differs(const InterfaceBracket& bracket) {
  const auto open = [](const Interval& i) { return i.width() != 0; };
  return std::ranges::any_of(bracket.omega, open) ||
         std::ranges::any_of(bracket.compliance, open) || bracket.transfer_difference > 0;
}

}  // namespace

InterfaceBracket interface_bracket(const std::function<Diagram(Lumping)>& scene,
                                   const BracketOptions& options) {
  const Options all_states{.minimize_up_to = 0};
  const System constrained = compile(scene(Lumping::constrained), all_states);
  const System released = compile(scene(Lumping::released), all_states);
  require(
      constrained.inputs() == released.inputs() && constrained.outputs() == released.outputs(),
      fmt::format("the scene has {} inputs and {} outputs if its interfaces are constrained, {} "
                  "and {} others if they are released",
                  constrained.inputs().size(), constrained.outputs().size(),
                  released.inputs().size(), released.outputs().size()),
      "build the same scene for both, with other couplings alone");
  InterfaceBracket bracket{of_frequencies(constrained, released, options.modes),
                           of_compliances(constrained, released, options.compliances),
                           difference(constrained, released, options.omega)};
  require(differs(bracket) || (bracket.omega.empty() && bracket.compliance.empty()),
          "no frequency and no compliance differs between constrained and released interfaces",
          "the scene must use its argument, on interfaces that these modes move: fe::rigid and "
          "fe::shapes if that is Lumping::constrained, "
          "fe::average and fe::moments if it is Lumping::released, of several nodes");
  return bracket;
}

std::string to_string(const InterfaceBracket& bracket) {
  std::string text = "        below        above     width\n";
  const auto line = [&](const Interval& i, double unit, const char* name) {
    text += fmt::format("{:>13.7g}{:>13.7g}{:>10.3f} %  {}\n", i.below / unit, i.above / unit,
                        100 * i.width() / i.above, name);
  };
  for (const Interval& i : bracket.omega) line(i, 2 * std::numbers::pi, "Hz");
  for (const Interval& i : bracket.compliance) line(i, 1, "compliance");
  if (bracket.transfer_difference > 0)
    text += fmt::format("the transfers differ by {:.3g} % (an estimate)\n",
                        100 * bracket.transfer_difference);
  return text;
}

}  // namespace titop
