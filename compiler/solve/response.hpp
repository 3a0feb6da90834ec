#pragma once

#include <boost/container/small_vector.hpp>
#include <titop/compiler/solve/numbers.hpp>

/// One block at one s. T is a scalar of any precision, complex or, for a real s, double.
namespace titop::detail {

/// (s - A)^-1 of a block, for any number of right-hand sides.
template <class T>
class Resolvent {
 public:
  /// Free for a body with modes; for other blocks one LU with row pivoting, part by part of the
  /// states (linalg::parts), in the states' own sizes: O(states^3). At a pole of the block the
  /// numbers are not finite.
  Resolvent(const Dynamics& dynamics, const T& s);

  /// True if that LU has a pivot of 0. With modes false.
  bool singular() const;

  /// (s - A)^-1 r, states x columns: O(states) per column with modes, else O(states^2). States that
  /// nothing in r reaches are 0 to the last bit.
  solve::Dense<T> times(solve::Dense<T> r) const;
  /// The same in place, r column-major.
  void apply(Eigen::Index columns, T* r) const;

 private:
  void apply_modes(Eigen::Index columns, T* r) const;

  const Modal* modal_;
  T s_;
  Eigen::Index n_;
  // Small blocks are many: no memory is allocated for them.
  boost::container::small_vector<T, 16> lu_;               ///< column-major; empty with modes
  boost::container::small_vector<Eigen::Index, 4> row_;    ///< that changed places with row k then
  boost::container::small_vector<Eigen::Index, 4> state_;  ///< of row k of `lu_`; empty: k itself
};

/// X = (s - A)^-1 B and Y = C X + D, or the closed form of a block without a finite state space; s
/// is that of a number in double. In double and below by the block's own formula, which cancels
/// least; in finer arithmetic from its modes, or from its matrices with up to 100 digits, if
/// these cancel, so that all digits of T are right. Throws singular if s is a pole of the block.
template <class T>
solve::BlockResponse<T> response(const Block& block, const Dynamics& dynamics, const T& s,
                                 ParameterValues parameters);

}  // namespace titop::detail
