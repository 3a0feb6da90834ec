#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <titop/compiler/solve/plan.hpp>
#include <titop/compiler/solve/storage.hpp>
#include <vector>

/// Elimination along the junctions: a row-merging LU of a block-sparse square system, front by
/// front in the order of the plan. Symmetry is not used: controllers and exchanged channels have
/// none, and pivots chosen by size keep digits that a fixed symmetric order would lose.
/// Instantiated for double, and for complex numbers of double, long double, double-double and 50
/// digits.
namespace titop::solve {

/// Source of the coefficients.
template <class T>
class Rows {
 public:
  virtual ~Rows() = default;
  /// Adds row group r to a front: entry k of it (Plan::structure) begins `column[k]` to the right
  /// of `at`, and rows are `stride` apart.
  virtual void add(int r, T* at, std::ptrdiff_t stride, const int* column) const = 0;
};

/// Numerical quality of the elimination.
struct Health {
  double growth = 1;   ///< largest size of a row met anywhere over the least that it had before,
                       ///< from front to front along the tree, in one scale of the unknowns
  double weakest = 1;  ///< smallest pivot over the sum of magnitudes that formed its row entry:
                       ///< 1 no cancellation, 1e-16 no digit; invariant under units
  int weakest_variable = -1;
  bool singular = false;  ///< a pivot without digits: `singular_variables` depend
  bool finite = true;     ///< false if numbers have overflown, first at `singular_variables`
  std::vector<int> singular_variables;
};

/// A pivot of less than this many units of rounding of its terms has no digit: 1e-14 of its terms
/// is a pivot of one to two digits, 1e-15 is rounding.
constexpr double kNothingLeft = 16;

/// Treatment of a column without a pivot that has a digit.
enum class NoPivot {
  stop,   ///< stop there: the factors are unusable
  patch,  ///< add one entry to the matrix and go on: the factors are of L + sum of patches;
          ///< entries at rounding level become 0, so that dependent rows and columns stay exact
};

/// An entry added to the matrix in place of a missing pivot.
struct Patch {
  int row = -1;      ///< scalar row, in the order of Plan::row_first
  int unknown = -1;  ///< scalar unknown, in the order of Plan::first
  double value = 1;  ///< of the size of its row and column
};

/// Powers of two that give columns the same size, one for all that share a unit: found once from
/// real numbers, and used for every s and for new values near the old ones. Within -1000 ... 1000.
struct ColumnScale {
  /// Each front by itself, front after front (Front::first_column): for the choice of pivots.
  /// Factors::changed recomputes them with `rescale`.
  std::vector<std::int16_t> in_fronts;
  /// Per unknown, in the order of Plan::first (solve/equilibration.hpp): the same in all fronts, so
  /// that sizes of rows in different fronts are comparable. The growth of a row is measured by it.
  std::vector<std::int16_t> of_unknowns;
};

/// A pivot must not be smaller than this share of the largest entry of its column, each relative to
/// the size that its row had before: no row grows by more than a factor 1 + 1 / kThreshold of that
/// per pivot, in any order of fronts (threshold pivoting: I. S. Duff, A. M. Erisman, J. K. Reid,
/// Direct Methods for Sparse Matrices, 5.4, which recommends 0.1).
constexpr double kThreshold = 0.1;

/// The factors: per front L, U and the permutation. Fronts are shared between factors that differ
/// elsewhere; those that are made together share their memory, too, in the order in which they are
/// visited. It is kept while one of them is in use, up to twice the size of all fronts.
template <class T>
class Factors {
 public:
  /// Factors the system. O(sum of front sizes^3). `scale`: of a similar system; found if absent.
  /// `least`: share of its terms that a pivot has to keep; never less than kNothingLeft units of
  /// rounding.
  Factors(std::shared_ptr<const Plan> plan, const Rows<T>& rows,
          std::shared_ptr<const ColumnScale> scale = nullptr, NoPivot no_pivot = NoPivot::stop,
          double least = 0);

  /// The factors if only these row groups have new coefficients: the fronts that they enter and
  /// all above are made again, the others shared. O(those fronts) and one pointer per front; now
  /// and then (see above) all numbers are copied.
  /// `rescale`: they find their columns' scale anew, as a constructor would; one number per column.
  Factors changed(const Rows<T>& rows, std::span<const int> row_groups, bool rescale = false) const;

  /// Solves for right-hand sides (unknowns x m, in the order of Plan::row_first); returns the
  /// unknowns (in the order of Plan::first). O(sum of front sizes^2) per column.
  RowMatrix<T> solve(const RowMatrix<T>& rhs) const;
  /// Solves with the transposed matrix, by the same fronts walked the other way: right-hand sides
  /// in the order of the unknowns (Plan::first), solutions in the order of the rows
  /// (Plan::row_first). The same cost.
  RowMatrix<T> solve_transposed(const RowMatrix<T>& rhs) const;

  Health health() const;
  const Plan& plan() const { return *plan_; }
  const std::shared_ptr<const ColumnScale>& scale() const { return scale_; }
  int fronts_made() const { return made_; }  ///< by the constructor or by changed()
  /// Entries in the fronts' memory: those in use (Plan::entries), and at most as many that
  /// newer ones have replaced.
  std::size_t entries_held() const;
  /// Entries added where the matrix had no pivot (NoPivot::patch): at least its rank deficiency.
  std::vector<Patch> patches() const;

  /// One front's numbers.
  struct Made {
    int front = -1;
    bool singular = false, finite = true;
    std::span<const T> lu = {};  ///< row_count x columns, row-major; rows left over at the bottom
    std::span<const int> order = {};  ///< assembled row at place i
    /// Per row left over: the least size that it has had, by ColumnScale::of_unknowns.
    std::span<const double> least_size = {};
    /// Per remaining row the ratio of its size to its terms after cancellation; none: all 1.
    std::vector<double> keeps = {};
    double growth = 1, weakest = 1;
    int weakest_column = -1;
    std::vector<std::pair<int, double>> patched = {};  ///< column without pivot, its patch
  };
  const Made& made(std::size_t front) const { return *fronts_[front]; }

 private:
  struct Work;
  /// Fronts that are made together, and the memory of their numbers.
  struct Lot {
    std::vector<Made> made;
    Storage<T> entries;
    Storage<int> rows;
    Storage<double> sizes;
  };

  std::shared_ptr<Lot> lot_of(std::span<const int> fronts) const;
  void make(Lot& lot, Made& made, const Rows<T>& rows, Work& work, ColumnScale* found);
  void make_all(std::span<const int> fronts, const Rows<T>& rows, ColumnScale* found);
  void tidy();
  void assemble(const Front& front, const Rows<T>& rows, Work& work) const;
  int original_row(int front, int place) const;

  std::shared_ptr<const Plan> plan_;
  std::shared_ptr<const ColumnScale> scale_;
  std::vector<const Made*> fronts_;               ///< null above a singular one
  std::vector<std::shared_ptr<const Lot>> lots_;  ///< owners of their numbers
  NoPivot no_pivot_ = NoPivot::stop;
  double least_ = 0;
  int made_ = 0;
  int singular_ = -1;  ///< first singular front
};

}  // namespace titop::solve
