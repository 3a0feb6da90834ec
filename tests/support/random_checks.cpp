#include "support/random_checks.hpp"

#include <algorithm>
#include <stdexcept>
#include <titop/compiler/passes/incidence.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/transfer.hpp>

#include "support/transfer_error.hpp"

namespace titop_test {

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void demand(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error("promise broken: " + what);
}

/// First row of each item in the declared order.
template <class List>
std::vector<int> declared_first(const List& list) {
  std::vector<int> size(list.size()), first(list.size());
  for (const auto& item : list) size[at(item.declared)] = item.size;
  int total = 0;
  for (std::size_t i = 0; i < list.size(); ++i) first[i] = total, total += size[i];
  return first;
}

}  // namespace

std::vector<std::complex<double>> points(std::uint64_t seed, int count) {
  Rng rng(seed ^ 0xF00Dull);
  std::vector<std::complex<double>> result;
  for (int i = 0; i < count; ++i) {
    const double omega = rng.octaves(-1, 7);
    result.emplace_back(rng.between(0.15, 0.3) * omega, omega);
  }
  return result;
}

MatrixXcd as_declared(const Graph& g, const MatrixXcd& G) {
  const auto rows = declared_first(g.outputs), cols = declared_first(g.inputs);
  MatrixXcd half(G.rows(), G.cols()), result(G.rows(), G.cols());
  Eigen::Index from = 0;
  for (const Output& o : g.outputs) {
    half.middleRows(rows[at(o.declared)], o.size) = G.middleRows(from, o.size);
    from += o.size;
  }
  from = 0;
  for (const Input& i : g.inputs) {
    result.middleCols(cols[at(i.declared)], i.size) = half.middleCols(from, i.size);
    from += i.size;
  }
  return result;
}

void demand_lowered(const Stage& stage) {
  const Graph& g = stage.graph;
  for (std::size_t i = 1; i < g.nodes.size(); ++i)
    demand(natural_compare(g.nodes[i - 1].name, g.nodes[i].name) < 0, "nodes stand by name");
  for (const Node& node : g.nodes)
    demand(node.lowered == node.block->is_algebraic(), node.name + " is an equation");
  const auto lowered = [&](const std::vector<Term>& terms) {
    return std::all_of(terms.begin(), terms.end(), [](const Term& t) {
      return t.of == Term::Of::signal && t.sign == 1 && t.factors.size() == 1 &&
             std::holds_alternative<Matrix>(t.factors.front());
    });
  };
  std::vector<int> driven(g.signals.size(), 0);
  for (const Equation& e : g.equations) {
    demand(!e.accumulate, "no += is left");
    demand(lowered(e.terms), "one coefficient per term in " + print(g, e));
    driven[at(e.target)] +=
        e.part.whole() ? g.signals[at(e.target)].size : static_cast<int>(e.part.rows.rows());
  }
  for (const Output& o : g.outputs)
    demand(lowered(o.terms), "one coefficient per term in " + o.name);
  for (const Channel& c : g.channels)
    demand(driven[at(c.accel)] + driven[at(c.force)] == c.size,
           "every degree of freedom of a channel is driven once");
}

void demand_matched(const Stage& stage) {
  std::vector<int> of_row(stage.rows.size(), 0), of_signal(stage.graph.signals.size(), 0);
  for (const auto& [row, signal] : stage.matched.rows) ++of_row[at(row)], ++of_signal[at(signal)];
  for (std::size_t r = 0; r < of_row.size(); ++r)
    demand(!stage.rows[r].active || of_row[r] == 1 || of_row[r] == stage.rows[r].size,
           "every row has its unknown");
  for (std::size_t s = 0; s < of_signal.size(); ++s) {
    const Signal& signal = stage.graph.signals[s];
    const bool unknown = passes::is_unknown(signal);
    demand(unknown ? of_signal[s] == 1 || of_signal[s] == signal.size : of_signal[s] == 0,
           "every unknown has its row: " + name_of(stage.graph, static_cast<int>(s)));
  }
}

void demand_ordered(const Stage& stage) {
  const Graph& g = stage.graph;
  std::vector<int> place(g.signals.size(), -1);
  for (std::size_t l = 0; l < stage.loops.size(); ++l)
    for (const int s : stage.loops[l].signals) {
      demand(place[at(s)] < 0, "every unknown is in one loop");
      place[at(s)] = static_cast<int>(l);
    }
  for (std::size_t s = 0; s < g.signals.size(); ++s)
    demand((place[s] >= 0) == passes::is_unknown(g.signals[s]), "every unknown is in a loop");
  for (std::size_t l = 0; l < stage.loops.size(); ++l)
    for (const int row : stage.loops[l].rows)
      for (const int s : passes::mentioned(g, stage.rows[at(row)]))
        demand(!passes::is_unknown(g.signals[at(s)]) || place[at(s)] <= static_cast<int>(l),
               "dependencies first");
}

PassError pass_error(const Scene& scene) {
  struct Pass {
    const char* name;
    Stage (*run)(Stage);
    void (*promise)(const Stage&);
  };
  const Pass all[] = {
      {"check", passes::check, nullptr},        {"lower", passes::lower, demand_lowered},
      {"split", passes::split, nullptr},        {"chains", passes::chains, nullptr},
      {"match", passes::match, demand_matched}, {"order", passes::order, demand_ordered}};
  const Diagram diagram = scene.build();
  const auto rows = Scene::blocks(scene.outputs), cols = Scene::blocks(scene.inputs);
  const std::complex<double> s = points(diagram.graph().nodes.size(), 1).front();
  const std::vector<MatrixXcd> exact{transfer(diagram.graph(), s)};
  Stage stage;
  stage.graph = diagram.graph();
  stage.values = nominal_values(stage.graph);
  PassError error;
  for (const Pass& pass : all) {
    stage = pass.run(std::move(stage));
    passes::verify(stage);
    if (pass.promise) pass.promise(stage);
    const MatrixXcd now = as_declared(stage.graph, transfer(stage.graph, s));
    const double e = transfer_error<MatrixXcd>({now}, exact, rows, cols);
    if (e > error.worst) error = {e, pass.name};
  }
  return error;
}

namespace {

/// Largest difference over the largest sum of magnitudes that forms an entry.
double relative(const VectorXd& a, const VectorXd& b, const VectorXd& size) {
  if (a.size() == 0) return 0;
  const double largest = (a - b).cwiseAbs().maxCoeff();
  return largest > 0 ? largest / size.maxCoeff() : 0;
}

double rates_error(const System& system, const StateSpace& m, std::uint64_t seed) {
  Rng rng(seed);
  const VectorXd x = rng.matrix(m.A.cols(), 1), u = rng.matrix(m.B.cols(), 1);
  const System::Rates r = system.apply(x, u);
  return std::max(relative(r.xdot, m.A * x + m.B * u,
                           m.A.cwiseAbs() * x.cwiseAbs() + m.B.cwiseAbs() * u.cwiseAbs()),
                  relative(r.y, m.C * x + m.D * u,
                           m.C.cwiseAbs() * x.cwiseAbs() + m.D.cwiseAbs() * u.cwiseAbs()));
}

}  // namespace

SystemError system_error(const Scene& scene) {
  const Diagram diagram = scene.build();
  const auto rows = Scene::blocks(scene.outputs), cols = Scene::blocks(scene.inputs);
  const System system = compile(diagram, {.minimize_up_to = 0, .dump_to = {}});
  const StateSpace& model = system.state_space();
  std::vector<MatrixXcd> exact, factored, dense;
  for (const auto s : points(7 + diagram.graph().nodes.size(), 3)) {
    exact.push_back(transfer(diagram.graph(), s));
    factored.push_back(system.transfer(s));
    dense.push_back(model.transfer(s));
  }
  SystemError error;
  error.factored = transfer_error(factored, exact, rows, cols);
  error.dense = transfer_error(dense, exact, rows, cols);
  error.apply = rates_error(system, model, 3);
  return error;
}

double minimize_error(const Scene& scene) {
  const System system = compile(scene.build());
  std::vector<MatrixXcd> exact, minimized;
  for (const auto s : points(13 + scene.adds.size(), 3)) {
    exact.push_back(system.transfer(s));
    minimized.push_back(system.state_space().transfer(s));
  }
  return transfer_error(minimized, exact, Scene::blocks(scene.outputs),
                        Scene::blocks(scene.inputs));
}

namespace {

using Names = std::vector<std::string>;

std::vector<Eigen::Index> places(const Names& of, const Names& in) {
  std::vector<Eigen::Index> result;
  for (const std::string& name : of)
    result.push_back(std::find(in.begin(), in.end(), name) - in.begin());
  return result;
}

std::string first_difference(const char* what, const MatrixXd& a, const MatrixXd& b,
                             const std::vector<Eigen::Index>& rows,
                             const std::vector<Eigen::Index>& cols) {
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      if (const double other =
              b(rows[static_cast<std::size_t>(i)], cols[static_cast<std::size_t>(j)]);
          a(i, j) != other)
        return std::string(what) + "(" + std::to_string(i) + ", " + std::to_string(j) +
               "): " + std::to_string(a(i, j)) + " against " + std::to_string(other) + ", off by " +
               std::to_string((a(i, j) - other) / a(i, j) * 1e15) + "e-15";
  return {};
}

}  // namespace

std::string difference_by_name(const StateSpace& a, const StateSpace& b) {
  for (const auto& [from, to] : {std::pair(&a.states, &b.states), std::pair(&a.inputs, &b.inputs),
                                 std::pair(&a.outputs, &b.outputs)}) {
    Names one = *from, two = *to;
    std::sort(one.begin(), one.end());
    std::sort(two.begin(), two.end());
    if (one != two) return "other names";
  }
  const auto x = places(a.states, b.states), u = places(a.inputs, b.inputs),
             y = places(a.outputs, b.outputs);
  for (const std::string& found :
       {first_difference("A", a.A, b.A, x, x), first_difference("B", a.B, b.B, x, u),
        first_difference("C", a.C, b.C, y, x), first_difference("D", a.D, b.D, y, u)})
    if (!found.empty()) return found;
  return {};
}

double units_error(const Scene& scene, const Units& units) {
  const Options plain{.minimize_up_to = 0, .dump_to = {}};
  const System ours = compile(scene.build(), plain), theirs = compile(scene.build(units), plain);
  const VectorXd in = Scene::factors(scene.inputs, units),
                 out = Scene::factors(scene.outputs, units);
  std::vector<MatrixXcd> a, b;
  for (const auto s : points(11 + scene.adds.size(), 3)) {
    a.push_back(ours.transfer(s));
    b.push_back(out.cwiseInverse().asDiagonal() * theirs.transfer(s / units.time) *
                in.asDiagonal());
  }
  return transfer_error(b, a, Scene::blocks(scene.outputs), Scene::blocks(scene.inputs));
}

}  // namespace titop_test
