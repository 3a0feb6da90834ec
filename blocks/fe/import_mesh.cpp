#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <titop/blocks/fe/import_mesh.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::fe {

namespace {

/// A scalar point may have the number of a grid.
bool has_rows(const GridMatrices& m, const Grid& grid) {
  return std::ranges::any_of(
      m.dofs, [&](const GridDof& dof) { return dof.component > 0 && dof.grid == grid.id; });
}

/// The grid of the parent port, or else those with the most components; 0 if there are none.
std::vector<int> references(const GridMatrices& m, const std::string& parent) {
  int grid = 0;
  if (const auto end = parent.data() + parent.size();
      !parent.empty() && std::from_chars(parent.data(), end, grid).ptr == end)
    return {grid};
  std::map<int, int> components;
  int most = 0;
  for (const GridDof& dof : m.dofs)
    if (dof.component > 0) most = std::max(most, ++components[dof.grid]);
  std::vector<int> grids;
  for (const auto& [id, count] : components)
    if (count == most) grids.push_back(id);
  if (grids.empty()) grids.push_back(0);
  return grids;
}

/// From the first of ten grids, spread over all, from which it works: a soft part of the structure
/// gives no positions, and its grids have neighbouring numbers.
std::vector<Grid> by_statics(const GridMatrices& m, const std::string& parent, std::string& text) {
  const std::vector<int> all = references(m, parent);
  const std::size_t tries = std::min<std::size_t>(all.size(), 10);
  for (std::size_t i = 0;; ++i) try {
      const int from = all.at(i * all.size() / tries);
      std::vector<Grid> grids = grids_by_statics(m, from);
      const Grid& worst = *std::ranges::max_element(grids, {}, &Grid::noise);
      text += fmt::format("positions by statics, from grid {}: not rigid by {:.1e}, at grid {}\n",
                          from, worst.noise, worst.id);
      return grids;
    } catch (const Error&) {
      if (i + 1 == tries) throw;
    }
}

}  // namespace

std::vector<Grid> with_rows(std::vector<Grid> grids, const GridMatrices& m) {
  std::erase_if(grids, [&](const Grid& g) { return !has_rows(m, g); });
  return grids;
}

Mesh mesh_of_matrices(GridMatrices m, std::vector<Grid> grids, const std::string& parent,
                      std::string& text) {
  const std::vector<GridDof> empty = empty_rows(m);
  std::vector<std::string> dropped;
  for (const GridDof& dof : empty)
    dropped.push_back(dof.component > 0 ? fmt::format("{}.{}", dof.grid, dof.component)
                                        : fmt::format("scalar {}", dof.grid));
  if (!empty.empty())
    text += fmt::format("dropped, without stiffness and mass: {} rows, {}\n", empty.size(),
                        titop::detail::some_names(dropped));
  m = without(std::move(m), empty);
  if (grids.empty()) grids = by_statics(m, parent, text);
  return to_mesh(m, with_rows(std::move(grids), m));
}

}  // namespace titop::fe
