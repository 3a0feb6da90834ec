#include <algorithm>
#include <cmath>
#include <titop/compiler/loops/relations.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// A lever below this share of those of its chain makes its joint's column a rotation, and one that
/// is longer by as much a translation: the digits of such a lever must not influence how the joint
/// counts.
constexpr double kLever = 1e-5;

/// Sweeps end when they change no factor by more: ranks are decided between digits, not within one.
constexpr double kSettled = 1.02;
constexpr int kMostSweeps = 100;

/// The rows of one unit in one column: their norm.
struct UnitEntry {
  int unit = 0, column = 0;
  double size = 0;
  bool counts = true;  ///< false if tiny compared with another unit's entry times their lever
};

/// Units are rows of one number. The start goes from entries with a factor to their neighbours, so
/// that units of measurement have no influence; sweeps then equilibrate all, independent of the
/// place of the start.
struct RelationScaling {
  Relations& r;
  std::vector<UnitEntry> entries = {};
  std::vector<std::vector<int>> of_unit = {}, of_column;  ///< entries
  std::vector<double> row = {}, column;                   ///< factors; 0: none yet
  std::vector<double> share = {};  ///< per unit: its square sum, equilibrated
  std::vector<char> fixed;         ///< per column: it stores energy

  explicit RelationScaling(Relations& relations)
      : r(relations), of_column(r.role.size()), column(r.role.size(), 0), fixed(r.role.size(), 0) {
    for (std::size_t j = 0; j < column.size(); ++j)
      if (r.weight(static_cast<Index>(j)) > 0) column[j] = 1, fixed[j] = 1;
    for (std::size_t b = 0; b < r.blocks.size(); ++b) list(b);
    find_shares();
  }

  void list(std::size_t b) {
    const RowBlock& block = r.blocks[b];
    std::vector<int> units = r.unit[b];
    detail::keep_each_once(units);
    MatrixXd sizes = MatrixXd::Zero(std::ssize(units), block.M.cols());
    for (Index i = 0; i < block.M.rows(); ++i) {
      const auto u = std::lower_bound(units.begin(), units.end(), r.unit[b][at(i)]);
      sizes.row(u - units.begin()) += block.M.row(i).cwiseAbs2();
    }
    sizes = sizes.cwiseSqrt();
    if (!units.empty() && at(units.back()) >= of_unit.size()) of_unit.resize(at(units.back()) + 1);
    const MatrixXd tiny = kLever * levers(sizes, block.columns);
    for (Index k = 0; k < sizes.cols(); ++k) {
      const Counts counts = counting(sizes.col(k), tiny);
      for (Index u = 0; u < sizes.rows(); ++u) {
        if (sizes(u, k) == 0) continue;
        const int unit = units[at(u)], j = block.columns[at(k)];
        of_unit[at(unit)].push_back(static_cast<int>(entries.size()));
        of_column[at(j)].push_back(static_cast<int>(entries.size()));
        entries.push_back({unit, j, sizes(u, k), counts(u)});
      }
    }
  }

  /// For one column, per unit of a block: true in one of them at least.
  using Counts = Eigen::Array<bool, Eigen::Dynamic, 1>;
  static Counts counting(const Eigen::ArrayXd& sizes, const MatrixXd& tiny) {
    Counts result(sizes.size());
    for (Index u = 0; u < sizes.size(); ++u)
      result(u) = sizes(u) > 0 && (sizes(u) >= tiny.row(u).transpose().array() * sizes).all();
    return result.any() ? result
                        : Counts(sizes > 0);  // three units, each tiny compared with another
  }

  /// Per two units of a block the ratio of their levers: the largest of a joint, or the median of
  /// columns that store energy (of some modes it is rounding), if that is larger. Independent of
  /// the units of columns; rows have the same ones in all columns.
  MatrixXd levers(const MatrixXd& sizes, const std::vector<int>& columns) const {
    MatrixXd result = MatrixXd::Zero(sizes.rows(), sizes.rows());
    for (Index u = 0; u < sizes.rows(); ++u)
      for (Index v = u + 1; v < sizes.rows(); ++v) {
        double longest = 0;
        std::vector<double> of_energy;
        for (Index k = 0; k < sizes.cols(); ++k) {
          if (sizes(u, k) == 0 || sizes(v, k) == 0) continue;
          const double lever = sizes(u, k) / sizes(v, k);
          if (r.weight(columns[at(k)]) > 0)
            of_energy.push_back(lever);
          else
            longest = std::max(longest, lever);
        }
        if (!of_energy.empty()) {
          const auto middle = of_energy.begin() + std::ssize(of_energy) / 2;
          std::nth_element(of_energy.begin(), middle, of_energy.end());
          longest = std::max(longest, *middle);
        }
        if (longest > 0) result(u, v) = longest, result(v, u) = 1 / longest;
      }
    return result;
  }

  /// Every column is spread evenly over the units in which it counts: so a scaling exists and is
  /// unique. Columns of fixed size count for one, all of a unit together.
  void find_shares() {
    row.assign(of_unit.size(), 0);
    share.assign(of_unit.size(), 0);
    std::vector<char> has_fixed(of_unit.size(), 0);
    for (std::size_t j = 0; j < of_column.size(); ++j) {
      const std::vector<int>& list = of_column[j];
      const auto counts = [&](int e) { return entries[at(e)].counts; };
      const auto counting = static_cast<double>(std::ranges::count_if(list, counts));
      for (const int e : list)
        if (counts(e) && fixed[j] != 0)
          has_fixed[at(entries[at(e)].unit)] = 1;
        else if (counts(e))
          share[at(entries[at(e)].unit)] += 1 / counting;
    }
    for (std::size_t u = 0; u < share.size(); ++u) share[u] += has_fixed[u];
  }

  double scaled(const UnitEntry& e) const {
    return e.size * row[at(e.unit)] * column[at(e.column)];
  }

  /// By its largest entry in columns that have a factor; adds the columns that it reaches. A first
  /// unit takes entries that do not count too, and has any factor if no column has one.
  bool start_unit(int unit, bool first, std::vector<int>& reached) {
    if (row[at(unit)] != 0) return false;
    double largest = 0, size = 0;
    for (const int e : of_unit[at(unit)]) {
      size = std::max(size, entries[at(e)].size);
      if (first || entries[at(e)].counts)
        largest = std::max(largest, entries[at(e)].size * column[at(entries[at(e)].column)]);
    }
    if (first && largest == 0) largest = size;
    if (largest == 0) return false;
    row[at(unit)] = 1 / largest;
    for (const int e : of_unit[at(unit)])
      if (entries[at(e)].counts && column[at(entries[at(e)].column)] == 0)
        reached.push_back(entries[at(e)].column);
    return true;
  }
  /// By their largest entries in units that have a factor; the other units there.
  std::vector<int> start_columns(std::vector<int> reached) {
    detail::keep_each_once(reached);
    std::vector<int> units;
    for (const int j : reached) {
      double largest = 0;
      for (const int e : of_column[at(j)])
        if (entries[at(e)].counts)
          largest = std::max(largest, entries[at(e)].size * row[at(entries[at(e)].unit)]);
      column[at(j)] = 1 / largest;
      add_units(j, units);
    }
    return units;
  }
  void add_units(int j, std::vector<int>& units) const {
    for (const int e : of_column[at(j)])
      if (entries[at(e)].counts && row[at(entries[at(e)].unit)] == 0)
        units.push_back(entries[at(e)].unit);
  }
  void spread(std::vector<int> units) {
    while (!units.empty()) {
      detail::keep_each_once(units);
      std::vector<int> reached;
      for (const int unit : units) start_unit(unit, false, reached);
      units = start_columns(std::move(reached));
    }
  }
  void start() {
    std::vector<int> units;
    for (std::size_t j = 0; j < fixed.size(); ++j)
      if (fixed[j] != 0) add_units(static_cast<int>(j), units);
    spread(std::move(units));
    for (std::size_t u = 0; u < row.size(); ++u)  // units that no energy reaches
      if (std::vector<int> reached; start_unit(static_cast<int>(u), true, reached))
        spread(start_columns(std::move(reached)));
    for (auto* factors : {&row, &column})
      std::replace(factors->begin(), factors->end(), 0.0, 1.0);  // no entries
  }

  /// Every unit to its share, then every free column to 1. Returns the largest change.
  double sweep() {
    double change = 1;
    const auto correct = [&](double& factor, double by) {
      factor *= by;
      change = std::max({change, by, 1 / by});
    };
    std::vector<double> sum(row.size(), 0);
    for (const UnitEntry& e : entries)
      if (e.counts) sum[at(e.unit)] += scaled(e) * scaled(e);
    for (std::size_t u = 0; u < sum.size(); ++u)
      if (share[u] > 0) correct(row[u], std::sqrt(share[u] / sum[u]));
    sum.assign(column.size(), 0);
    for (const UnitEntry& e : entries)
      if (e.counts) sum[at(e.column)] += scaled(e) * scaled(e);
    for (std::size_t j = 0; j < sum.size(); ++j)
      if (fixed[j] == 0 && sum[j] > 0) correct(column[j], 1 / std::sqrt(sum[j]));
    return change;
  }

  /// Scales free columns to 1, including entries that do not count.
  void finish() {
    std::vector<double> sum(column.size(), 0);
    for (const UnitEntry& e : entries) sum[at(e.column)] += scaled(e) * scaled(e);
    for (std::size_t j = 0; j < sum.size(); ++j)
      if (fixed[j] == 0 && sum[j] > 0) column[j] /= std::sqrt(sum[j]);
  }

  ScaleFactors factors() const {
    ScaleFactors f{{}, Eigen::Map<const Eigen::VectorXd>(column.data(), std::ssize(column))};
    for (std::size_t b = 0; b < r.blocks.size(); ++b) {
      f.row.emplace_back(r.blocks[b].M.rows());
      for (Index i = 0; i < f.row.back().size(); ++i) f.row.back()(i) = row[at(r.unit[b][at(i)])];
    }
    return f;
  }
};

}  // namespace

ScaleFactors scale(Relations& relations) {
  RelationScaling scaling(relations);
  scaling.start();
  for (int k = 0; k < kMostSweeps && scaling.sweep() > kSettled; ++k) continue;
  scaling.finish();
  ScaleFactors f = scaling.factors();
  for (std::size_t b = 0; b < relations.blocks.size(); ++b) {
    RowBlock& block = relations.blocks[b];
    block.M = f.row[b].asDiagonal() * block.M * f.column(block.columns).asDiagonal();
  }
  return f;
}

}  // namespace titop::loops
