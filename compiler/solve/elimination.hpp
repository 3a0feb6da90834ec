#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

/// Elimination along the junctions: a row-merging LU of a block-sparse square system.
///
/// The system is a list of row groups, each over a few variable groups (port signals of 1 or 6
/// scalars). To eliminate a variable, ALL rows that mention it are gathered into one small dense
/// front; as many pivots as it (and every variable that now stands in this front alone) has
/// scalars are taken there by row pivoting, and the rows left over go on to the next front. So
/// every pivot search sees the whole column: a weak pivot is never forced, there is nothing to
/// delay, and bodies of very different mass are compared only with their neighbours. On a tree of
/// bodies this is the leaf-to-root recursion, one front per junction, O(bodies).
///
/// Order: the variable whose front would be smallest comes next (minimum degree on the merged
/// rows, by priority queue), ties by index; indices follow the names, so the order does too.
namespace titop::solve {

/// Structure: which variables each row group mentions.
struct Structure {
  std::vector<int> variable_size;           ///< scalars of each variable group
  std::vector<int> row_size;                ///< scalars of each row group
  std::vector<std::vector<int>> variables;  ///< per row group, without repetition
};

/// One dense front.
struct Front {
  std::vector<int> rows;      ///< row groups that enter here for the first time
  std::vector<int> children;  ///< fronts whose rows left over enter here
  std::vector<int> pivots;    ///< variables eliminated here
  std::vector<int> border;    ///< variables that remain, eliminated further up
  int row_count = 0, pivot_count = 0, border_count = 0;  ///< scalars
};

/// The order of elimination: fronts, children before parents. Reused for every value.
struct Plan {
  Structure structure;
  std::vector<Front> fronts;
  int unknowns = 0;
  std::vector<int> first;  ///< first scalar of each variable
};

/// Makes the plan. The structure must have a perfect matching (pass `match`).
/// O(fronts log fronts) times the front size.
Plan plan(Structure structure);

/// Entries of one row group: coefficient blocks, in the order of Structure::variables.
template <class T>
using RowEntries = std::vector<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>;

/// How the numbers went.
struct Health {
  double growth = 1;   ///< largest entry met in a front over the largest at its start
  double weakest = 1;  ///< smallest pivot over the sum of magnitudes that formed its row entry:
                       ///< 1 no cancellation, 1e-16 nothing left; invariant under units
  int weakest_variable = -1;
  bool singular = false;  ///< a pivot with no digits left: `singular_variables` depend
  std::vector<int> singular_variables;
};

/// The factors: per front L, U and the permutation.
template <class T>
class Factors {
 public:
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

  /// Factors the system; entries[r] belongs to row group r. O(sum of front sizes^3).
  Factors(const Plan& plan, const std::vector<RowEntries<T>>& entries);

  /// Solves for right-hand sides given row group by row group (size x m each; empty means 0);
  /// returns all unknowns (unknowns x m). O(sum of front sizes^2) per column.
  Matrix solve(const std::vector<Matrix>& rhs, Eigen::Index columns) const;

  const Health& health() const { return health_; }

 private:
  struct Factored {
    Matrix lu;               ///< row_count x (pivot_count + border_count), rows permuted
    std::vector<int> order;  ///< order[i]: which assembled row stands at place i
  };
  /// Rows on their way from one front to the next.
  struct LeftOver {
    Matrix rows;
    Eigen::VectorXd
        keeps;  ///< per row: 1, or what cancellation has left of it where that is little
  };
  Matrix assemble(const Front& front, const std::vector<RowEntries<T>>& entries,
                  std::vector<LeftOver>& left_over, Eigen::VectorXd& keeps) const;
  void eliminate(const Front& front, Factored& f, Eigen::VectorXd& keeps);
  void note_weakest(const Front& front, int column, double left);

  const Plan* plan_;
  std::vector<Factored> fronts_;
  Health health_;
};

}  // namespace titop::solve
