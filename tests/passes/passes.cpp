#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <titop/compiler/diagram/dot.hpp>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>

#include "support/close.hpp"
#include "support/notes.hpp"
#include "support/small_scenes.hpp"

using namespace titop;
using namespace titop_test;
using Complex = std::complex<double>;

namespace {

using titop::linalg::at;

const std::vector<Complex> kPoints{{0.3, 1.7}, {-0.4, 6.1}, {0.1, 0.05}, {2, 40}};

/// Transfer of the graph, rows and columns as the user declared them.
Eigen::MatrixXcd meaning(const Graph& g, Complex s) {
  const Eigen::MatrixXcd G = transfer(g, s);
  std::vector<int> rows, cols;
  const auto gather = [](const auto& list, std::vector<int>& indices) {
    for (std::size_t declared = 0; declared < list.size(); ++declared)
      for (int first = 0, i = 0; i < static_cast<int>(list.size()); first += list[at(i++)].size)
        if (at(list[at(i)].declared) == declared)
          for (int k = 0; k < list[at(i)].size; ++k) indices.push_back(first + k);
  };
  gather(g.outputs, rows);
  gather(g.inputs, cols);
  return G(rows, cols);
}

struct Pass {
  const char* name;
  Stage (*run)(Stage);
};
constexpr Pass kPasses[] = {{"check", passes::check}, {"lower", passes::lower},
                            {"split", passes::split}, {"chains", passes::chains},
                            {"match", passes::match}, {"order", passes::order},
                            {"close", passes::close}};

Stage run_until(const Diagram& d, std::string_view last) {
  Stage stage = as_written(d.graph());
  for (const Pass& pass : kPasses) {
    stage = pass.run(std::move(stage));
    if (pass.name == last) break;
  }
  return stage;
}

}  // namespace

TEST_CASE("every pass keeps the transfer, and so do the system and its dense model") {
  for (const NamedScene& scene : scenes()) {
    CAPTURE(scene.name);
    const Diagram d = scene.make();
    std::vector<Eigen::MatrixXcd> exact;
    for (const Complex s : kPoints) exact.push_back(meaning(d.graph(), s));
    Stage stage = as_written(d.graph());
    for (const Pass& pass : kPasses) {
      CAPTURE(pass.name);
      stage = pass.run(std::move(stage));
      passes::verify(stage);
      for (std::size_t k = 0; k < kPoints.size(); ++k)
        CHECK(matrix_error(meaning(stage.now(), kPoints[k]), exact[k]) <= 1e-12);
    }
    const System system = compile(d);
    CHECK(system.order() == scene.states);
    for (std::size_t k = 0; k < kPoints.size(); ++k) {
      CHECK(matrix_error(system.transfer(kPoints[k]), exact[k]) <= 1e-12);
      CHECK(matrix_error(system.state_space().transfer(kPoints[k]), exact[k]) <= 1e-11);
    }
    CHECK(system.certificate().residual <= 1e-14);
    CHECK(system.dense_certificate().dense_against_factors <= 1e-13);
    CHECK(system.certificate().seconds > 0);  // the check's seconds are reported
  }
}

TEST_CASE("a stage that has not begun with a diagram is refused") {
  CHECK_THROWS_AS(passes::check({}), std::logic_error);
  CHECK_THROWS_AS(passes::lower({}), std::logic_error);
  CHECK_THROWS_AS(to_dot(Stage{}), std::logic_error);
}

TEST_CASE("lower: nodes stand along trees, from the first name; where a chain closes, by name") {
  for (const bool closed : {false, true}) {
    Diagram d{"a, c and b in a row"};
    auto u = d.input("u");
    auto c = d.add("c", SpringMass{.mass = 1, .stiffness = 1});
    auto b = d.add("b", SpringMass{.mass = 1, .stiffness = 1});
    auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 1});
    ground(a);
    mount(c, a.child);
    mount(b, c.child);
    if (closed)
      b.child.accel = 0;
    else
      b.child.force = u;
    d.output("x") = c.stretch;
    std::string names;
    for (const Node& n : run_until(d, "lower").graph.nodes) names += n.name;
    CHECK(names == (closed ? "abc" : "acb"));
  }
}

TEST_CASE("lower: one numeric coefficient per term, one equation per driven part") {
  for (const NamedScene& scene : scenes()) {
    CAPTURE(scene.name);
    const Graph g = run_until(scene.make(), "lower").graph;
    for (const Node& n : g.nodes) CHECK(n.lowered == n.block->is_algebraic());
    std::vector<int> driven(g.signals.size(), 0);
    const auto lowered = [](const std::vector<Term>& terms) {
      for (const Term& t : terms)
        if (t.sign != 1 || t.of != Term::Of::signal || t.factors.size() != 1 ||
            !std::holds_alternative<Matrix>(t.factors[0]))
          return false;
      return true;
    };
    for (const Equation& e : g.equations) {
      CHECK_FALSE(e.accumulate);
      CHECK(lowered(e.terms));
      std::set<int> signals;
      for (const Term& t : e.terms) CHECK(signals.insert(t.signal).second);
      driven[at(e.target)] +=
          e.part.whole() ? g.signals[at(e.target)].size : static_cast<int>(e.part.rows().rows());
    }
    for (const Output& o : g.outputs) CHECK(lowered(o.terms));
    for (const Channel& c : g.channels) CHECK(driven[at(c.accel)] + driven[at(c.force)] == c.size);
    for (std::size_t s = 0; s < g.signals.size(); ++s) {
      const Signal& sig = g.signals[s];
      if (sig.channel >= 0 || sig.node < 0 || sig.role == Signal::Role::state) continue;
      const bool own = sig.role == Signal::Role::input || g.nodes[at(sig.node)].lowered;
      CHECK(driven[s] == (own ? sig.size : 0));
    }
  }
}

TEST_CASE("split: parts that hang together with nothing are set aside and listed") {
  const Stage stage = run_until(scenes()[2].make(), "split");
  CHECK(count_notes(stage.notes, Note::Kind::removed, "split", {"island"}) == 1);
  for (const Signal& s : stage.graph.signals)
    if (s.node >= 0) CHECK(s.active == (stage.graph.nodes[at(s.node)].name != "island"));
}

TEST_CASE("split and order: without inputs every state counts as driven, without outputs as seen") {
  const auto scene = [](bool input, bool output) {
    Diagram d{"modes"};
    auto z1 = d.add("z1", SpringMass{}), z2 = d.add("z2", SpringMass{});
    ground(z1), ground(z2);
    if (input) z1.child.force = d.input("u");
    if (output) d.output("x") = z2.stretch;
    return compile(d);
  };
  CHECK(scene(false, false).state_space().order() == 4);
  CHECK(scene(true, false).states() == std::vector<std::string>{"z1.stretch", "z1.stretch_rate"});
  CHECK(scene(false, true).states() == std::vector<std::string>{"z2.stretch", "z2.stretch_rate"});
  CHECK(scene(true, true).order() == 0);
  CHECK(scene(true, true).state_space().D.isZero(0));
}

TEST_CASE("match: every row has its unknown, each of them once; inversions come out") {
  for (const NamedScene& scene : scenes()) {
    CAPTURE(scene.name);
    const Stage stage = run_until(scene.make(), "match");
    const Graph& g = stage.graph;
    std::vector<int> rows(stage.rows.size(), 0), signals(g.signals.size(), 0);
    for (const auto& [row, signal] : stage.matched.rows) {
      ++rows[at(row)], ++signals[at(signal)];
      const auto mentioned = passes::mentioned(g, stage.rows[at(row)]);
      CHECK(std::find(mentioned.begin(), mentioned.end(), signal) != mentioned.end());
    }
    for (std::size_t r = 0; r < rows.size(); ++r)
      CHECK((rows[r] == 1 || rows[r] == stage.rows[r].size));
    for (std::size_t s = 0; s < signals.size(); ++s) {
      const int count = signals[s];
      if (passes::is_unknown(g.signals[s]))
        CHECK((count == 1 || count == g.signals[s].size));
      else
        CHECK(count == 0);
    }
    std::vector<std::string> inverted;
    for (const Inversion& i : stage.inversions) {
      CHECK(i.forced);
      inverted.push_back(channel_name(g, i.channel));
    }
    std::sort(inverted.begin(), inverted.end());
    CHECK(inverted == scene.inverted);
  }
}

TEST_CASE("order: each unknown in one loop, dependencies first; inactive signals are listed") {
  for (const NamedScene& scene : scenes()) {
    CAPTURE(scene.name);
    const Stage stage = run_until(scene.make(), "order");
    const Graph& g = stage.graph;
    std::vector<int> loop_of(g.signals.size(), -1);
    int number = 0;
    for (const Loop& loop : stage.loops) {
      int unknowns = 0, rows = 0;
      for (const int s : loop.signals) {
        CHECK(passes::is_unknown(g.signals[at(s)]));
        CHECK(loop_of[at(s)] == -1);
        loop_of[at(s)] = number;
        unknowns += g.signals[at(s)].size;
      }
      CHECK(unknowns == loop.unknowns);
      for (const int r : loop.rows) {
        rows += stage.rows[at(r)].size;
        for (const int s : passes::mentioned(g, stage.rows[at(r)]))
          if (passes::is_unknown(g.signals[at(s)])) {
            CHECK(loop_of[at(s)] >= 0);
            CHECK(loop_of[at(s)] <= number);
          }
      }
      CHECK(rows == unknowns);
      ++number;
    }
    for (std::size_t s = 0; s < g.signals.size(); ++s)
      CHECK((loop_of[s] >= 0) == passes::is_unknown(g.signals[s]));
  }
  struct SetAside {
    const char *name, *states;
    bool at_rest;  // no input moves it; else no output sees it
  };
  const Stage loose = run_until(scenes()[2].make(), "order");
  for (const SetAside& node : {SetAside{"deaf", "1", false},
                               {"still", "1", true},
                               {"undriven", "2", true},
                               {"unseen", "2", false}}) {
    CAPTURE(node.name);
    CHECK(count_notes(loose.notes, Note::Kind::removed, "order", {node.name, node.states}) == 1);
    for (const Signal& s : loose.graph.signals)
      if (s.role == Signal::Role::state && loose.graph.nodes[at(s.node)].name == node.name) {
        CHECK_FALSE(s.active);
        CHECK(s.at_rest == node.at_rest);
      }
  }
}

TEST_CASE("order: the loop through a controller with a direct term is one, of a known margin") {
  // a = f / m, f = u - D a: the loop matrix has the diagonal 1 and a gain D / m around.
  Diagram d{"loop"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 1});
  auto K = d.add("K", Lti{.D = Eigen::MatrixXd{{-1.5}}});
  ground(z);
  K.in = z.child.accel;
  z.child.force = u - K.out;
  d.output("a") = z.child.accel;
  const System system = compile(d);
  int coupled = 0;
  for (const Loop& loop : system.stage().loops) coupled += loop.signals.size() > 1;
  CHECK(coupled == 1);
  // A ring of n = 4 signals with gain g = 0.75 around: |L^-1| |L| = sum of P^k (I + P) / (1 - g),
  // k < n, with rho(P) = r = g^(1/n); that is (1 + r) / (1 - r).
  const double r = std::pow(0.75, 0.25);
  CHECK(relative(system.certificate().margin, (1 + r) / (1 - r)) <= 1e-2);
}

TEST_CASE("verify: broken graphs are told from whole ones") {
  const Stage whole = run_until(scenes()[0].make(), "order");
  passes::verify(whole);
  Stage no_target = whole, no_signal = whole, wrong_size = whole, no_row = whole;
  no_target.graph.equations[0].target = -1;
  no_signal.graph.equations[1].terms.push_back(Term{.signal = 1000});
  for (Equation& e : wrong_size.graph.equations)
    if (!e.terms.empty()) e.terms[0].factors[0] = Matrix{std::make_shared<Eigen::MatrixXd>(2, 1)};
  for (Row& row : no_row.rows) row.active = false;
  for (const Stage* broken : {&no_target, &no_signal, &wrong_size, &no_row})
    CHECK_THROWS_AS(passes::verify(*broken), std::logic_error);
}
