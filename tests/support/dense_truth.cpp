#include "support/dense_truth.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace titop_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop::Equation;
using titop::Graph;
using titop::Signal;
using titop::Term;
using Real = boost::multiprecision::cpp_bin_float_100;
using Number = boost::multiprecision::cpp_complex_100;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Number number(std::complex<double> z) { return Number(z.real(), z.imag()); }
std::complex<double> rounded(const Number& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}
Real size_of(const Number& z) {
  using boost::multiprecision::abs;
  const Real re = z.real(), im = z.imag();
  return abs(re) + abs(im);
}

/// Rows of E z = F, the right-hand sides behind the unknowns.
class Equations {
 public:
  Equations(Index unknowns, Index inputs) : n_(unknowns), width_(unknowns + inputs) {}

  /// A row of zeros more.
  Number* add() {
    rows_.emplace_back(at(width_), Number(0));
    return rows_.back().data();
  }
  Index count() const { return static_cast<Index>(rows_.size()); }
  /// As E and F, each row by itself over its largest entry.
  MatrixXcd rounded_rows() const {
    MatrixXcd m(count(), width_);
    for (Index i = 0; i < count(); ++i) {
      const Real most = largest(rows_[at(i)]);
      for (Index j = 0; j < width_; ++j) m(i, j) = rounded(rows_[at(i)][at(j)] / most);
    }
    return m;
  }

  /// E becomes the identity: z is at the end.
  void solve() {
    for (std::vector<Number>& row : rows_)
      if (const Real most = largest(row); most != 0)
        for (Number& x : row) x /= most;
    for (Index k = 0; k < n_; ++k) {
      Index best = k;
      for (Index i = k + 1; i < n_; ++i)
        if (size_of(entry(i, k)) > size_of(entry(best, k))) best = i;
      if (size_of(entry(best, k)) <= 1e-80) throw std::runtime_error("dense truth: a pole at s");
      std::swap(rows_[at(k)], rows_[at(best)]);
      for (Index i = k + 1; i < n_; ++i) subtract(k, i);
    }
    for (Index k = n_; k-- > 0;) {
      const Number pivot = entry(k, k);
      for (Index j = n_; j < width_; ++j) entry(k, j) /= pivot;
      entry(k, k) = Number(1);
      for (Index i = 0; i < k; ++i) subtract(k, i);
    }
  }
  Number& entry(Index i, Index j) { return rows_[at(i)][at(j)]; }

 private:
  Real largest(const std::vector<Number>& row) const {
    Real most = 0;
    for (Index j = 0; j < n_; ++j) most = std::max(most, size_of(row[at(j)]));
    return most;
  }
  /// Row k out of row i, so that the entry in column k becomes 0.
  void subtract(Index k, Index i) {
    if (entry(i, k) == Number(0)) return;
    const Number factor = entry(i, k) / entry(k, k);
    entry(i, k) = Number(0);
    for (Index j = k + 1; j < width_; ++j)
      if (entry(k, j) != Number(0)) entry(i, j) -= factor * entry(k, j);
  }

  Index n_, width_;
  std::vector<std::vector<Number>> rows_;
};

/// Rows spanning the orthogonal complement of these independent rows: unit vectors minus their
/// projection on the rows, the one with the largest remainder first [modified Gram-Schmidt, twice].
MatrixXd orthogonal(const MatrixXd& S, Index n) {
  MatrixXd basis = S.rowwise().normalized(), rest(0, n);
  while (basis.rows() < n) {
    Eigen::RowVectorXd best = Eigen::RowVectorXd::Zero(n);
    for (Index i = 0; i < n; ++i) {
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Unit(n, i);
      for (int pass = 0; pass < 2; ++pass)
        for (Index k = 0; k < basis.rows(); ++k) row -= row.dot(basis.row(k)) * basis.row(k);
      if (row.norm() > 1.1 * best.norm()) best = row;
    }
    for (MatrixXd* m : {&basis, &rest}) {
      m->conservativeResize(m->rows() + 1, n);
      m->bottomRows(1) = best.normalized();
    }
  }
  return rest;
}

class Assembly {
 public:
  Assembly(const Graph& graph, std::complex<double> s)
      : g_(graph), s_(number(s)), values_(titop::nominal_values(graph)) {
    for (const Signal& signal : g_.signals) {
      Index& count = signal.role == Signal::Role::external ? inputs_ : unknowns_;
      column_.push_back(count);
      count += signal.size;
    }
    first_output_ = unknowns_;
    for (const titop::Output& o : g_.outputs) unknowns_ += o.size;
    for (std::size_t i = 0; i < column_.size(); ++i)
      if (g_.signals[i].role == Signal::Role::external) column_[i] += unknowns_;
  }

  DenseTruth answer() {
    Equations rows(unknowns_, inputs_);
    rows_ = &rows;
    for (const titop::Node& node : g_.nodes) add_block(node);
    for (const titop::Channel& channel : g_.channels) add_channel(channel);
    for (const Equation& e : g_.equations)
      if (g_.signals[at(e.target)].channel < 0)
        add_definition(column_[at(e.target)], g_.signals[at(e.target)].size, e.terms);
    Index column = first_output_;
    for (const titop::Output& o : g_.outputs) {
      add_definition(column, o.size, o.terms);
      column += o.size;
    }
    if (rows.count() != unknowns_) throw std::runtime_error("dense truth: rows are not unknowns");
    const MatrixXcd rounded_rows = rows.rounded_rows();
    rows.solve();
    MatrixXcd z(unknowns_, inputs_);
    for (Index i = 0; i < unknowns_; ++i)
      for (Index j = 0; j < inputs_; ++j) z(i, j) = rounded(rows.entry(i, unknowns_ + j));
    const MatrixXcd E = rounded_rows.leftCols(unknowns_);
    const MatrixXd terms =
        Eigen::PartialPivLU<MatrixXcd>(E).inverse().cwiseAbs() * (E.cwiseAbs() * z.cwiseAbs());
    const Index outputs = unknowns_ - first_output_;
    return {z.bottomRows(outputs), terms.bottomRows(outputs)};
  }

 private:
  using Row = Number*;
  std::vector<Row> new_rows(Index count) {
    std::vector<Row> rows;
    for (Index i = 0; i < count; ++i) rows.push_back(rows_->add());
    return rows;
  }
  /// rows += factor * signal; an input is on the other side.
  void add(const std::vector<Row>& rows, const MatrixXd& factor, int signal,
           const Number& by = Number(1)) {
    const bool other = g_.signals[at(signal)].role == Signal::Role::external;
    for (Index i = 0; i < factor.rows(); ++i)
      for (Index j = 0; j < factor.cols(); ++j)
        if (factor(i, j) != 0) {
          const Number product = by * Number(factor(i, j));
          Number& x = rows[at(i)][column_[at(signal)] + j];
          other ? x -= product : x += product;
        }
  }
  /// rows -= factor * (sum of terms)
  void subtract(const std::vector<Row>& rows, const MatrixXd& factor,
                const std::vector<Term>& terms) {
    for (const Term& t : terms) {
      const MatrixXd c = -(factor * titop::coefficient(g_, t, values_));
      const Number by = t.of == Term::Of::position ? Number(Number(1) / Number(s_ * s_))
                        : t.of == Term::Of::rate   ? Number(Number(1) / s_)
                                                   : Number(1);
      add(rows, c, t.signal, by);
      if (t.of != Term::Of::reaction) continue;
      for (const Equation& e : g_.equations)  // a reaction is the force without added terms
        if (e.target == t.signal && e.accumulate && !e.of_block) subtract_equation(rows, c, e);
    }
  }
  void subtract_equation(const std::vector<Row>& rows, const MatrixXd& factor, const Equation& e) {
    if (e.part.whole())
      subtract(rows, factor, e.terms);
    else
      subtract(rows, factor * e.part.rows().transpose(), e.terms);
  }

  void add_block(const titop::Node& node) {
    const auto d = node.block->dynamics(values_);
    const Index n = d->A.rows();
    const MatrixXd one = MatrixXd::Identity(n, n);
    const std::vector<Row> states = new_rows(n);
    if (n > 0) add(states, one, node.state, s_), add(states, -d->A, node.state);
    for (int i = node.first_signal; i < node.end_signal; ++i)
      if (const Signal& u = g_.signals[at(i)]; n > 0 && u.role == Signal::Role::input)
        add(states, -d->B.middleCols(u.first, u.size), i);
    for (int o = node.first_signal; o < node.end_signal; ++o) {
      const Signal& y = g_.signals[at(o)];
      if (y.role != Signal::Role::output) continue;
      const std::vector<Row> rows = new_rows(y.size);
      add(rows, MatrixXd::Identity(y.size, y.size), o);
      if (n > 0) add(rows, -d->C.middleRows(y.first, y.size), node.state);
      for (int i = node.first_signal; i < node.end_signal; ++i)
        if (const Signal& u = g_.signals[at(i)]; u.role == Signal::Role::input)
          add(rows, -d->direct(y.first, u.first, y.size, u.size), i);
    }
  }

  /// Driven accelerations, and the sum of forces in all other directions.
  void add_channel(const titop::Channel& channel) {
    MatrixXd driven(0, channel.size);
    for (const Equation& e : g_.equations) {
      if (e.target != channel.accel || e.of_block) continue;
      const MatrixXd S =
          e.part.whole() ? MatrixXd::Identity(channel.size, channel.size) : e.part.rows();
      const std::vector<Row> rows = new_rows(S.rows());
      add(rows, S, channel.accel);
      subtract(rows, MatrixXd::Identity(S.rows(), S.rows()), e.terms);
      driven.conservativeResize(driven.rows() + S.rows(), channel.size);
      driven.bottomRows(S.rows()) = S;
    }
    const MatrixXd N = orthogonal(driven, channel.size);
    const std::vector<Row> rows = new_rows(N.rows());
    add(rows, N, channel.force);
    for (const Equation& e : g_.equations)
      if (e.target == channel.force && !e.of_block) subtract_equation(rows, N, e);
  }

  /// These unknowns = sum of terms.
  void add_definition(Index column, int size, const std::vector<Term>& terms) {
    const std::vector<Row> rows = new_rows(size);
    for (Index i = 0; i < size; ++i) rows[at(i)][column + i] += Number(1);
    subtract(rows, MatrixXd::Identity(size, size), terms);
  }

  const Graph& g_;
  Number s_;
  std::vector<double> values_;
  std::vector<Index> column_;  ///< first column of each signal
  Index unknowns_ = 0, inputs_ = 0, first_output_ = 0;
  Equations* rows_ = nullptr;
};

}  // namespace

DenseTruth dense_truth(const Graph& graph, std::complex<double> s) {
  return Assembly(graph, s).answer();
}

}  // namespace titop_test
