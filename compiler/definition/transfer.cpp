#include <fmt/format.h>

#include <optional>
#include <titop/compiler/definition/compare.hpp>
#include <titop/compiler/definition/transfer.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

/// All equations as E z = F u, one column of E per scalar signal; then one row for each scalar
/// output, y = F u - E z, on which no equation depends.
struct TransferAssembly {
  const Graph& graph;
  ParameterValues values;
  std::complex<double> s;
  Drives drive;
  std::vector<int> column;  ///< first column of each signal; inputs count apart
  int unknowns = 0, inputs = 0, outputs = 0, row = 0;
  MatrixXcd E, F;

  TransferAssembly(const Graph& g, ParameterValues v, std::complex<double> at_s)
      : graph(g), values(v), s(at_s), drive(g) {
    for (const Signal& sig : g.signals) {
      int& count = sig.role == Signal::Role::external ? inputs : unknowns;
      column.push_back(count);
      if (sig.active || sig.role == Signal::Role::external) count += sig.size;
    }
    for (const Output& o : g.outputs) outputs += o.size;
    E = MatrixXcd::Zero(unknowns + outputs, unknowns);
    F = MatrixXcd::Zero(unknowns + outputs, inputs);
  }

  /// So many rows more; throws if they are more than the unknowns.
  void need(Eigen::Index rows) const {
    if (row + rows > E.rows())
      throw Error(Code::two_equations,
                  fmt::format("{}: more equations than its {} unknowns", graph.name, unknowns),
                  "compile it: the message names the port that is driven twice");
  }

  /// row += factor * signal
  void add(const MatrixXcd& factor, int signal) {
    need(factor.rows());
    const Signal& sig = graph.signals[at(signal)];
    if (sig.role == Signal::Role::external)
      F.block(row, column[at(signal)], factor.rows(), sig.size) -= factor;
    else if (sig.active)
      E.block(row, column[at(signal)], factor.rows(), sig.size) += factor;
  }

  /// row -= factor * (sum of terms)
  void subtract(const MatrixXcd& factor, const std::vector<Term>& terms) {
    for (const Term& t : terms) {
      if (rows_of(graph, t) != factor.cols())
        throw Error(Code::size,
                    fmt::format("{}: a term with {} has another size than its equation", graph.name,
                                name_of(graph, t.signal)),
                    "compile it: the message names the port");
      const MatrixXcd c = factor * coefficient(graph, t, values);
      add(t.of == Term::Of::position ? MatrixXcd(-c / (s * s))
          : t.of == Term::Of::rate   ? MatrixXcd(-c / s)
                                     : MatrixXcd(-c),
          t.signal);
      if (t.of != Term::Of::reaction) continue;
      const int channel = graph.signals[at(t.signal)].channel;
      subtract_equations(-c, drive[at(channel)].added);
    }
  }

  /// row -= factor * (terms that these equations add to their channel's force)
  void subtract_equations(const MatrixXcd& factor, std::span<const int> equations) {
    for (const int e : equations) {
      const Part& part = graph.equations[at(e)].part;
      subtract(part.whole() ? factor : MatrixXcd(factor * part.rows().transpose()),
               graph.equations[at(e)].terms);
    }
  }
};

void add_block(TransferAssembly& a, const Node& node, int index, std::complex<double> s) {
  const auto d = node.block->dynamics(a.values);
  const auto n = d->A.rows();
  const std::optional<MatrixXcd> closed = closed_form_of(*node.block)
                                              ? std::optional(node.block->response(s, a.values).Y)
                                              : std::nullopt;
  const int end = end_signal(a.graph, index);
  if (node.state >= 0 && a.graph.signals[at(node.state)].active) {
    a.add(s * MatrixXcd::Identity(n, n) - d->A, node.state);
    for (int i = node.first_signal; i < end; ++i)
      if (const Signal& u = a.graph.signals[at(i)]; u.role == Signal::Role::input)
        a.add(-d->B.middleCols(u.first, u.size), i);
    a.row += static_cast<int>(n);
  }
  for (int o = node.first_signal; o < end; ++o) {
    const Signal& y = a.graph.signals[at(o)];
    if (y.role != Signal::Role::output || !y.row) continue;
    a.add(MatrixXcd::Identity(y.size, y.size), o);
    if (node.state >= 0) a.add(-d->C.middleRows(y.first, y.size), node.state);
    for (int i = node.first_signal; i < end; ++i)
      if (const Signal& u = a.graph.signals[at(i)]; u.role == Signal::Role::input)
        a.add(closed ? MatrixXcd(-closed->block(y.first, u.first, y.size, u.size))
                     : MatrixXcd(-d->direct(y.first, u.first, y.size, u.size)),
              i);
    a.row += y.size;
  }
}

void add_channel(TransferAssembly& a, const Channel& channel, const Drive& drive) {
  const auto& equations = a.graph.equations;
  for (const int e : drive.accel) {
    if (!equations[at(e)].active) continue;
    const Part& part = equations[at(e)].part;
    const MatrixXd S = part.whole() ? MatrixXd::Identity(channel.size, channel.size) : part.rows();
    a.add(S, channel.accel);
    a.subtract(MatrixXd::Identity(S.rows(), S.rows()), equations[at(e)].terms);
    a.row += static_cast<int>(S.rows());
  }
  if (drive.free == 0) return;
  bool active =
      drive.force.empty() && drive.added.empty() ? a.graph.signals[at(channel.force)].active : true;
  for (const int e : drive.force) active = active && equations[at(e)].active;
  if (!active) return;
  const MatrixXd N = drive.N();
  a.add(N, channel.force);
  a.subtract_equations(N, drive.force);
  a.subtract_equations(N, drive.added);
  a.row += drive.free;
}

/// Signal = sum of its terms; column = -1: an output.
void add_definition(TransferAssembly& a, int column, int size, const std::vector<Term>& terms) {
  a.need(size);
  if (column >= 0) a.E.block(a.row, column, size, size).setIdentity();
  a.subtract(MatrixXd::Identity(size, size), terms);
  a.row += size;
}

TransferAssembly assembled(const Graph& graph, std::complex<double> s, ParameterValues values) {
  TransferAssembly a(graph, values, s);
  for (int i = 0; i < static_cast<int>(graph.nodes.size()); ++i)
    if (!graph.nodes[at(i)].lowered) add_block(a, graph.nodes[at(i)], i, s);
  for (std::size_t c = 0; c < a.drive.size(); ++c) add_channel(a, graph.channels[c], a.drive[c]);
  for (const Equation& e : graph.equations)
    if (const Signal& target = graph.signals[at(e.target)];
        (target.channel < 0 || e.of_block) && e.active)
      add_definition(a, a.column[at(e.target)], target.size, e.terms);
  for (const Output& o : graph.outputs) add_definition(a, -1, o.size, o.terms);
  return a;
}

}  // namespace

MatrixXcd transfer(const Graph& graph, std::complex<double> s, ParameterValues values) {
  if (!graph.mistakes.empty()) throw Error(graph.mistakes);
  const std::vector<double> nominal = nominal_values(graph);
  const TransferAssembly a =
      assembled(graph, s, values.empty() ? ParameterValues(nominal) : values);
  if (a.row != a.unknowns + a.outputs)
    throw Error(
        Code::no_equation,
        fmt::format("{}: {} equations for {} unknowns", graph.name, a.row - a.outputs, a.unknowns),
        "compile it: the message names the port that is not driven, or driven twice");
  const linalg::Solution solution = linalg::solve(a.E.topRows(a.unknowns), a.F.topRows(a.unknowns));
  if (!(solution.rcond > linalg::kEpsilon / 2) || !solution.z.allFinite())
    throw Error(
        Code::singular,
        fmt::format("{}: at s = {}{:+}j the equations have no unique solution (rcond {:.1g})",
                    graph.name, s.real(), s.imag(), solution.rcond),
        "s may be a pole; try another s, or compile it: its errors name the cause");
  return a.F.bottomRows(a.outputs) - a.E.bottomRows(a.outputs) * solution.z;
}

namespace detail {

MatrixXd terms(const Graph& graph, const std::vector<std::complex<double>>& points,
               ParameterValues values) {
  MatrixXd result;
  for (const std::complex<double> s : points) {
    const TransferAssembly a = assembled(graph, s, values);
    const auto E = a.E.topRows(a.unknowns), Y = a.E.bottomRows(a.outputs);
    const auto F = a.F.topRows(a.unknowns);
    const linalg::Solution there = linalg::solve(E, F),
                           back = linalg::solve(E.reverse(), F.colwise().reverse());
    if (!(there.rcond > 0) || !(back.rcond > 0)) continue;  // no unique solution
    const MatrixXcd off = Y * there.z - Y.rowwise().reverse() * back.z;
    if (result.size() == 0) result = MatrixXd::Zero(off.rows(), off.cols());
    if (off.allFinite()) result = result.cwiseMax(kTermsPerRounding * off.cwiseAbs());
  }
  return result;
}

}  // namespace detail

}  // namespace titop
