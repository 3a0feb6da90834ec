#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/close/relations.hpp>

namespace titop::passes::closing {
namespace {

using Eigen::Index;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Factors for rows (those of one number together) and for columns, each from what has its factor
/// already, so that none depends on units: columns that store energy begin; then come, in turn, the
/// rows that they reach, the columns that these reach, and so on.
struct Scaling {
  Relations& r;
  Factors f;
  std::vector<char> column_done = std::vector<char>(r.role.size(), 0);

  struct Row {
    int block = 0;
    Index row = 0;
  };
  std::vector<std::vector<Row>> rows_of = {};  ///< by number
  std::vector<char> unit_done = {};
  std::vector<std::vector<int>> units_of = {};  ///< per column: numbers of the rows that reach it

  explicit Scaling(Relations& relations) : r(relations) {
    f.column = Eigen::VectorXd::Ones(static_cast<Index>(r.role.size()));
    units_of.resize(r.role.size());
    for (std::size_t b = 0; b < r.blocks.size(); ++b) {
      f.row.push_back(Eigen::VectorXd::Ones(r.blocks[b].M.rows()));
      for (Index i = 0; i < r.blocks[b].M.rows(); ++i) list(static_cast<int>(b), i);
    }
    unit_done.assign(rows_of.size(), 0);
  }
  void list(int b, Index i) {
    const RowBlock& block = r.blocks[at(b)];
    const int unit = r.unit[at(b)][at(i)];
    if (at(unit) >= rows_of.size()) rows_of.resize(at(unit) + 1);
    rows_of[at(unit)].push_back({b, i});
    for (std::size_t k = 0; k < block.columns.size(); ++k)
      if (auto& units = units_of[at(block.columns[k])];
          block.M(i, static_cast<Index>(k)) != 0 && (units.empty() || units.back() != unit))
        units.push_back(unit);
  }
  double entry(const Row& row, std::size_t k) const {  // scaled as far as that is known
    const RowBlock& block = r.blocks[at(row.block)];
    return std::abs(block.M(row.row, static_cast<Index>(k))) * f.column(block.columns[k]) *
           f.row[at(row.block)](row.row);
  }
  /// Rows of this number by their largest entry, in columns that are done or in all; their columns.
  bool scale_rows(int unit, bool all, std::vector<int>& reached) {
    double largest = 0;
    if (unit_done[at(unit)]) return false;
    for (const Row& row : rows_of[at(unit)])
      for (std::size_t k = 0; k < r.blocks[at(row.block)].columns.size(); ++k)
        if (all || column_done[at(r.blocks[at(row.block)].columns[k])])
          largest = std::max(largest, entry(row, k));
    if (largest == 0) return false;
    unit_done[at(unit)] = 1;
    for (const Row& row : rows_of[at(unit)]) {
      f.row[at(row.block)](row.row) = 1 / largest;
      const RowBlock& block = r.blocks[at(row.block)];
      for (std::size_t k = 0; k < block.columns.size(); ++k)
        if (block.M(row.row, static_cast<Index>(k)) != 0 && !column_done[at(block.columns[k])])
          reached.push_back(block.columns[k]);
    }
    return true;
  }
  /// Columns by their largest entry in rows that are done; numbers of the other rows there.
  std::vector<int> scale_columns(std::vector<int> reached) {
    std::sort(reached.begin(), reached.end());
    reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
    std::vector<int> units;
    for (const int j : reached) {
      double largest = 0;
      for (const int unit : units_of[at(j)])
        if (unit_done[at(unit)])
          for (const Row& row : rows_of[at(unit)]) {
            const std::vector<int>& columns = r.blocks[at(row.block)].columns;
            const auto place = std::lower_bound(columns.begin(), columns.end(), j);
            if (place != columns.end() && *place == j)
              largest = std::max(largest, entry(row, at(place - columns.begin())));
          }
      if (largest > 0) f.column(j) = 1 / largest;
      if (largest > 0) finish(j, units);
    }
    return units;
  }
  void finish(int j, std::vector<int>& units) {
    column_done[at(j)] = 1;
    for (const int unit : units_of[at(j)])
      if (!unit_done[at(unit)]) units.push_back(unit);
  }
  void spread(std::vector<int> units) {
    while (!units.empty()) {
      std::sort(units.begin(), units.end());
      units.erase(std::unique(units.begin(), units.end()), units.end());
      std::vector<int> reached;
      for (const int unit : units) scale_rows(unit, false, reached);
      units = scale_columns(std::move(reached));
    }
  }
  void run() {
    std::vector<int> units;
    for (Index j = 0; j < r.weight.size(); ++j)
      if (r.weight(j) > 0) f.column(j) = r.weight(j), finish(static_cast<int>(j), units);
    spread(std::move(units));
    for (std::size_t u = 0; u < rows_of.size(); ++u)  // what no energy reaches
      if (std::vector<int> reached; scale_rows(static_cast<int>(u), true, reached))
        spread(scale_columns(std::move(reached)));
    for (std::size_t b = 0; b < r.blocks.size(); ++b)
      r.blocks[b].M =
          f.row[b].asDiagonal() * r.blocks[b].M * f.column(r.blocks[b].columns).asDiagonal();
  }
};

}  // namespace

Factors scale(Relations& relations) {
  Scaling scaling(relations);
  scaling.run();
  return std::move(scaling.f);
}

}  // namespace titop::passes::closing
