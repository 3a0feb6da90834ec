#pragma once

#include <titop/compiler/solve/backward_error.hpp>
#include <titop/compiler/solve/instant_in.hpp>

namespace titop::detail {

/// All signals of a compiled system at one instant: states and inputs are given, the factors find
/// the rest. One solution: O(bodies) per column.
class Instant {
 public:
  /// known: [x; u] with the states of all blocks, column by column. `more`: added to the right-hand
  /// sides of the joint system, if it is not empty.
  Instant(const Factored& data, solve::RowMatrix<double> known,
          const solve::RowMatrix<double>& more = {},
          solve::Refinement refinement = solve::Refinement::none);

  /// Unknowns of the joint system, in the order of Plan::first.
  const solve::RowMatrix<double>& unknowns() const { return now_.unknowns; }

  /// Whether they solve the equations to rounding (RefinedSolution::holds). Free if refinement has
  /// come to that.
  bool holds() const;

  /// to += the signal, size x columns, row-major.
  void add_value(int signal, double* to) const { now_.add_value(signal, to); }

  /// All signals, one below the other: signal i from row first[i] on; first[signals] is the end.
  solve::RowMatrix<double> values(std::span<const int> first) const;

  /// Derivatives of all blocks' states: A x + B (inputs of the block).
  solve::RowMatrix<double> xdot() const;

  /// The diagram's outputs.
  solve::RowMatrix<double> outputs() const;

  /// Sums of the magnitudes of the terms that xdot and the outputs are made of.
  solve::RowMatrix<double> xdot_terms() const;
  solve::RowMatrix<double> outputs_terms() const;

  /// Forward error estimate of all signals, as a separate instant (known signals 0): from the
  /// residual of every equation plus about one unit of the last place of its terms, up or down in a
  /// random order, fixed for each `sample`. One more solution.
  Instant doubt(int sample = 0) const;
  /// The same with errors relative to the norm of every translation and rotation, not per
  /// component: after a rotation by a right angle rounding may have any direction.
  Instant doubt_of_vectors(int sample) const;
  /// The same of rounding alone, without the residual.
  Instant rounding() const;

 private:
  /// Every equation is off by this, and by one unit of the last place of its terms.
  Instant off_by(solve::RowMatrix<double> off, solve::RowMatrix<double> magnitudes,
                 int sample) const;

  InstantIn<double> now_;
  solve::RowMatrix<double> rhs_;
  bool to_rounding_ = false;  ///< their backward error
};

}  // namespace titop::detail
