#pragma once

#include <cstddef>
#include <span>
#include <vector>

/// The order of elimination, decided by structure alone and reused for every value.
///
/// The system is a list of row groups, each over a few variable groups (port signals of 1 or 6
/// scalars). To eliminate a variable, ALL rows that mention it are gathered into one small dense
/// front; as many pivots as it (and every variable that is now in this front alone) has
/// scalars are taken there by row pivoting, and the remaining rows are passed to the next front.
/// Every pivot search thus covers the whole column: a weak pivot is never forced, no pivot is
/// delayed, and bodies of very different mass are compared only with their neighbours. On a tree of
/// bodies this is the leaf-to-root recursion, one front per junction, O(bodies).
///
/// Order: the variable whose front would be smallest comes next (minimum degree on the merged
/// rows, by priority queue), ties by index; indices follow the names, so the order does too. Pivots
/// of one front: vectors before scalars, then by index. If that leads to wide fronts (grids,
/// many loops) nested dissection is tried as well, with minimum degree inside its parts, and the
/// order of less work taken.
namespace titop::solve {

/// The variables of each row group.
struct Structure {
  std::vector<int> variable_size;    ///< scalars of each variable group
  std::vector<int> variable_unit;    ///< of them share a unit: 3 of a twist or wrench, else 1
  std::vector<int> row_size;         ///< scalars of each row group
  std::vector<int> row_begin = {0};  ///< row group r has entries row_begin[r] ... row_begin[r + 1]
  std::vector<int> variables;        ///< of all row groups, without repetition, ascending in each

  /// One more variable group; `unit`: see variable_unit.
  void add_variable(int size, int unit = 1);

  /// One more row group of `size` scalars over these variables, in any order, repeated or not.
  void add_row(int size, std::span<const int> over);
  std::span<const int> row(int r) const {
    const int* const begin = row_begin.data() + r;
    return {variables.data() + begin[0], variables.data() + begin[1]};
  }
};

/// One dense front. Ranges of Plan::lists.
struct Front {
  struct Range {
    int begin = 0, count = 0;
  };
  Range rows;      ///< row groups that enter here for the first time
  Range children;  ///< fronts whose rows left over enter here
  Range pivots;    ///< variables eliminated here
  Range border;    ///< variables that remain, eliminated further up
  int row_count = 0, pivot_count = 0, border_count = 0;  ///< scalars
  int parent = -1;        ///< the front that takes the rows left over; -1 if there are none
  int first_unknown = 0;  ///< place of the first pivot among the unknowns
  int first_carried = 0;  ///< place of the first row left over among all such rows
  int first_column = 0;   ///< place of the first column among those of all fronts

  int columns() const { return pivot_count + border_count; }
  int left_over() const { return row_count - pivot_count; }
  std::size_t entries() const {
    return static_cast<std::size_t>(row_count) * static_cast<std::size_t>(columns());
  }
};

/// Fronts in postorder, children before parents, with the places of their data.
struct Plan {
  Structure structure;
  std::vector<Front> fronts;
  std::vector<int> lists;      ///< of the fronts' ranges
  std::vector<int> first;      ///< variable -> its first scalar among the unknowns, in the order of
                               ///< elimination
  std::vector<int> row_first;  ///< row group -> its first scalar among all rows
  std::vector<int> front_of_row;   ///< row group -> the front where it enters
  std::vector<int> entry_column;   ///< entry of the structure -> first column in that front
  std::vector<int> parent_column;  ///< parallel to `lists`, for borders: first column in the parent
  int unknowns = 0, carried = 0, columns = 0;
  std::size_t entries = 0;  ///< of all fronts

  std::span<const int> list(Front::Range r) const {
    return {lists.data() + r.begin, static_cast<std::size_t>(r.count)};
  }
};

/// Makes the plan. The structure must have a perfect matching (pass `match`). O(fronts log fronts)
/// times the front size; a variable that very many rows mention (a hub's acceleration) costs its
/// own number of rows once.
Plan plan(Structure structure);

}  // namespace titop::solve
