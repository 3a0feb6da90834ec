#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/analysis/reduction/oscillators.hpp>
#include <titop/analysis/reduction/probes.hpp>
#include <titop/analysis/reduction/ray.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/parallel.hpp>

namespace titop::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double kDamping = 0.05;  ///< of the ray that modes are judged on
constexpr double kLowest = 1e-2;   ///< of the band's upper end: below it vectors are exact
constexpr double kStatic = 1e-4;   ///< of the lowest mode: below it nothing moves

using linalg::at;

/// The signals of this role of the node's block, in the order of its u or y.
std::vector<int> signals_of(const Graph& g, int node, Signal::Role role) {
  std::vector<int> list;
  for (int s = g.nodes[at(node)].first_signal; s < end_signal(g, node); ++s)
    if (g.signals[at(s)].role == role) list.push_back(s);
  return list;
}

/// The graph with the inputs of these nodes' blocks as outputs, after its own.
Graph reading(const Graph& graph, const std::vector<ModeEffects>& bodies) {
  Graph g = graph;
  for (const ModeEffects& body : bodies)
    for (const int s : signals_of(g, body.node, Signal::Role::input))
      g.outputs.push_back({.name = fmt::format("of signal {}", s),
                           .size = g.signals[at(s)].size,
                           .set = true,
                           .terms = {Term{.signal = s}},
                           .declared = static_cast<int>(g.outputs.size())});
  return g;
}

/// A row of the graph below: part of an output's scalar, that many times integrated.
struct IntegratedRow {
  Index output = 0;
  int times = 0;
};

/// Outputs whose positions and rates are replaced by accelerations: the states do not contain the
/// additions to these.
std::vector<Output> accelerations(const Graph& g, std::vector<IntegratedRow>& rows) {
  std::vector<Output> result;
  Index first = 0;
  for (const Output& o : g.outputs) {
    for (int times = 0; times < 3; ++times) {
      Output part = o;
      std::erase_if(part.terms, [&](const Term& t) {
        return times != (t.of == Term::Of::position ? 2 : t.of == Term::Of::rate ? 1 : 0);
      });
      if (part.terms.empty()) continue;
      if (times > 0)
        for (Term& t : part.terms) t.of = Term::Of::signal;
      part.name = fmt::format("{} {}", times, o.name);
      part.declared = static_cast<int>(result.size());
      result.push_back(std::move(part));
      for (int k = 0; k < o.size; ++k) rows.push_back({first + k, times});
    }
    first += o.size;
  }
  return result;
}

/// The graph with additions to the outputs of these nodes' blocks as inputs, after its own.
Graph driving(const Graph& graph, const std::vector<ModeEffects>& bodies,
              std::vector<IntegratedRow>& rows) {
  Graph g = graph;
  g.outputs = accelerations(graph, rows);
  std::map<int, int> addition;
  for (const ModeEffects& body : bodies)
    for (const int s : signals_of(graph, body.node, Signal::Role::output))
      addition[s] = add_input(g, fmt::format("to signal {}", s), graph.signals[at(s)].size);
  const auto add = [&](std::vector<Term>& terms) {
    for (std::size_t k = 0, count = terms.size(); k < count; ++k) {
      Term t = terms[k];
      const auto found = addition.find(t.signal);
      if (found == addition.end() || (t.of != Term::Of::signal && t.of != Term::Of::reaction))
        continue;
      t.signal = found->second;
      t.of = Term::Of::signal;
      terms.push_back(std::move(t));
    }
  };
  for (Equation& e : g.equations) {
    add(e.terms);
    const auto found = addition.find(e.target);
    if (e.accumulate || found == addition.end()) continue;
    Term t{.signal = found->second, .sign = -1};
    if (!e.part.whole()) t.factors.emplace_back(e.part);
    e.terms.push_back(std::move(t));
  }
  for (Output& o : g.outputs) add(o.terms);
  return g;
}

/// Points of the ray for smooth functions of the band.
std::vector<Complex> ray(const Scene& scene, const std::vector<BlockModes>& modes, double damping) {
  double high = 2 * std::numbers::pi * scene.band_hz[1];
  if (high == 0) {  // static gain: so far below all modes that nothing moves
    high = HUGE_VAL;
    for (const BlockModes& m : modes)
      high = std::min(high, kStatic * std::sqrt(m.stiffness.minCoeff()));
  }
  const double low = std::max(2 * std::numbers::pi * scene.band_hz[0], kLowest * high);
  const int count = 1 + static_cast<int>(std::ceil(std::log(high / low) / (2 * damping)));
  std::vector<Complex> s;
  for (int k = 0; k <= count; ++k)
    s.push_back(low * std::pow(high / low, static_cast<double>(k) / count) *
                Complex(damping, std::sqrt(1 - damping * damping)));
  return s;
}

std::vector<MatrixXcd> transfers(const Graph& graph, Options options,
                                 const std::vector<Complex>& s) {
  options.dump_to.clear();
  const System system(compile_graph(graph, options));
  std::vector<MatrixXcd> H(s.size());
  parallel(s.size(), 0, [&] {
    return [&](std::size_t k) { H[k] = system.transfer(s[k], Precision::standard); };
  });
  return H;
}

/// Outputs of the scene from the rows of `driving`.
MatrixXcd integrated(const MatrixXcd& G, const std::vector<IntegratedRow>& rows, Index outputs,
                     Complex s) {
  MatrixXcd result = MatrixXcd::Zero(outputs, G.cols());
  for (std::size_t r = 0; r < rows.size(); ++r)
    result.row(rows[r].output) += G.row(static_cast<Index>(r)) * std::pow(s, -rows[r].times);
  return result;
}

/// Largest magnitude of each pair; of nearly zero pairs the floor from row and column.
MatrixXd peaks(const std::vector<MatrixXcd>& H, Index outputs) {
  MatrixXd peak = MatrixXd::Zero(outputs, H.front().cols());
  for (const MatrixXcd& h : H) peak = peak.cwiseMax(h.topRows(outputs).cwiseAbs());
  const double all = peak.maxCoeff();
  if (!(all > 0)) return MatrixXd::Ones(peak.rows(), peak.cols());
  const Eigen::VectorXd row = peak.rowwise().maxCoeff();
  const Eigen::RowVectorXd column = peak.colwise().maxCoeff();
  peak = peak.cwiseMax(kNearlyZero * row * column / all);
  return (peak.array() > 0).select(peak, all);
}

/// Adds the modes of one block at s: `in` is the transfer to its inputs, `out` that from its
/// outputs.
void take_in(ModeEffects& body, const BlockModes& m, const MatrixXcd& in, const MatrixXcd& out,
             const MatrixXd& peak, Complex s) {
  const MatrixXcd read = m.out_q + s * m.out_v + s * s * m.out_a;
  const Eigen::MatrixXd moved = (m.b * in).cwiseAbs(), seen = (out * read).cwiseAbs();
  for (Index j = 0; j < m.stiffness.size(); ++j) {
    const double gain = 1 / std::abs(s * (s + m.damping(j)) + m.stiffness(j));
    double worst = 0;
    for (Index i = 0; i < seen.rows(); ++i)
      for (Index k = 0; k < moved.cols(); ++k)
        worst = std::max(worst, seen(i, j) * moved(j, k) / peak(i, k));
    body.cut(j) = std::max(body.cut(j), gain * worst);
    body.corrected(j) =
        std::max(body.corrected(j), gain * worst * std::pow(std::norm(s) / m.stiffness(j), 2));
  }
  for (std::size_t p = 0; p < m.ports.size(); ++p) {
    const auto& [column, input, output] = m.ports[p];
    if ((input >= 0 && !in.row(input).isZero(0)) || (output >= 0 && !out.col(output).isZero(0)))
      body.ports[p] = 1;
  }
}

BlockModes modes_of(const Modal& m) {
  const MatrixXd none = MatrixXd::Zero(m.W.cols(), m.W.rows());
  BlockModes modes{m.stiffness, m.damping, m.W, none, none, m.W.transpose(), {}};
  for (Index p = 0; p < m.W.cols(); ++p) modes.ports.push_back({m.W.col(p), p, p});
  return modes;
}

BlockModes modes_of(const Oscillators& o) {
  const MatrixXd none = MatrixXd::Zero(o.c_q.rows(), o.c_q.cols());
  BlockModes modes{o.stiffness, o.damping, o.b, o.c_q, o.c_v, none, {}};
  for (Index p = 0; p < o.b.cols(); ++p) modes.ports.push_back({o.b.col(p), p, -1});
  for (const MatrixXd* c : {&o.c_q, &o.c_v})
    for (Index p = 0; p < c->rows(); ++p) modes.ports.push_back({c->row(p), -1, p});
  return modes;
}

}  // namespace

std::optional<BlockModes> modes_of(const Block& block, ParameterValues values) {
  if (const std::optional<Oscillators> o = oscillators(block)) return modes_of(*o);
  const auto modal = block.dynamics(values)->modal;
  if (!modal) return std::nullopt;
  const auto kinematics = block.kinematics(values);
  if (kinematics && kinematics->stiffness.size() > 0) return std::nullopt;
  return modes_of(*modal);
}

std::vector<ModeEffects> mode_effects(const Graph& graph, const Scene& scene,
                                      const Options& options) {
  const std::vector<double> values = nominal_values(graph);
  std::vector<ModeEffects> bodies;
  std::vector<BlockModes> modes;
  for (int i = 0; i < static_cast<int>(graph.nodes.size()); ++i)
    if (auto found = modes_of(*graph.nodes[at(i)].block, values)) {
      const Eigen::VectorXd none = Eigen::VectorXd::Zero(found->stiffness.size());
      bodies.push_back({i, none, none, std::vector<char>(found->ports.size(), 0)});
      modes.push_back(*std::move(found));
    }
  if (bodies.empty()) return bodies;
  const double damping = std::max(kDamping, scene.damping_floor);
  const std::vector<Complex> s = ray(scene, modes, damping);
  std::vector<IntegratedRow> rows;
  const std::vector<MatrixXcd> H = transfers(reading(graph, bodies), options, s);
  const std::vector<MatrixXcd> G = transfers(driving(graph, bodies, rows), options, s);
  Index outputs = 0, inputs = 0;
  for (const Output& o : graph.outputs) outputs += o.size;
  for (const Input& u : graph.inputs) inputs += u.size;
  const MatrixXd peak = peaks(H, outputs);
  for (std::size_t k = 0; k < s.size(); ++k) {
    const MatrixXcd out = integrated(G[k], rows, outputs, s[k]);
    Index input = outputs, output = inputs;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Index columns = modes[b].b.cols(), rows_of = modes[b].out_q.rows();
      take_in(bodies[b], modes[b], H[k].middleRows(input, columns), out.middleCols(output, rows_of),
              peak, s[k]);
      input += columns, output += rows_of;
    }
  }
  for (ModeEffects& body : bodies) {
    body.cut *= damping / scene.damping_floor;
    body.corrected *= damping / scene.damping_floor;
  }
  return bodies;
}

}  // namespace titop::detail
