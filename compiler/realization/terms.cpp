#include <titop/compiler/realization/terms.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Target = Writing::Target;
using TargetTerm = Writing::TargetTerm;
using linalg::at;

const solve::RowMatrix<double>& coefficient(const Factored& d, int i) {
  return *d.numbers.coefficients[at(i)];
}

/// to += factor * the coefficient `times`; -1: the identity.
template <class Factor, class To>
void add_product(const Factored& d, const Factor& factor, int times, To to) {
  if (times < 0)
    to += factor;
  else
    to += factor.lazyProduct(coefficient(d, times));
}

template <class To>
void add_term(const Factored& d, const Target& t, const TargetTerm& term, To to) {
  if (term.node < 0) return add_product(d, coefficient(d, term.coefficient), term.times, to);
  const MatrixXd& B = d.numbers.blocks[at(term.node)]->B;
  add_product(d, B.block(t.still, term.column, t.rows, term.size), term.times, to);
}

Index size(const Factored& d, const TargetTerm& term) {
  return term.times < 0 ? term.size : coefficient(d, term.times).cols();
}

}  // namespace

void find_coefficients(const Factored& d, const Writing& writing, double* to) {
  for (const Target& t : writing.targets)
    for (const TargetTerm& term : t.terms)
      if (!term.known)
        add_term(d, t, term,
                 Eigen::Map<solve::RowMatrix<double>, 0, Eigen::OuterStride<>>(
                     to + t.coefficients + term.to, t.rows, size(d, term),
                     Eigen::OuterStride<>(t.inner)));
}

void add_direct_terms(const Factored& d, const Writing& writing, StateSpace& model) {
  const Index states = d.layout().order();
  for (const Target& t : writing.targets) {
    const bool state = t.row < states;
    const Index row = state ? t.row : t.row - states;
    for (const TargetTerm& term : t.terms) {
      if (!term.known) continue;
      const bool of_state = term.to < states;
      MatrixXd& to = of_state ? (state ? model.A : model.C) : (state ? model.B : model.D);
      add_term(d, t, term,
               to.block(row, of_state ? term.to : term.to - states, t.rows, size(d, term)));
    }
  }
}

}  // namespace titop::detail
