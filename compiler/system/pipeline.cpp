#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <titop/compiler/diagram/dot.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/pipeline.hpp>
#include <titop/compiler/system/steps.hpp>
#include <variant>

namespace titop {

namespace {

using detail::Minimal;
using detail::Realization;
using detail::SystemData;
using steps::Compiled;

using OnGraph = Stage (*)(Stage);                      ///< compiler/passes/passes.hpp
using OnNumbers = Compiled (*)(Compiled);              ///< compiler/system/steps.hpp
using OnFactors = Realization (*)(const SystemData&);  ///< the same
using OnRealization = Minimal (*)(const SystemData&, const Realization&);  ///< the same

struct Pass {
  CompilerPass is;
  std::variant<OnGraph, OnNumbers, OnFactors, OnRealization> run;
  bool (*runs)(const Compiled&) = nullptr;  ///< CompilerPass::when; none: always
};

/// The compiler, top to bottom. A pass reads results of those above, and of no other.
constexpr Pass kPasses[] = {
    // Mistakes in the user's words, before any change.
    {{"check",
      "sizes, quantities and frames agree; each channel is driven once; all mistakes are "
      "reported together"},
     passes::check},
    // One numeric coefficient per term; names decide the order from here.
    {{"lower", "sums, gains and rotations are coefficients of equations; names decide the order"},
     passes::lower},
    // No later pass need look at parts without output.
    {{"split", "connected parts without output are removed and listed"}, passes::split},
    // Redundant closures are released: no rank can fail below.
    {{"chains",
      "closed kinematic chains meet; redundant loop constraints are dropped and listed; "
      "points fully held by a loop have zero motion"},
     passes::chains},
    {{"match", "every equation has its unknown; channel inversions are known"}, passes::match},
    {{"order",
      "algebraic loops are known; signals that no input reaches or no output sees are "
      "removed and listed"},
     passes::order},
    // Among the remaining states.
    {{"close", "dependent states (closed chains, duplicate integrators) are known and eliminated"},
     passes::close},
    // From here on with numbers.
    {{"layout", "every state, input and output has its name and its row in the model"},
     steps::layout},
    {{"blocks", "the matrices of all blocks are known at the parameters' values"}, steps::blocks},
    {{"join", "all interface unknowns have their equations, and a plan of their elimination"},
     steps::join},
    {{"depend", "the numbers that depend on each parameter are known", "there are parameters"},
     steps::depend,
     steps::has_parameters},
    {{"solve", "all interface unknowns are eliminated, junction by junction: the factored system"},
     steps::solve},
    {{"pivots", "the margin of every algebraic loop is known, and pivots that are rounding alone"},
     steps::pivots},
    {{"reduce", "singular scenes (points without mass) are reduced to their proper model",
      "the equations are singular"},
     steps::reduce,
     steps::has_no_pivot},
    // By the factors.
    {{"forces", "no internal force is read that the motion does not determine, or it is noted",
      "closed chains are over-constrained"},
     steps::forces,
     steps::is_overconstrained},
    {{"digits", "no motion or force depends on digits that the data do not have",
      "there are flexible bodies"},
     steps::digits,
     steps::has_data},
    {{"certify", "the checks that were made, and how well the equations are satisfied"},
     steps::certify},
    // When the dense model is requested.
    {{"dense", "A, B, C, D are written from the factors; the digits lost in them are known",
      "state_space() is called"},
     steps::dense},
    {{"minimize", "modes without effect are removed; the minimal order and its interval are known",
      "state_space() is called"},
     steps::minimize},
};

/// Invariants are checked after every pass, so that a fault of the library is reported at its pass.
/// A release checks only where coefficients are made and at the end: a check visits the whole
/// graph.
#ifdef NDEBUG
constexpr bool kVerifyEach = false;
#else
constexpr bool kVerifyEach = true;
#endif

void dump(const Options& options, int number, const char* name, const Stage& stage) {
  if (options.dump_to.empty()) return;
  std::error_code failed;
  std::filesystem::create_directories(options.dump_to, failed);
  const auto path =
      std::filesystem::path(options.dump_to) / fmt::format("{:02}-{}.dot", number, name);
  std::ofstream file(path);
  file << to_dot(stage);
  if (failed || !file)
    throw Error(Code::bad_file, fmt::format("{} cannot be written", path.string()),
                "give Options::dump_to a folder that can be made and written to");
}

/// Runs f and adds its seconds to the list.
template <class F>
void timed(std::vector<std::pair<std::string, double>>& seconds, const char* name, F f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  seconds.emplace_back(
      name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

void run_on_graph(OnGraph pass, Stage& stage) {
  stage = pass(std::move(stage));
  if (kVerifyEach || pass == passes::lower || pass == passes::close) passes::verify(stage);
}

/// All passes but those on the dense model. `plans_renewed`: by updates before.
std::shared_ptr<SystemData> run(Stage begin, const Options& options, int plans_renewed = 0) {
  Compiled c{std::make_shared<detail::Skeleton>(), std::make_shared<SystemData>()};
  c.data->skeleton = c.skeleton;
  c.data->plans_renewed = plans_renewed;
  c.skeleton->options = options;
  c.skeleton->stage = std::move(begin);
  dump(options, 0, "diagram", c.skeleton->stage);
  auto& seconds = c.data->seconds;
  int number = 0;
  for (const Pass& pass : kPasses) {
    if (pass.runs && !pass.runs(c)) continue;
    if (const auto* on_graph = std::get_if<OnGraph>(&pass.run)) {
      timed(seconds, pass.is.name, [&] { run_on_graph(*on_graph, c.skeleton->stage); });
      dump(options, ++number, pass.is.name, c.skeleton->stage);
    } else if (const auto* on_numbers = std::get_if<OnNumbers>(&pass.run)) {
      timed(seconds, pass.is.name, [&] { c = (*on_numbers)(std::move(c)); });
    }
  }
  return c.data;
}

void check_options(const Options& o) {
  const auto require = [](bool right, const char* name, double value, const char* range) {
    if (!right)
      throw Error(Code::bad_value, fmt::format("Options::{} is {}", name, value),
                  fmt::format("give it {}", range));
  };
  require(o.minimize_up_to >= 0, "minimize_up_to", o.minimize_up_to,
          "a number of states; 0: never");
  require(o.exact_up_to >= 0, "exact_up_to", o.exact_up_to, "a number of states; 0: never");
  require(o.resolution >= 0 && o.resolution < 1, "resolution", o.resolution,
          "a fraction from 0 to below 1: a relative bandwidth");
}

}  // namespace

std::span<const CompilerPass> compiler_passes() {
  static const std::vector<CompilerPass> all = [] {
    std::vector<CompilerPass> list;
    for (const Pass& pass : kPasses) list.push_back(pass.is);
    return list;
  }();
  return all;
}

namespace detail {

std::shared_ptr<const SystemData> compile_graph(const Graph& graph, const Options& options) {
  check_options(options);
  return compile_stage(as_written(graph), options);
}

std::shared_ptr<SystemData> compile_again(const SystemData& old,
                                          const std::vector<double>& values) {
  const Stage& stage = old.skeleton->stage;
  Stage begin;
  begin.source = stage.source;
  begin.values = values;
  begin.before = stage.dependents;
  begin.motions = stage.motions;
  begin.opened = stage.opened;
  begin.by_differences = stage.by_differences;
  std::ranges::copy_if(stage.notes, std::back_inserter(begin.notes),
                       [](const Note& n) { return n.pass == "open"; });
  Options options = old.skeleton->options;
  options.dump_to.clear();
  return run(std::move(begin), options, old.plans_renewed + 1);
}

std::shared_ptr<const SystemData> compile_stage(Stage begin, const Options& options) {
  return run(std::move(begin), options);
}

DenseModel dense_model(const SystemData& data) {
  DenseModel m;
  for (const Pass& pass : kPasses) {
    if (const auto* on_factors = std::get_if<OnFactors>(&pass.run))
      timed(m.seconds, pass.is.name, [&] { m.written = (*on_factors)(data); });
    else if (const auto* on_realization = std::get_if<OnRealization>(&pass.run))
      timed(m.seconds, pass.is.name, [&] { m.minimal = (*on_realization)(data, m.written); });
  }
  return m;
}

}  // namespace detail

}  // namespace titop
