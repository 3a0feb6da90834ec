#include "wild/parts/family.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "wild/oracle/print.hpp"
#include "wild/parts/judge.hpp"

namespace wild {

namespace {

constexpr int kFamilies = 10;
constexpr int kEveryOther = 10;  ///< one of so many scenes is simulated as well
/// Shares of a family's scenes. Of 7,000 scenes three were not judged, all of them beams whose kept
/// modes are not defined; three were answered wrong with a warning.
constexpr double kNotJudged = 0.01;
constexpr double kWrongButSaid = 0.01;

/// More than this share of the scenes, and three deviations of such a number.
bool above(double share, int number, int count) {
  const double expected = share * count;
  return number > expected + 3 * std::sqrt(expected);
}

int number(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

Scene scene_of(const Family& family, int seed) {
  Rng rng(static_cast<std::uint64_t>(seed) * 1000003u + 7u);
  return family.draw(rng);
}

Judgement judge_seed(const Scene& scene, int seed) {
  try {
    return judge(scene, static_cast<unsigned>(seed), seed % kEveryOther == 0);
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("seed {}: {}\n{}", seed, e.what(), print(scene)));
  }
}

/// A smaller scene with the same failure, by at least a thousand times the allowed error.
std::string smallest(const Family& family, int seed) {
  const Scene scene = scene_of(family, seed);
  const Judgement first = judge_seed(scene, seed);
  const auto same = [&](const Scene& less) {
    try {
      const Judgement j = judge_seed(less, seed);
      return j.verdict == first.verdict && j.road == first.road &&
             j.error >= std::min(first.error, 1e3) &&
             j.text.substr(0, 6) == first.text.substr(0, 6);
    } catch (const std::exception&) {
      return false;
    }
  };
  const Scene less = shrink(scene, same, 600);
  const Judgement j = judge_seed(less, seed);
  std::string text = fmt::format("{} seed {}: {}, {}: {}\n", family.name, seed,
                                 to_string(j.verdict), j.road, j.text);
  for (const Complex& s : j.s) text += fmt::format("s = {} {:+}j\n", s.real(), s.imag());
  return text + print(less);
}

}  // namespace

void demand_right(const Family& family) {
  const int count = std::max(1, number("TITOP_WILD_SCENES", 500) / kFamilies);
  std::map<Verdict, int> counts;
  std::map<std::string, int> refusals;
  std::vector<int> wrong, refused;
  for (int seed = 0; seed < count; ++seed) {
    const Judgement j = judge_seed(scene_of(family, seed), seed);
    ++counts[j.verdict];
    if (j.verdict == Verdict::refused_rightly || j.verdict == Verdict::refused_falsely)
      ++refusals[j.text.substr(0, j.text.find(':'))];
    if (j.verdict == Verdict::wrong_in_silence) wrong.push_back(seed);
    if (j.verdict == Verdict::refused_falsely) refused.push_back(seed);
  }
  std::string summary = fmt::format("{}: {} scenes", family.name, count);
  for (const auto& [verdict, n] : counts) summary += fmt::format(", {} {}", n, to_string(verdict));
  for (const auto& [code, n] : refusals) summary += fmt::format(", {} by {}", n, code);
  MESSAGE(summary);
  const auto show = [&](const std::string& text, const std::vector<int>& seeds) {
    std::string list;
    for (const int seed : seeds) list += fmt::format(" {}", seed);
    if (!seeds.empty()) MESSAGE(text << list << "\n" << smallest(family, seeds[0]));
  };
  const bool too_many = static_cast<double>(refused.size()) > family.refused_falsely * count;
  show("wrong in silence:", wrong);
  if (too_many) show("refused falsely:", refused);
  CHECK(wrong.empty());
  CHECK_FALSE(too_many);
  CHECK_FALSE(above(kNotJudged, counts[Verdict::not_judged], count));
  CHECK_FALSE(above(kWrongButSaid, counts[Verdict::wrong_but_said], count));
  CHECK(2 * counts[Verdict::right] >= count);
}

}  // namespace wild
