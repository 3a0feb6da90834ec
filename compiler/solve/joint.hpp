#pragma once

#include <cstdint>
#include <memory>
#include <titop/compiler/passes/stage.hpp>
#include <titop/compiler/solve/elimination.hpp>
#include <vector>

/// The joint system of all interface unknowns of a graph: block rows `y - D u = C x` and the
/// user's equations, with signals that an equation merely copies or rotates written out.
namespace titop::solve {

/// Coefficients of terms, row-major; shared between systems that differ elsewhere.
using Coefficient = std::shared_ptr<const RowMatrix<double>>;

/// Data that depend on parameters: one entry per node, and one per term (see JointSystem).
struct Numbers {
  std::vector<double> parameters;
  std::vector<std::shared_ptr<const Dynamics>> blocks;
  std::vector<Coefficient> coefficients;
};

/// sign * left * right * (variable, state or input).
struct Piece {
  enum class Left : std::int8_t {
    one,          ///< identity
    direct,       ///< a block of the node's direct term: D, or Y(s)
    state,        ///< rows of the node's C; at some s it is part of Y(s) and does not count
    coefficient,  ///< coefficients[left]
  };
  Left of = Left::one;
  std::int8_t sign = 1;
  int left = -1;                             ///< node, or index of a coefficient
  int row = 0, rows = 0, col = 0, cols = 0;  ///< the block of the node's matrix
  int right = -1;                            ///< coefficients[right]; -1: identity
  int entry = -1;                            ///< place in the row of the structure; -1: known
  int signal = -1;                           ///< the factor; -1: a partial sum
  int size = 0;                              ///< its scalars
};

/// A signal in terms of variables, states and inputs.
struct SignalTerm {
  int signal = -1;
  int coefficient = -1;  ///< -1: identity
};

/// Data that do not depend on numbers: variables, the meaning of every signal in terms of them,
/// rows, plan.
struct JointSystem {
  std::vector<int> variables;    ///< signal of each variable; -1: a partial sum of a long row
  std::vector<int> variable_of;  ///< signal -> variable, -1 if written out or known
  std::vector<int> meaning_begin = {0};
  std::vector<SignalTerm> meanings;  ///< of all signals, signal by signal
  std::vector<int> rows;             ///< Stage row of each row group
  std::vector<int> piece_begin = {0};
  std::vector<Piece> pieces;              ///< of all row groups
  std::vector<int> equation_coefficient;  ///< equation -> coefficient of its first term
  std::vector<int> output_coefficient;    ///< output -> the same
  std::shared_ptr<const Plan> plan;

  std::span<const SignalTerm> meaning(int signal) const {
    return of(signal, meanings, meaning_begin);
  }
  std::span<const Piece> row(int r) const { return of(r, pieces, piece_begin); }

 private:
  template <class List>
  static std::span<const typename List::value_type> of(int i, const List& all,
                                                       const std::vector<int>& begin) {
    const int* const b = begin.data() + i;
    return {all.data() + b[0], all.data() + b[1]};
  }
};

/// An equation for a whole signal whose terms are no targets is substituted (its pivot is 1 and
/// needs no search); all other signals remain unknowns: substituting further would be tearing.
/// Appends the coefficients of all terms to `coefficients`. O(terms) and the cost of the plan.
JointSystem joint(const Stage& stage, std::vector<Coefficient>& coefficients);

/// The same row-major; 1 and -1 are shared.
Coefficient coefficient_of(const Eigen::MatrixXd& c);

}  // namespace titop::solve
