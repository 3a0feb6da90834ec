#pragma once

#include <titop/compiler/solve/numbers.hpp>
#include <titop/compiler/system_data.hpp>

namespace titop::detail {

/// All signals of a compiled system at one instant: states and inputs are given, the factors find
/// the rest. One solution: O(bodies) per column.
class Instant {
 public:
  /// known: [x; u] with the states of all blocks, column by column. `more`: added to the right-hand
  /// sides of the joint system, where it is not empty.
  Instant(const SystemData& data, solve::RowMatrix<double> known,
          const solve::RowMatrix<double>& more = {});

  /// Of the joint system, in the order of Plan::first.
  const solve::RowMatrix<double>& unknowns() const { return unknowns_; }

  /// to += the signal, size x columns, row-major.
  void add_value(int signal, double* to) const { add_value(signal, unknowns_, known_, to); }

  /// All signals, one below the other: signal i from row first[i] on; first[signals] is the end.
  solve::RowMatrix<double> values(std::span<const int> first) const;

  /// Of all blocks' states: A x + B (inputs of the block).
  solve::RowMatrix<double> xdot() const;

  /// The diagram's outputs.
  solve::RowMatrix<double> outputs() const { return outputs_of(unknowns_, known_); }

  /// How far the unknowns are off, about: their change if every equation is off by what it does not
  /// hold to, and by about one unit of the last place of its terms, up or down in a fixed random
  /// order.
  solve::RowMatrix<double> doubt() const;
  /// What such a change of the unknowns does: to += that of the signal; that of all outputs.
  void add_change(int signal, const solve::RowMatrix<double>& change, double* to) const {
    add_value(signal, change, none_, to);
  }
  solve::RowMatrix<double> change_of_outputs(const solve::RowMatrix<double>& change) const {
    return outputs_of(change, none_);
  }

 private:
  solve::RowMatrix<double> outputs_of(const solve::RowMatrix<double>& unknowns,
                                      const solve::RowMatrix<double>& known) const;
  void add_value(int signal, const solve::RowMatrix<double>& unknowns,
                 const solve::RowMatrix<double>& known, double* to) const;

  const SystemData& data_;
  solve::JointRows<double> rows_;
  solve::RowMatrix<double> known_, none_;  ///< none_: 0 in place of known_
  solve::RowMatrix<double> rhs_, unknowns_;
};

}  // namespace titop::detail
