#pragma once

#include <optional>
#include <titop/compiler/solve/joint.hpp>
#include <utility>

namespace titop::solve {

/// Column-major matrix of the scalar.
template <class T>
using Dense = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// A block at one s.
template <class T>
struct BlockResponse {
  Dense<T> X;  ///< inputs to states
  Dense<T> Y;  ///< inputs to outputs
};

/// The matrices of all nodes, by node: D and C for the state space (states are known), or Y(s) and
/// X(s) at one s (states are written out by the inputs that move them).
template <class T>
struct Matrices {
  std::vector<const Dense<T>*> direct;  ///< D or Y(s)
  std::vector<const Dense<T>*> output;  ///< C; empty at one s
  std::vector<const Dense<T>*> states;  ///< X(s); empty for the state space
};

/// The rows of the joint system with numbers.
template <class T>
class JointRows : public Rows<T> {
 public:
  JointRows(const Graph& graph, const JointSystem& joint,
            const std::vector<Coefficient>& coefficients, Matrices<T> matrices)
      : graph_(graph), joint_(joint), coefficients_(coefficients), m_(std::move(matrices)) {}

  void add(int r, T* at, std::ptrdiff_t stride, const int* column) const override;

  /// Right-hand sides, in the order of Plan::row_first, for known signals (inputs, and states where
  /// these are known): signal i has the rows of `known` from first[i] on. O(rows) per column.
  RowMatrix<T> rhs(const RowMatrix<T>& known, std::span<const int> first) const;

  /// Sums of the magnitudes of the terms of `rhs`, to which its rounding is relative. O(rows).
  RowMatrix<double> rhs_terms(const RowMatrix<T>& known, std::span<const int> first) const;

  /// Right-hand sides of all rows for given parts of the states (C of every block in `output`),
  /// whether or not states are otherwise substituted: the effect of forced states. O(rows).
  RowMatrix<T> rhs_of_states(const RowMatrix<T>& states, std::span<const int> first,
                             const std::vector<const Eigen::MatrixXd*>& output) const;

  /// rhs - (these rows) * unknowns: the residual of every row. `magnitudes`, if given, becomes
  /// |rhs| + |rows| |unknowns|: the size of its terms. O(rows) per column.
  RowMatrix<T> residual(const RowMatrix<T>& rhs, const RowMatrix<T>& unknowns,
                        RowMatrix<double>* magnitudes = nullptr) const;

  /// The same of the transposed system, whose rows are the unknowns: rhs - (these rows)' *
  /// solutions.
  RowMatrix<T> transposed_residual(const RowMatrix<T>& rhs, const RowMatrix<T>& solutions,
                                   RowMatrix<double>* magnitudes = nullptr) const;

  /// known += (the matrix of `rhs`)' * solutions, at one s.
  void add_transposed_rhs(const RowMatrix<T>& solutions, std::span<const int> first,
                          RowMatrix<T>& known) const;

  /// unknowns and known += (the matrix of `add_value`)' * weights; signal size x columns,
  /// row-major.
  void add_transposed_value(int signal, const T* weights, std::span<const int> first,
                            RowMatrix<T>& unknowns, RowMatrix<T>& known) const;

  /// signal += its meaning in unknowns and known signals; `to`: signal size x columns, row-major.
  void add_value(int signal, const RowMatrix<T>& unknowns, const RowMatrix<T>& known,
                 std::span<const int> first, T* to) const;

  /// All signals, one below the other: signal i from row place[i] on; place[signals] is the end.
  RowMatrix<T> values(const RowMatrix<T>& unknowns, const RowMatrix<T>& known,
                      std::span<const int> first, std::span<const int> place) const;

 private:
  /// A state, at one s.
  bool written_out(const Piece& p) const {
    return !m_.states.empty() &&
           graph_.signals[static_cast<std::size_t>(p.signal)].role == Signal::Role::state;
  }
  void add_state(const Piece& p, int r, T* to, std::ptrdiff_t stride, const int* column) const;
  void subtract_known(const Piece& p, const RowMatrix<T>& known, std::span<const int> first,
                      T* to) const;
  template <class Visit>
  void by_inputs(const Piece& p, Visit visit) const;
  std::optional<std::pair<double, T>> number(const Piece& p) const;
  template <class Take, class TakeNumber>
  void by_products(Take take, TakeNumber take_number) const;

  const Graph& graph_;
  const JointSystem& joint_;
  const std::vector<Coefficient>& coefficients_;
  Matrices<T> m_;
};

}  // namespace titop::solve
