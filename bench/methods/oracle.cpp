#include "oracle.hpp"

#include <stdexcept>
#include <titop/graph/linalg/index.hpp>
#include <utility>
#include <vector>

#include "methods/elimination.hpp"

namespace titop_bench {

using Eigen::MatrixXd;
using titop::Dynamics;
using titop::Signal;

namespace {

using Number = Digits150;
using Rows = Table<Number>;
using titop::linalg::at;

/// The block from its inputs to its outputs: rigid + W' s^2 / (s^2 + damping s + stiffness) W.
Rows modal_response(const titop::Modal& m, const Number& s) {
  Rows Y(m.rigid);
  const Rows W(m.W);
  for (Eigen::Index k = 0; k < W.rows(); ++k) {
    const Number gain =
        s * s / (s * s + number<Number>(m.damping(k)) * s + number<Number>(m.stiffness(k)));
    for (Eigen::Index i = 0; i < Y.rows(); ++i)
      for (Eigen::Index j = 0; j < Y.cols(); ++j) Y(i, j) += W(k, i) * gain * W(k, j);
  }
  return Y;
}

Rows response(const Dynamics& d, const Number& s) {
  if (d.modal && d.sparse.empty()) return modal_response(*d.modal, s);
  Rows Y(d.dense_direct()), X(d.B), M(MatrixXd(-d.A));
  for (Eigen::Index i = 0; i < M.rows(); ++i) M(i, i) += s;
  solve(std::move(M), X);
  for (Eigen::Index i = 0; i < Y.rows(); ++i)
    for (Eigen::Index j = 0; j < Y.cols(); ++j)
      for (Eigen::Index k = 0; k < X.rows(); ++k) Y(i, j) += number<Number>(d.C(i, k)) * X(k, j);
  return Y;
}

/// All signals in terms of the blocks' inputs v: M v = R w.
struct Equations {
  const titop::Stage& stage;
  std::vector<Rows> responses = {};
  std::vector<Eigen::Index> first = {};  ///< of each node: first of its inputs
  Eigen::Index unknowns = 0, row = 0;

  Equations(const titop::Stage& st, const Number& s) : stage(st) {
    for (const titop::Node& node : stage.graph.nodes) {
      responses.push_back(response(*node.block->dynamics(stage.values), s));
      first.push_back(unknowns);
      unknowns += responses.back().cols();
    }
  }

  /// Row `to_row` of `to v = known` gets factor * signal, on the left.
  void add(const MatrixXd& factor, int signal, Rows& to, Eigen::Index to_row, Rows& known) const {
    const Signal& sig = stage.graph.signals[at(signal)];
    for (Eigen::Index i = 0; i < factor.rows(); ++i)
      for (Eigen::Index k = 0; k < factor.cols(); ++k) {
        const Number f = number<Number>(factor(i, k));
        if (f == number<Number>(0)) continue;
        if (sig.role == Signal::Role::external)
          known(to_row + i, k) -= f;
        else if (sig.role == Signal::Role::input)
          to(to_row + i, first[at(sig.node)] + sig.first + k) += f;
        else
          add_row(f, sig, k, to, to_row + i);
      }
  }

  void add_row(const Number& f, const Signal& output, Eigen::Index k, Rows& to,
               Eigen::Index to_row) const {
    const Rows& Y = responses[at(output.node)];
    for (Eigen::Index j = 0; j < Y.cols(); ++j)
      to(to_row, first[at(output.node)] + j) += f * Y(output.first + k, j);
  }

  void add(const std::vector<titop::Term>& terms, Rows& to, Eigen::Index to_row,
           Rows& known) const {
    for (const titop::Term& t : terms)
      add(-coefficient(stage.graph, t, stage.values), t.signal, to, to_row, known);
  }
};

/// Inputs that are not driven and whose channel is not inverted are 0.
void add_rows(Equations& e, Rows& M, Rows& R) {
  const titop::Graph& g = e.stage.graph;
  std::vector<char> driven(g.signals.size(), 0);
  for (const titop::Equation& equation : g.equations) {
    if (!equation.active || equation.of_block) continue;  // part of the response
    const int size = g.signals[at(equation.target)].size;
    driven[at(equation.target)] = 1;
    e.add(MatrixXd::Identity(size, size), equation.target, M, e.row, R);
    e.add(equation.terms, M, e.row, R);
    e.row += size;
  }
  for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
    const Signal& sig = g.signals[at(s)];
    if (sig.role != Signal::Role::input || driven[at(s)]) continue;
    if (sig.channel >= 0) {
      const titop::Channel& c = g.channels[at(sig.channel)];
      if (driven[at(c.accel == s ? c.force : c.accel)]) continue;
    }
    e.add(MatrixXd::Identity(sig.size, sig.size), s, M, e.row, R);
    e.row += sig.size;
  }
  if (e.row != e.unknowns) throw std::logic_error("oracle: the equations are not square");
}

}  // namespace

Eigen::MatrixXcd oracle_transfer(const titop::System& system, std::complex<double> s) {
  const titop::Graph& g = system.stage().graph;
  Equations e(system.stage(), number<Number>(s.real(), s.imag()));
  const int nz = g.outputs[0].size, nw = g.inputs[0].size;
  Rows M(e.unknowns, e.unknowns), v(e.unknowns, nw);
  add_rows(e, M, v);
  solve(std::move(M), v);
  Rows H(nz, e.unknowns), known(nz, nw);
  e.add(g.outputs[0].terms, H, 0, known);
  Eigen::MatrixXcd result(nz, nw);
  for (int i = 0; i < nz; ++i)
    for (int j = 0; j < nw; ++j) {
      Number sum = known(i, j);
      for (Eigen::Index k = 0; k < v.rows(); ++k) sum -= H(i, k) * v(k, j);
      result(i, j) = rounded(sum);
    }
  return result;
}

}  // namespace titop_bench
