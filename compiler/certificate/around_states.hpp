#pragma once

#include <map>
#include <titop/compiler/certificate/surroundings.hpp>
#include <titop/compiler/solve/evaluate.hpp>

namespace titop::detail {

/// Size around the states of all blocks at a real s: see Surroundings. For the compiler's own files
/// only.
class AroundStates {
 public:
  /// One column; d and point must outlive this object.
  AroundStates(const Factored& d, const Evaluation<double>& point, double s)
      : d_(d), point_(point), s_(s), around_(d, point.unknowns()) {}

  /// `off`: differences of the outputs y, 0 where an output is 0 because states cancel (the
  /// rotation of a body is a sum of angles), or by symmetry (Factored::zero_blocks, if a difference
  /// above kWarn remains). O(outputs), and a response of each block that they see.
  solve::RowMatrix<double> without_zeros(const solve::RowMatrix<double>& y,
                                         solve::RowMatrix<double> off);

 private:
  /// Row by row, of the states that output o is a sum of.
  Eigen::VectorXd of_output(std::size_t o);
  /// The block's response to the sizes around its inputs; at least the states themselves.
  const Eigen::VectorXd& of_states(int states);

  const Factored& d_;
  const Evaluation<double>& point_;
  double s_;
  Surroundings around_;
  std::map<int, Eigen::VectorXd> sizes_ = {};
};

}  // namespace titop::detail
