#pragma once

#include <titop/compiler/solve/elimination.hpp>

namespace titop::solve {

/// Many right-hand sides, each with a few rows that are not zero: what the dense model is written
/// from. Forward only along these rows' fronts and what is above them; backward with
/// -U^-1 (border of U) formed once per front. O(unknowns x front size) per column.
class Propagation {
 public:
  explicit Propagation(const Factors<double>& factors);

  /// What one solution needs; each thread has its own.
  struct Space {
    std::vector<double> z;         ///< the unknowns, in the order of Plan::first (unknowns x m)
    std::vector<int> active = {};  ///< fronts of the present right-hand sides
    std::vector<char> is_active = {};
    std::vector<double> rows = {}, carried = {};
    std::vector<char> is_set = {}, is_carried = {}, full = {};  ///< where rows are not zero
    std::vector<const double*> come = {};                       ///< the rows of the present front
  };

  /// Right-hand sides of these row groups, m columns each (a multiple of 8; row-major, group after
  /// group); the unknowns go to space.z.
  void solve(std::span<const int> row_groups, std::span<const double> rhs, std::ptrdiff_t m,
             Space& space) const;

 private:
  void activate(std::span<const int> row_groups, std::span<const double> rhs, std::ptrdiff_t m,
                Space& space) const;
  void gather(const Front& front, std::ptrdiff_t m, Space& space) const;
  void forward(int front, std::ptrdiff_t m, Space& space) const;
  void back_substitute(int front, std::ptrdiff_t m, std::vector<double>& z) const;

  const Factors<double>& factors_;
  const Plan& plan_;
  std::vector<std::size_t> begin_;  ///< per front: its part of border_
  std::vector<double> border_;      ///< -U^-1 (border of U), row-major
};

}  // namespace titop::solve
