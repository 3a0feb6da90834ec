#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <system_error>
#include <titop/compiler/diagram/dot.hpp>
#include <titop/compiler/index_reduction/reduce.hpp>
#include <titop/compiler/loops/internal_forces.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/solve/data_digits.hpp>
#include <titop/compiler/solve/layout.hpp>
#include <titop/compiler/solve/margins.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/graph/ahead.hpp>

namespace titop {

namespace {

struct Pass {
  const char* name;
  Stage (*run)(Stage);
};

/// The passes on the graph, top to bottom; then solve and certify work with numbers.
constexpr Pass kPasses[] = {
    {"check", passes::check},  // mistakes in the user's words, before any change
    {"lower", passes::lower},  // one numeric coefficient per term; names decide the order from here
    {"split", passes::split},  // parts without output: no later pass need look at them
    {"chains", passes::chains},  // redundant closures are released: no rank can fail below
    {"match", passes::match},    // which row determines which signal: finds channel inversions
    {"order", passes::order},    // loops; rows that no input reaches or no output sees
    {"close", passes::close},    // dependent coordinates, among the remaining states
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
void timed(detail::SystemData& data, const char* name, F f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  data.seconds.emplace_back(
      name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

void solve_joint(detail::Skeleton& k, detail::SystemData& d) {
  k.layout = detail::make_layout(k.stage.graph);
  d.states = detail::StateMap(k.stage.dependents, k.layout);
  d.numbers.parameters = k.stage.values;
  for (const Node& node : k.stage.graph.nodes) {
    fetch_ahead(k.stage.graph, d.numbers.blocks.size());
    d.numbers.blocks.push_back(node.block->dynamics(k.stage.values));
  }
  k.joint = solve::joint(k.stage, d.numbers.coefficients);
  d.factors =
      std::make_unique<const solve::Factors<double>>(k.joint.plan, detail::real_rows(k, d.numbers));
  k.dependents = detail::find_dependents(k.stage, k.joint);
  for (std::size_t i = 0; i < k.dependents.size(); ++i)
    if (k.dependents[i].nodes.empty() && k.dependents[i].origins.empty())
      k.stage.notes.push_back(
          {Note::Kind::info, "solve",
           fmt::format("parameter {}: nothing depends on it", k.stage.graph.parameters[i].name)});
  d.changed_loops.resize(k.stage.loops.size());
  std::iota(d.changed_loops.begin(), d.changed_loops.end(), 0);
  detail::update_margins(d);
  const bool singular = d.factors->health().singular;
  if (!singular) d.weak_pivots = detail::judge_weak_pivots(d, *d.margins);
  if (singular || d.weak_pivots->least > 0) {
    // Pivots may be rounding because the data have no digit there: that is told first.
    if (!singular) detail::judge_data_digits(d);
    detail::reduce(k, d);
  }
  detail::judge_internal_forces(k, d);
  const std::vector<Note> digits = detail::judge_data_digits(d);
  k.stage.notes.insert(k.stage.notes.end(), digits.begin(), digits.end());
  k.stage.notes.push_back({Note::Kind::info, "solve",
                           fmt::format("{} unknowns in {} fronts", k.joint.plan->unknowns,
                                       k.joint.plan->fronts.size())});
}

std::shared_ptr<detail::SystemData> run(Stage stage_0, const Options& options) {
  auto data = std::make_shared<detail::SystemData>();
  auto skeleton = std::make_shared<detail::Skeleton>();
  data->skeleton = skeleton;
  skeleton->options = options;
  Stage& stage = skeleton->stage;
  stage = std::move(stage_0);
  dump(options, 0, "diagram", stage);
  int number = 0;
  for (const Pass& pass : kPasses) {
    timed(*data, pass.name, [&] {
      stage = pass.run(std::move(stage));
      if (kVerifyEach || pass.run == passes::lower || &pass == std::prev(std::end(kPasses)))
        passes::verify(stage);
    });
    dump(options, ++number, pass.name, stage);
  }
  timed(*data, "solve", [&] { solve_joint(*skeleton, *data); });
  data->notes = stage.notes;
  data->scaled_at = data->numbers.parameters;
  data->scaled_health = data->factors->health();
  return data;
}

/// The certificate; `note` adds to the notes of the result before.
template <class Note>
std::shared_ptr<const detail::SystemData> certified(std::shared_ptr<detail::SystemData> data,
                                                    Note note) {
  note(*data);
  timed(*data, "certify", [&] { data->checked(); });
  return data;
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

System compile(const Diagram& diagram, const Options& options) {
  check_options(options);
  return System(detail::compile_graph(diagram.graph(), options));
}

namespace detail {

std::shared_ptr<const SystemData> compile_graph(const Graph& graph, const Options& options) {
  return compile_stage(as_written(graph), options);
}

std::shared_ptr<const SystemData> compile_again(const Skeleton& old,
                                                const std::vector<double>& values,
                                                const std::function<void(SystemData&)>& note) {
  Stage begin;
  begin.source = old.stage.source;
  begin.values = values;
  begin.before = old.stage.dependents;
  begin.motions = old.stage.motions;
  begin.opened = old.stage.opened;
  Options options = old.options;
  options.dump_to.clear();
  return certified(run(std::move(begin), options), note);
}

std::shared_ptr<const SystemData> compile_stage(Stage begin, const Options& options) {
  return certified(run(std::move(begin), options), [](SystemData&) {});
}

}  // namespace detail

}  // namespace titop
