#include "support/random_checks.hpp"

#include <algorithm>
#include <titop/compiler/definition/transfer.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>

#include "support/promises.hpp"
#include "support/rng.hpp"
#include "support/transfer_error.hpp"

namespace titop_test {

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using titop::linalg::at;

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

PassError pass_error(const RandomDiagram& scene) {
  struct Pass {
    const char* name;
    Stage (*run)(Stage);
    void (*promise)(const Stage&);
  };
  const Pass all[] = {{"check", passes::check, nullptr},  // its promise shows in demand_lowered
                      {"lower", passes::lower, demand_lowered},
                      {"split", passes::split, demand_split},
                      {"chains", passes::chains, demand_not_redundant},
                      {"match", passes::match, demand_matched},
                      {"order", passes::order, demand_ordered},
                      {"close", passes::close, demand_closed}};
  const Diagram diagram = scene.build();
  const auto rows = RandomDiagram::blocks(scene.outputs),
             cols = RandomDiagram::blocks(scene.inputs);
  const std::complex<double> s = points(diagram.graph().nodes.size(), 1).front();
  const std::vector<MatrixXcd> exact{transfer(diagram.graph(), s)};
  Stage stage = as_written(diagram.graph());
  PassError error;
  for (const Pass& pass : all) {
    stage = pass.run(std::move(stage));
    passes::verify(stage);
    if (pass.promise) pass.promise(stage);
    const MatrixXcd now = as_declared(stage.now(), transfer(stage.now(), s));
    const double e = transfer_error<MatrixXcd>({now}, exact, rows, cols);
    if (e > error.worst) error = {e, pass.name};
  }
  return error;
}

namespace {

/// Largest difference over the largest sum of magnitudes that forms an entry; 0 where both are
/// rounding of the data, whose sizes are near 1.
double relative(const VectorXd& a, const VectorXd& b, const VectorXd& size) {
  if (a.size() == 0) return 0;
  const double largest = (a - b).cwiseAbs().maxCoeff();
  return largest > 1e-15 ? largest / size.maxCoeff() : 0;
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

SystemError system_error(const RandomDiagram& scene) {
  const Diagram diagram = scene.build();
  const auto rows = RandomDiagram::blocks(scene.outputs),
             cols = RandomDiagram::blocks(scene.inputs);
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
  const Certificate certificate = system.dense_certificate();
  error.stated = std::max(certificate.dense_error, certificate.dense_error_where_small);
  return error;
}

double minimize_error(const RandomDiagram& scene) {
  const System system = compile(scene.build());
  std::vector<MatrixXcd> exact, minimized;
  for (const auto s : points(13 + scene.adds.size(), 3)) {
    exact.push_back(system.transfer(s));
    minimized.push_back(system.state_space().transfer(s));
  }
  return transfer_error(minimized, exact, RandomDiagram::blocks(scene.outputs),
                        RandomDiagram::blocks(scene.inputs));
}

namespace {

using Names = std::vector<std::string>;

std::vector<Eigen::Index> places(const Names& of, const Names& in) {
  std::vector<Eigen::Index> result;
  for (const std::string& name : of)
    result.push_back(std::find(in.begin(), in.end(), name) - in.begin());
  return result;
}

std::string first_difference(const char* subject, const MatrixXd& a, const MatrixXd& b,
                             const std::vector<Eigen::Index>& rows,
                             const std::vector<Eigen::Index>& cols) {
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      if (const double other =
              b(rows[static_cast<std::size_t>(i)], cols[static_cast<std::size_t>(j)]);
          a(i, j) != other)
        return std::string(subject) + "(" + std::to_string(i) + ", " + std::to_string(j) +
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

double units_error(const RandomDiagram& scene, const Units& units) {
  const Options plain{.minimize_up_to = 0, .dump_to = {}};
  const System ours = compile(scene.build(), plain), theirs = compile(scene.build(units), plain);
  const VectorXd in = RandomDiagram::factors(scene.inputs, units),
                 out = RandomDiagram::factors(scene.outputs, units);
  std::vector<MatrixXcd> a, b;
  for (const auto s : points(11 + scene.adds.size(), 3)) {
    a.push_back(ours.transfer(s));
    b.push_back(out.cwiseInverse().asDiagonal() * theirs.transfer(s / units.time) *
                in.asDiagonal());
  }
  return transfer_error(b, a, RandomDiagram::blocks(scene.outputs),
                        RandomDiagram::blocks(scene.inputs));
}

}  // namespace titop_test
