#pragma once

#include <titop/compiler/solve/elimination.hpp>

namespace titop::solve {

/// Many right-hand sides, each with a few nonzero rows, for the dense model. Forward only along
/// these rows' fronts and their ancestors. Each front has a few small matrices, formed once: with
/// its rows split into those of the pivots, r, and the rest, r', it passes r' - L' L^-1 r upwards,
/// and its unknowns are U^-1 (L^-1 r - (border of U) (border unknowns)). L^-1 is formed, as its
/// multipliers are bounded; U^-1 is not: of a front with unlike pivots the error of its entries
/// grows with the square of their ratio. O(unknowns x front size) per column.
class Propagation {
 public:
  /// `room`: memory of the products; it must outlive this object, and is not cleared. Call `form`
  /// next.
  Propagation(const Factors<double>& factors, std::vector<double>& room);

  /// Forms the products of all fronts, here the k-th of `parts` parts. O(sum of front sizes^3).
  void form(int k = 0, int parts = 1);

  /// Buffers of one solution; each thread has its own.
  struct Space {
    std::ptrdiff_t m = 0;                             ///< columns
    std::vector<double> z = {};                       ///< the unknowns, in the order of Plan::first
    std::vector<double> rows = {}, carried = {};      ///< right-hand sides; sums upwards
    std::vector<double> zeros = {};                   ///< one row
    std::vector<int> set = {}, active = {};           ///< row groups with right-hand sides; fronts
    std::vector<char> is_set = {}, is_active = {};    ///< the same as flags
    std::vector<char> is_carried = {};                ///< where rows are not zero
    std::vector<const double*> come = {};             ///< the rows of the present front
    std::vector<const double*> from = {}, with = {};  ///< rows of a product
    std::vector<const double*> pivots = {};           ///< rows of the pivots of active fronts
    std::vector<int> used = {};  ///< per front: how many of its `pivots` may not be 0
  };

  /// The next solution has m columns, a multiple of 8, and no right-hand sides yet.
  void begin(std::ptrdiff_t m, Space& space) const;

  /// Right-hand sides of a row group (its rows x m, row-major), to add to: 0 at first.
  double* rhs(int row_group, Space& space) const;

  /// The unknowns (unknowns x m, row-major) go to space.z.
  void solve(Space& space) const;

 private:
  void activate(Space& space) const;
  void gather(const Front& front, Space& space) const;
  void forward(int front, Space& space) const;
  void back(int front, Space& space) const;
  void order_columns(std::size_t front);
  void form_front(std::size_t front);

  /// Places of a front's matrices, row-major.
  struct FrontPlace {
    std::ptrdiff_t by_pivots = 0, by_all = 0;  ///< from row to row; the first a multiple of 8
    std::size_t lower = 0;                     ///< L^-1, and below it -L' L^-1: rows x pivots
    std::size_t unknowns = 0;  ///< -(border of U), and to its right L^-1: pivots x both
    int carried = 0;           ///< pivots' rows that came from children: the first columns
  };

  const Factors<double>& factors_;
  const Plan& plan_;
  std::vector<FrontPlace> place_;
  std::vector<int> column_;  ///< pivot -> column of L^-1
  std::vector<double>& formed_;
};

}  // namespace titop::solve
