#include <algorithm>
#include <iterator>
#include <map>
#include <titop/compiler/loops/redundant.hpp>
#include <titop/compiler/loops/reflections.hpp>
#include <titop/compiler/loops/uses.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using linalg::at;
using linalg::kProductRounding;

constexpr int kFewColumns = 6;  ///< fewer count as so many

/// Rows, with the columns that no later part has (`own`): in these the rows span the columns of
/// `basis`, and the rows are `factor` basis'.
struct RedundantPart {
  std::vector<int> own, others;
  MatrixXd basis, factor, rest;  ///< rest: rows x others

  /// Norm of a vector over `own` outside the span.
  double outside(const VectorXd& v) const { return (v - basis * (basis.transpose() * v)).norm(); }
  double rounding() const {
    return kProductRounding * static_cast<double>(std::max<Index>(basis.cols(), kFewColumns));
  }
};

/// Adds to `known` (orthonormal rows) the new directions of these rows.
Redundant by_singular_values(const MatrixXd& rows, MatrixXd& known) {
  Redundant result;
  MatrixXd left = rows;
  for (int twice = 0; twice < 2; ++twice) left -= (left * known.transpose()) * known;
  const Eigen::JacobiSVD<MatrixXd> svd(left, Eigen::ComputeFullU | Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  Index rank = 0;
  while (rank < sigma.size() && sigma(rank) > kMatrixDigits) ++rank;
  if (rank > 0) result.weakest = sigma(rank - 1);
  if (rank < sigma.size()) result.dropped = sigma(rank);
  // Directions of small singular values contain amplified rounding.
  MatrixXd fresh = svd.matrixV().leftCols(rank).transpose();
  fresh -= (fresh * known.transpose()) * known;
  fresh.rowwise().normalize();
  known.conservativeResize(known.rows() + rank, Eigen::NoChange);
  known.bottomRows(rank) = fresh;
  result.directions = svd.matrixU().rightCols(rows.rows() - rank).transpose();
  return result;
}

/// These rows over more columns (ascending), 0 in the new ones.
MatrixXd over(const std::vector<int>& columns, const RowBlock& rows) {
  MatrixXd result = MatrixXd::Zero(rows.M.rows(), static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < rows.columns.size(); ++i)
    result.col(std::lower_bound(columns.begin(), columns.end(), rows.columns[i]) -
               columns.begin()) = rows.M.col(static_cast<Index>(i));
  return result;
}

struct RedundancyFinder {
  std::vector<RowBlock> blocks;
  std::vector<MatrixXd> directions = {};  ///< per block: the rows left, in its own rows
  Uses uses;
  std::vector<RedundantPart> parts = {};
  std::vector<int> part_of;  ///< per column: the part that has it as its own, -1: none
  Redundancy result = {};

  explicit RedundancyFinder(const Relations& r)
      : blocks(r.blocks), uses(r.role.size(), blocks.size()), part_of(r.role.size(), -1) {
    result.blocks.resize(blocks.size());
    for (int b = 0; b < static_cast<int>(blocks.size()); ++b) {
      const Index rows = blocks[at(b)].M.rows();
      directions.emplace_back(MatrixXd::Identity(rows, rows));
      for (const int c : blocks[at(b)].columns) uses.add(c, b);
      uses.wait(b);
    }
  }

  /// Sets rows aside that have pivots in columns of their own.
  void set_aside(int b) {
    RowBlock& block = blocks[at(b)];
    const auto alone = [&](int c) { return uses.alone(c); };
    const std::vector<int> own = places(block.columns, alone);
    if (own.empty()) return;
    MatrixXd M(block.M.rows(), block.M.cols() + directions[at(b)].cols());
    M << block.M, directions[at(b)];
    Reflections e(std::move(M));
    e.take(own, kThreeDigits);
    if (e.done() == 0) return;
    directions[at(b)] =
        e.matrix().bottomRightCorner(block.M.rows() - e.done(), directions[at(b)].cols());
    const std::vector<int> before = block.columns;
    block = rest(before, e, alone);
    for (const int c : before)
      if (!std::binary_search(block.columns.begin(), block.columns.end(), c)) uses.leave(c, b);
  }

  template <class Asked>
  static std::vector<int> places(const std::vector<int>& columns, Asked asked) {
    std::vector<int> result;
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (asked(columns[i])) result.push_back(static_cast<int>(i));
    return result;
  }

  /// Rows with a pivot become a part, together with their own columns if these have no other
  /// entries. Returns the other rows.
  template <class Own>
  RowBlock rest(const std::vector<int>& columns, const Reflections& e, Own is_own) {
    const Index done = e.done(), left = e.matrix().rows() - done;
    RedundantPart part;
    RowBlock rows;
    std::vector<int> own, others, stay;
    for (int i = 0; i < static_cast<int>(columns.size()); ++i) {
      const int c = columns[at(i)];
      const bool gone = left == 0 || e.taken(i) || e.norm(i) <= (is_own(c) ? kNothing : 0);
      const bool goes_along = gone && is_own(c);
      (goes_along ? own : others).push_back(i);
      (goes_along ? part.own : part.others).push_back(c);
      if (goes_along) part_of[at(c)] = static_cast<int>(parts.size());
      if (!gone) stay.push_back(i), rows.columns.push_back(c);
    }
    set_basis(part, e.matrix().topRows(done)(Eigen::all, own));
    part.rest = e.matrix().topRows(done)(Eigen::all, others);
    rows.M = e.matrix().bottomRows(left)(Eigen::all, stay);
    parts.push_back(std::move(part));
    return rows;
  }

  static void set_basis(RedundantPart& part, const MatrixXd& rows) {
    const Eigen::HouseholderQR<MatrixXd> qr(rows.transpose());
    const Index n = rows.rows();
    part.basis = qr.householderQ() * MatrixXd::Identity(rows.cols(), n);
    part.factor = MatrixXd(qr.matrixQR().topRows(n).triangularView<Eigen::Upper>()).transpose();
  }

  /// The rest, in order, each connected set of blocks for itself.
  void decide_rest() {
    passes::UnionFind joined(static_cast<int>(blocks.size()));
    std::map<int, int> first;
    for (int b = 0; b < static_cast<int>(blocks.size()); ++b)
      for (const int c : blocks[at(b)].columns)
        if (const auto [place, added] = first.try_emplace(c, b); !added)
          joined.unite(place->second, b);
    std::map<int, std::vector<int>> sets;
    for (int b = 0; b < static_cast<int>(blocks.size()); ++b) sets[joined.find(b)].push_back(b);
    for (const auto& [of, members] : sets) decide(members);
  }

  /// Goes along the blocks with the relations of earlier ones between columns that are still to
  /// come: a combination with another remaining column cannot be repeated by a block.
  void decide(const std::vector<int>& members) {
    std::map<int, int> last;  // per column
    for (const int b : members)
      for (const int c : blocks[at(b)].columns) last[c] = b;
    RowBlock known{{}, MatrixXd(0, 0)};  // orthonormal rows
    for (const int b : members) {
      std::vector<int> columns;
      std::set_union(known.columns.begin(), known.columns.end(), blocks[at(b)].columns.begin(),
                     blocks[at(b)].columns.end(), std::back_inserter(columns));
      known = {columns, over(columns, known)};
      result.widest = std::max(result.widest, static_cast<int>(columns.size()));
      decide(b, known);
      if (b != members.back()) close(known, [&](int c) { return last.at(c) <= b; });
    }
    RedundantPart part;
    part.own = std::move(known.columns);
    part.basis = known.M.transpose();
    for (const int c : part.own) part_of[at(c)] = static_cast<int>(parts.size());
    parts.push_back(std::move(part));
  }

  void decide(int b, RowBlock& known) {
    Redundant& r = result.blocks[at(b)];
    r.directions = directions[at(b)];
    if (r.directions.rows() == 0 || known.columns.empty()) return;  // none remaining, or none known
    r = by_singular_values(over(known.columns, blocks[at(b)]), known.M);
    r.directions = r.directions * directions[at(b)];
  }

  /// Columns that no block to come has.
  template <class Closed>
  void close(RowBlock& known, Closed closed) {
    const std::vector<int> own = places(known.columns, closed);
    if (own.empty()) return;
    Reflections e(known.M);
    e.take(own, kThreeDigits);
    if (e.done() > 0) known = rest(known.columns, e, closed);
  }

  /// True if the unit vector of a column is in the span of all rows.
  bool held(int column) const {
    const int own = part_of[at(column)];
    if (own < 0) return false;
    const RedundantPart& part = parts[at(own)];
    const auto place =
        std::lower_bound(part.own.begin(), part.own.end(), column) - part.own.begin();
    if (2 * part.basis.row(place).squaredNorm() < 1) return false;  // most of it is outside
    if (part.outside(VectorXd::Unit(part.basis.rows(), place)) > part.rounding()) return false;
    std::map<int, double> left;  // of the rows in other columns
    const double size = subtract(part, VectorXd::Unit(part.basis.rows(), place), left);
    return cancels(std::move(left), std::max(1.0, size));
  }

  /// Subtracts from `left` the combination of rows that is v in their own columns, in the other
  /// columns. Returns the largest sum of magnitudes: rounding is in proportion to it.
  static double subtract(const RedundantPart& part, const VectorXd& v,
                         std::map<int, double>& left) {
    if (part.others.empty()) return 0;
    const VectorXd y = part.factor.triangularView<Eigen::Lower>().transpose().solve(
        VectorXd(part.basis.transpose() * v));
    const VectorXd others = part.rest.transpose() * y;
    const VectorXd sizes = part.rest.cwiseAbs().transpose() * y.cwiseAbs();
    for (std::size_t i = 0; i < part.others.size(); ++i) {
      const auto k = static_cast<Index>(i);
      if (std::abs(others(k)) > kProductRounding * sizes(k)) left[part.others[i]] -= others(k);
    }
    return sizes.maxCoeff();
  }

  /// Later parts' rows cancel this vector; each can do so with its own columns only.
  bool cancels(std::map<int, double> left, double size) const {
    while (true) {
      int next = -1;
      for (const auto& [c, x] : left) {
        if (std::abs(x) <= kFewColumns * kProductRounding * size) continue;
        if (part_of[at(c)] < 0) return false;
        if (next < 0 || part_of[at(c)] < next) next = part_of[at(c)];
      }
      if (next < 0) return true;
      const RedundantPart& p = parts[at(next)];
      VectorXd v = VectorXd::Zero(p.basis.rows());
      for (std::size_t i = 0; i < p.own.size(); ++i)
        if (const auto found = left.find(p.own[i]); found != left.end())
          v(static_cast<Index>(i)) = found->second, left.erase(found);
      if (p.outside(v) > p.rounding() * size) return false;
      size = std::max(size, subtract(p, v, left));
    }
  }

  void run() {
    for (int b = uses.next(); b >= 0; b = uses.next()) set_aside(b);
    decide_rest();
    for (int c = 0; c < static_cast<int>(part_of.size()); ++c)
      if (held(c)) result.held.push_back(c);
  }
};

}  // namespace

Redundancy redundancy(const Relations& scaled) {
  RedundancyFinder finder(scaled);
  finder.run();
  return std::move(finder.result);
}

}  // namespace titop::loops
