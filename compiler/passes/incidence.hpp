#pragma once

#include <span>
#include <titop/compiler/passes/stage.hpp>
#include <vector>

namespace titop::passes {

/// The unknowns in each row, at one of two resolutions: whole signals, or scalars.
struct Incidence {
  std::vector<Row> rows;                    ///< row groups, canonical order
  std::vector<int> first_row, first_col;    ///< first vertex of each row group / of each signal
  std::vector<int> begin = {0}, mentioned;  ///< row vertex -> column vertices, see cols()
  std::vector<int> signal_of;               ///< column vertex -> signal
  std::vector<int> row_of_vertex;           ///< row vertex -> row group
  std::vector<int> row_size, col_size;      ///< scalars per vertex (1 at scalar resolution)

  int row_vertices() const { return static_cast<int>(row_size.size()); }
  /// Column vertices that a row vertex mentions, ascending.
  std::span<const int> cols(int row) const {
    const auto r = static_cast<std::size_t>(row);
    return {mentioned.data() + begin[r], static_cast<std::size_t>(begin[r + 1] - begin[r])};
  }
};

/// All active rows of the graph.
std::vector<Row> rows_of(const Graph& graph);

/// Dependence of a row: direct, or at some s, where a state depends on its inputs.
enum class Sight { at_once, through_states };

/// Declared structure of the active rows and unknowns. O(entries).
Incidence incidence(const Graph& graph, bool by_scalar, Sight sight = Sight::at_once);

/// Active signals, one by one, that a row mentions: unknowns, states and inputs. For graph walks;
/// consecutive rows of one node read its block once.
class Mentioned {
 public:
  explicit Mentioned(const Graph& graph) : g_(graph) {}
  /// Appends them to `to`.
  void add(const Row& row, std::vector<int>& to);

 private:
  void add_equation(int equation, std::vector<int>& to) const;

  const Graph& g_;
  int node_ = -1;  ///< whose patterns are at hand
  Pattern direct_ = {}, seen_ = {};
};
std::vector<int> mentioned(const Graph& graph, const Row& row);

/// True for signals that the equations determine: neither states nor external inputs.
inline bool is_unknown(const Signal& s) {
  return s.active && (s.role == Signal::Role::input || s.role == Signal::Role::output);
}

}  // namespace titop::passes
