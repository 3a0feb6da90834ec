#include "oracle.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

namespace titop_bench {

using Eigen::MatrixXd;
using titop::Dynamics;
using titop::Signal;

namespace {

using Number = boost::multiprecision::cpp_complex_100;
using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<150>>;

std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

/// Rows of numbers: what little is needed of a matrix.
class Table {
 public:
  Table(Eigen::Index rows, Eigen::Index cols)
      : rows_(rows), cols_(cols), values_(at(rows * cols), Number(0)) {}
  explicit Table(const MatrixXd& m) : Table(m.rows(), m.cols()) {
    for (Eigen::Index i = 0; i < rows_; ++i)
      for (Eigen::Index j = 0; j < cols_; ++j) (*this)(i, j) = Number(Real(m(i, j)));
  }
  Number& operator()(Eigen::Index i, Eigen::Index j) { return values_[at(i * cols_ + j)]; }
  const Number& operator()(Eigen::Index i, Eigen::Index j) const {
    return values_[at(i * cols_ + j)];
  }
  Eigen::Index rows() const { return rows_; }
  Eigen::Index cols() const { return cols_; }

 private:
  Eigen::Index rows_, cols_;
  std::vector<Number> values_;
};

/// Y = M^-1 Y by Gauss with partial pivoting.
void solve(Table M, Table& Y) {
  const Eigen::Index n = M.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < n; ++i)
      if (norm(M(i, k)) > norm(M(pivot, k))) pivot = i;
    if (M(pivot, k) == Number(0)) throw std::runtime_error("oracle: s is a pole");
    for (Eigen::Index j = 0; j < n; ++j) std::swap(M(k, j), M(pivot, j));
    for (Eigen::Index j = 0; j < Y.cols(); ++j) std::swap(Y(k, j), Y(pivot, j));
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == k || M(i, k) == Number(0)) continue;
      const Number factor = M(i, k) / M(k, k);
      for (Eigen::Index j = k; j < n; ++j) M(i, j) -= factor * M(k, j);
      for (Eigen::Index j = 0; j < Y.cols(); ++j) Y(i, j) -= factor * Y(k, j);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < Y.cols(); ++j) Y(i, j) /= M(i, i);
}

/// The block from its inputs to its outputs: rigid + W' s^2 / (s^2 + damping s + stiffness) W.
Table modal_response(const titop::Modal& m, const Number& s) {
  Table Y(m.rigid);
  const Table W(m.W);
  for (Eigen::Index k = 0; k < W.rows(); ++k) {
    const Number gain =
        s * s / (s * s + Number(Real(m.damping(k))) * s + Number(Real(m.stiffness(k))));
    for (Eigen::Index i = 0; i < Y.rows(); ++i)
      for (Eigen::Index j = 0; j < Y.cols(); ++j) Y(i, j) += W(k, i) * gain * W(k, j);
  }
  return Y;
}

Table response(const Dynamics& d, const Number& s) {
  if (d.modal) return modal_response(*d.modal, s);
  Table Y(d.D), X(d.B), M(MatrixXd(-d.A));
  for (Eigen::Index i = 0; i < M.rows(); ++i) M(i, i) += s;
  solve(std::move(M), X);
  for (Eigen::Index i = 0; i < Y.rows(); ++i)
    for (Eigen::Index j = 0; j < Y.cols(); ++j)
      for (Eigen::Index k = 0; k < X.rows(); ++k) Y(i, j) += Number(Real(d.C(i, k))) * X(k, j);
  return Y;
}

/// All signals in terms of the blocks' inputs v: M v = R w.
struct Equations {
  const titop::Stage& stage;
  std::vector<Table> responses = {};
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
  void add(const MatrixXd& factor, int signal, Table& to, Eigen::Index to_row, Table& known) const {
    const Signal& sig = stage.graph.signals[at(signal)];
    for (Eigen::Index i = 0; i < factor.rows(); ++i)
      for (Eigen::Index k = 0; k < factor.cols(); ++k) {
        const Number f(Real(factor(i, k)));
        if (f == Number(0)) continue;
        if (sig.role == Signal::Role::external)
          known(to_row + i, k) -= f;
        else if (sig.role == Signal::Role::input)
          to(to_row + i, first[at(sig.node)] + sig.first + k) += f;
        else
          add_row(f, sig, k, to, to_row + i);
      }
  }

  void add_row(const Number& f, const Signal& output, Eigen::Index k, Table& to,
               Eigen::Index to_row) const {
    const Table& Y = responses[at(output.node)];
    for (Eigen::Index j = 0; j < Y.cols(); ++j)
      to(to_row, first[at(output.node)] + j) += f * Y(output.first + k, j);
  }

  void add(const std::vector<titop::Term>& terms, Table& to, Eigen::Index to_row,
           Table& known) const {
    for (const titop::Term& t : terms)
      add(-coefficient(stage.graph, t, stage.values), t.signal, to, to_row, known);
  }
};

/// Every input that no equation drives, and whose channel none inverts, is 0.
void add_rows(Equations& e, Table& M, Table& R) {
  const titop::Graph& g = e.stage.graph;
  std::vector<char> driven(g.signals.size(), 0);
  for (const titop::Equation& equation : g.equations) {
    if (!equation.active) continue;
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
  Equations e(system.stage(), Number(Real(s.real()), Real(s.imag())));
  const int nz = g.outputs[0].size, nw = g.inputs[0].size;
  Table M(e.unknowns, e.unknowns), v(e.unknowns, nw);
  add_rows(e, M, v);
  solve(std::move(M), v);
  Table H(nz, e.unknowns), known(nz, nw);
  e.add(g.outputs[0].terms, H, 0, known);
  Eigen::MatrixXcd result(nz, nw);
  for (int i = 0; i < nz; ++i)
    for (int j = 0; j < nw; ++j) {
      Number sum = known(i, j);
      for (Eigen::Index k = 0; k < v.rows(); ++k) sum -= H(i, k) * v(k, j);
      result(i, j) = {static_cast<double>(sum.real()), static_cast<double>(sum.imag())};
    }
  return result;
}

}  // namespace titop_bench
