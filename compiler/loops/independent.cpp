#include <algorithm>
#include <array>
#include <numeric>
#include <queue>
#include <titop/compiler/loops/reflections.hpp>
#include <titop/compiler/loops/relations.hpp>
#include <titop/compiler/loops/uses.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Role = Relations::Role;
using linalg::at;

/// Fraction of the best pivot, for a pivot to be taken before all are known: a dependent coordinate
/// is then at most about ten times those that it depends on, in units of energy, and the model
/// loses at most a digit.
using linalg::kOneDigit;
constexpr std::size_t kLookedAt = 8;  ///< neighbours per column, for one to merge with

/// Rows of one front in which coordinates had their pivots: upper triangular in these.
struct PivotRows {
  std::vector<int> columns, pivots;
  MatrixXd M;
};

/// Rounding of the rows of T = -pivots^-1 rest: each entry of both, in rows of norm 1 or less, is a
/// sum of products of a few rotations and positions, off by four units of that norm.
Eigen::VectorXd rounding_by(const MatrixXd& pivots, const MatrixXd& T) {
  MatrixXd inverse = MatrixXd::Identity(pivots.rows(), pivots.rows());
  pivots.triangularView<Eigen::Upper>().solveInPlace(inverse);
  const double most = T.size() > 0 ? std::max(1.0, T.cwiseAbs().maxCoeff()) : 1;
  return 4 * linalg::kEpsilon * most * inverse.cwiseAbs().rowwise().sum();
}

struct Fronts {
  std::vector<Role> role;
  Eigen::VectorXd soft;         ///< per column: worth of a pivot
  std::vector<char> preferred;  ///< per column
  std::vector<RowBlock> fronts;
  Uses uses;
  std::vector<std::vector<int>> fronts_of;  ///< per column; some may have lost it
  std::vector<PivotRows> pivot_rows = {};
  Independent result = {};

  Fronts(Relations r, Eigen::VectorXd worth, const std::vector<int>& wanted)
      : role(std::move(r.role)),
        soft(std::move(worth)),
        preferred(role.size(), 0),
        fronts(std::move(r.blocks)),
        uses(role.size(), fronts.size()),
        fronts_of(role.size()) {
    for (const int c : wanted) preferred[at(c)] = 1;
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
      for (const int c : fronts[at(f)].columns) uses.add(c, f), fronts_of[at(c)].push_back(f);
      uses.wait(f);
    }
  }

  /// Places of the columns of this front only, for which `asked` is true.
  template <class Asked>
  std::vector<int> own(const RowBlock& front, Asked asked) const {
    std::vector<int> places;
    for (std::size_t i = 0; i < front.columns.size(); ++i)
      if (uses.alone(front.columns[i]) && asked(front.columns[i]))
        places.push_back(static_cast<int>(i));
    return places;
  }

  /// No other front has any of its columns.
  bool all_own(const RowBlock& front) const {
    return std::all_of(front.columns.begin(), front.columns.end(),
                       [&](int c) { return uses.alone(c); });
  }

  /// Takes unknowns; false if one remains.
  bool take_unknowns(const RowBlock& front, bool last, Reflections& e) {
    const auto is_unknown = [&](int c) { return role[at(c)] == Role::unknown; };
    const auto unknowns = own(front, is_unknown);
    const double left = e.take(unknowns, last ? kMatrixDigits : kThreeDigits);
    if (left > kMatrixDigits) return false;
    result.dropped = std::max(result.dropped, left);
    return std::count_if(front.columns.begin(), front.columns.end(), is_unknown) ==
           static_cast<std::ptrdiff_t>(unknowns.size());
  }

  /// Places of preferred columns that another front has too: a front to come may take them.
  std::vector<int> shared_preferred(const RowBlock& front) const {
    std::vector<int> places;
    for (std::size_t i = 0; i < front.columns.size(); ++i)
      if (const int c = front.columns[i]; preferred[at(c)] != 0 && !uses.alone(c))
        places.push_back(static_cast<int>(i));
    return places;
  }

  /// Returns the weakest pivot that decided on a rank.
  double take_coordinates(const RowBlock& front, bool last, Reflections& e) {
    const auto is = [&](Role r) { return [this, r](int c) { return role[at(c)] == r; }; };
    const auto known =
        own(front, [&](int c) { return preferred[at(c)] != 0 && role[at(c)] != Role::unknown; });
    const auto integrals = own(front, is(Role::integral));
    const auto all = own(front, [&](int c) { return role[at(c)] != Role::unknown; });
    if (last) return take_last(front, {known, integrals, all}, e);
    e.take(known, kThreeDigits);
    e.take(integrals, kThreeDigits);
    // Rows may wait for preferred columns: see take_beside.
    if (shared_preferred(front).empty()) {
      std::vector<int> rivals(front.columns.size());
      std::iota(rivals.begin(), rivals.end(), 0);
      e.take(all, kThreeDigits, {soft(front.columns), kOneDigit, std::move(rivals)});
    }
    return e.weakest();
  }

  /// The number of dependent coordinates is geometry, decided by the largest pivots of all (the
  /// last of `choices`); which ones, by the order of the choices and by softness.
  double take_last(const RowBlock& front, const std::array<std::vector<int>, 3>& choices,
                   Reflections& e) {
    Reflections rank = e;
    result.dropped = std::max(result.dropped, rank.take(choices.back(), kMatrixDigits));
    Reflections::PivotChoice choice{soft(front.columns)};
    for (choice.most = e.done() + 1; choice.most <= rank.done(); ++choice.most) {
      const double least = kThreeDigits * e.largest(choices.back());
      for (const std::vector<int>& columns : choices) e.take(columns, least, choice);
    }
    return rank.weakest();
  }

  /// Keeps the rows in which e has its pivots, from `first`.
  void keep(const RowBlock& front, const Reflections& e, Index first = 0) {
    const Index count = e.done() - first;
    if (count == 0) return;
    PivotRows rows;
    std::vector<int> places;
    for (int i = 0; i < static_cast<int>(front.columns.size()); ++i)
      if (role[at(front.columns[at(i)])] != Role::unknown)
        places.push_back(i), rows.columns.push_back(front.columns[at(i)]);
    rows.M = e.matrix().middleRows(first, count)(Eigen::all, places);
    for (Index k = 0; k < count; ++k)
      rows.pivots.push_back(front.columns[at(e.pivots()[at(first + k)])]);
    pivot_rows.push_back(std::move(rows));
  }

  /// Remaining rows wait for better pivots in columns that other fronts have too, but no more rows
  /// than such pivots: the other rows are small in all columns that are read elsewhere, and their
  /// own pivots are taken after all. That bounds the multipliers. Returns the rows that wait.
  MatrixXd take_beside(const RowBlock& front, const Reflections& e) {
    MatrixXd rows = e.matrix().bottomRows(e.matrix().rows() - e.done());
    if (rows.rows() == 0) return rows;
    std::vector<int> shared, alone;
    for (int i = 0; i < static_cast<int>(front.columns.size()); ++i)
      if (!e.taken(i)) (uses.alone(front.columns[at(i)]) ? alone : shared).push_back(i);
    Reflections waiting(std::move(rows));
    const Eigen::VectorXd worth = soft(front.columns);
    waiting.take(shared_preferred(front), kMatrixDigits, {worth, kThreeDigits, alone});
    waiting.take(shared, kMatrixDigits, {worth, 1 / kOneDigit, alone});
    const Index wait = waiting.done();
    Reflections o(waiting.matrix().bottomRows(waiting.matrix().rows() - wait));
    o.take(alone, kThreeDigits, {worth});
    result.weakest = std::min(result.weakest, o.weakest());
    keep(front, o);
    MatrixXd left(waiting.matrix().rows() - o.done(), waiting.matrix().cols());
    left << waiting.matrix().topRows(wait), o.matrix().bottomRows(left.rows() - wait);
    if (o.done() == 0) return left;
    const MatrixXd pivots = o.matrix().topRows(o.done());
    MatrixXd multipliers = left.topRows(wait)(Eigen::all, o.pivots());
    pivots(Eigen::all, o.pivots())
        .eval()
        .triangularView<Eigen::Upper>()
        .solveInPlace<Eigen::OnTheRight>(multipliers);
    left.topRows(wait) -= multipliers * pivots;
    for (const int c : o.pivots()) left.col(c).setZero();
    return left;
  }

  /// The remaining front: rows without a pivot, and the columns that are not eliminated.
  void shrink(int f, const MatrixXd& rows, bool no_unknowns) {
    RowBlock& front = fronts[at(f)];
    RowBlock left;
    std::vector<int> places;
    for (int i = 0; i < static_cast<int>(front.columns.size()); ++i) {
      const int c = front.columns[at(i)];
      if (rows.col(i).norm() <= (uses.alone(c) ? kNothing : 0))
        uses.leave(c, f);
      else
        places.push_back(i), left.columns.push_back(c);
    }
    left.M = rows(Eigen::all, places);
    // The eliminated columns may have been all that the others waited for: unknowns, or those of
    // other fronts.
    const bool fewer = rows.rows() > 0 && left.columns.size() < front.columns.size();
    front = std::move(left);
    if (fewer && (!no_unknowns || all_own(front))) uses.wait(f);
  }

  void eliminate(int f) {
    const RowBlock& front = fronts[at(f)];
    if (own(front, [](int) { return true; }).empty()) return;
    const bool last = all_own(front);
    Reflections e(front.M);
    const bool no_unknowns = take_unknowns(front, last, e);
    const Index first = e.done();
    result.weakest =
        std::min(result.weakest, no_unknowns ? take_coordinates(front, last, e) : e.weakest());
    keep(front, e, first);
    if (last)
      shrink(f, MatrixXd(0, front.M.cols()), no_unknowns);
    else
      shrink(f,
             no_unknowns ? take_beside(front, e)
                         : MatrixXd(e.matrix().bottomRows(front.M.rows() - e.done())),
             no_unknowns);
  }

  /// The smallest of its neighbours, -1 if it has none.
  int neighbour(int f) {
    int best = -1;
    for (const int c : fronts[at(f)].columns) {
      auto& list = fronts_of[at(c)];
      std::erase_if(list, [&](int g) {
        const auto& columns = fronts[at(g)].columns;
        return !std::binary_search(columns.begin(), columns.end(), c);
      });
      for (std::size_t i = 0; i < std::min(list.size(), kLookedAt); ++i)
        if (list[i] != f &&
            (best < 0 || fronts[at(list[i])].columns.size() < fronts[at(best)].columns.size()))
          best = list[i];
    }
    return best;
  }

  void merge(int f, int g) {
    RowBlock &a = fronts[at(f)], &b = fronts[at(g)];
    RowBlock both;
    std::set_union(a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(),
                   std::back_inserter(both.columns));
    both.M = MatrixXd::Zero(a.M.rows() + b.M.rows(), static_cast<Index>(both.columns.size()));
    const auto put = [&](const RowBlock& part, Index row) {
      std::size_t place = 0;
      for (std::size_t i = 0; i < part.columns.size(); ++i) {
        while (both.columns[place] != part.columns[i]) ++place;
        both.M.col(static_cast<Index>(place)).segment(row, part.M.rows()) =
            part.M.col(static_cast<Index>(i));
      }
    };
    put(a, 0), put(b, a.M.rows());
    for (const int c : b.columns) {
      uses.remove(c, g);
      if (std::binary_search(a.columns.begin(), a.columns.end(), c)) continue;
      uses.add(c, f);
      fronts_of[at(c)].push_back(f);
    }
    b = {};
    a = std::move(both);
    uses.wait(f);
  }

  void run() {
    using Sized = std::pair<std::size_t, int>;
    std::priority_queue<Sized, std::vector<Sized>, std::greater<>> smallest;
    for (int f = 0; f < static_cast<int>(fronts.size()); ++f)
      smallest.emplace(fronts[at(f)].columns.size(), f);
    while (true) {
      for (int f = uses.next(); f >= 0; f = uses.next()) {
        eliminate(f);
        smallest.emplace(fronts[at(f)].columns.size(), f);
      }
      if (smallest.empty()) return;
      const auto [size, f] = smallest.top();
      smallest.pop();
      if (size == 0 || size != fronts[at(f)].columns.size()) continue;  // another by now
      if (const int g = neighbour(f); g >= 0) merge(f, g);
    }
  }

  /// From the last pivot rows to the first: common columns are independent, or dependent by later
  /// rows.
  void write_followers(const Eigen::VectorXd& factor) {
    for (auto rows = pivot_rows.rbegin(); rows != pivot_rows.rend(); ++rows) {
      std::vector<int> pivot_places, rest_places;
      for (const int p : rows->pivots)
        pivot_places.push_back(
            static_cast<int>(std::lower_bound(rows->columns.begin(), rows->columns.end(), p) -
                             rows->columns.begin()));
      for (int i = 0; i < static_cast<int>(rows->columns.size()); ++i)
        if (std::find(pivot_places.begin(), pivot_places.end(), i) == pivot_places.end())
          rest_places.push_back(i);
      MatrixXd T = -rows->M(Eigen::all, rest_places);
      const MatrixXd pivots = rows->M(Eigen::all, pivot_places);
      pivots.triangularView<Eigen::Upper>().solveInPlace(T);
      const Eigen::VectorXd off = rounding_by(pivots, T);
      // Clears rounding between uncoupled directions.
      const double noise = linalg::kProductRounding * static_cast<double>(pivot_places.size());
      for (std::size_t k = 0; k < pivot_places.size(); ++k) {
        Independent::Follows f{rows->pivots[k]};
        for (std::size_t i = 0; i < rest_places.size(); ++i) {
          const int c = rows->columns[at(rest_places[i])];
          const double t = T(static_cast<Index>(k), static_cast<Index>(i));
          if (std::abs(t) <= noise) continue;
          const double unit = factor(f.dependent) / factor(c);
          f.of.emplace_back(c, t * unit);
          f.rounding.push_back(off(static_cast<Index>(k)) * unit);
        }
        result.follow.push_back(std::move(f));
      }
    }
  }
};

/// In units of energy, relative to the softest; a column that stores none is as soft.
Eigen::VectorXd softness(const Relations& scaled, const ScaleFactors& factors) {
  Eigen::VectorXd result = scaled.weight.cwiseQuotient(factors.column);
  const double softest = result.size() == 0 ? 0 : result.maxCoeff();
  for (double& x : result) x = x > 0 ? x / softest : 1;
  return result;
}

}  // namespace

Independent independent(Relations relations, const std::vector<int>& preferred) {
  const ScaleFactors factors = scale(relations);
  Eigen::VectorXd soft = softness(relations, factors);
  Fronts fronts(std::move(relations), std::move(soft), preferred);
  fronts.run();
  fronts.write_followers(factors.column);
  return std::move(fronts.result);
}

}  // namespace titop::loops
