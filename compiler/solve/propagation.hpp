#pragma once

#include <titop/compiler/solve/elimination.hpp>

namespace titop::solve {

/// Many right-hand sides, each with a few rows that are not zero: what the dense model is written
/// from. Forward only along these rows' fronts and what is above them. Each front becomes a few
/// small products, formed once: its rows split into those of the pivots, r, and the rest, r', it
/// carries r' - L' L^-1 r upwards, and on the way back its unknowns are
/// U^-1 L^-1 r - U^-1 (border of U) (border unknowns). O(unknowns x front size) per column.
class Propagation {
 public:
  /// `room`: where the products go; it must live as long, and is not cleared. `form` comes next.
  Propagation(const Factors<double>& factors, std::vector<double>& room);

  /// Forms the products of all fronts. O(sum of front sizes^3).
  void form();

  /// What one solution needs; each thread has its own.
  struct Space {
    std::vector<double> z;         ///< the unknowns, in the order of Plan::first (unknowns x m)
    std::vector<int> active = {};  ///< fronts of the present right-hand sides
    std::vector<char> is_active = {};
    std::vector<double> rows = {}, carried = {}, pivot_rows = {};
    std::vector<char> is_set = {}, is_carried = {};  ///< where rows are not zero
    std::vector<const double*> come = {};            ///< the rows of the present front
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
  void add_border(int front, std::ptrdiff_t m, bool add, std::vector<double>& z) const;
  void form(std::size_t front);

  /// Where a front's matrices begin, row-major one after the other, rows padded to 8.
  struct Place {
    std::ptrdiff_t by_pivots = 0, by_border = 0;  ///< from row to row
    std::size_t own = 0;                          ///< U^-1 L^-1: pivots x pivots
    std::size_t carry = 0;                        ///< -L' L^-1: rows left over x pivots
    std::size_t border = 0;                       ///< -U^-1 (border of U): pivots x border
  };

  const Factors<double>& factors_;
  const Plan& plan_;
  std::vector<Place> place_;
  std::vector<double>& formed_;
};

}  // namespace titop::solve
