#include <algorithm>
#include <cmath>
#include <titop/compiler/solve/margins.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/skeel.hpp>
#include <utility>

/// The margin of a loop is a number that no change of units moves.
namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

/// Powers of length and of force in a number's unit. Scalars may have any unit: only the power of
/// force is used.
struct Unit {
  int length = 0, force = 0;
  bool scalar = false;
};

Unit unit_of(const Signal& s, int i) {
  const bool force = s.quantity == Quantity::force;
  if (entries_per_unit(s) == 1) return {0, force, true};
  return force ? Unit{i >= 3, 1} : Unit{i < 3, 0};
}

/// An equation's row has the unit of its target.
Unit unit_of(const Signal& s, const Part& part, int row) {
  if (part.whole()) return unit_of(s, row);
  Eigen::Index largest = 0;
  part.rows().row(row).cwiseAbs().maxCoeff(&largest);
  return unit_of(s, static_cast<int>(largest));
}

/// The loop's own units, as powers of two: the force that gives its lightest point unit
/// acceleration, and the length whose square is inertia over mass. The margin is independent of
/// units, but in the LU behind it cancelling terms must be of like size.
void to_own_units(const std::vector<Unit>& rows, const std::vector<Unit>& columns, MatrixXd& L) {
  double per_force = 0, per_moment = 0;  // accelerations, linear and angular
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Unit r = rows[i], c = columns[j];
      if (r.force != 0 || c.force != 1 || r.scalar != c.scalar) continue;
      const double size = std::abs(L(static_cast<Index>(i), static_cast<Index>(j)));
      if (r.scalar || (r.length == 1 && c.length == 0))
        per_force = std::max(per_force, size);
      else if (r.length == 0 && c.length == 1)
        per_moment = std::max(per_moment, size);
    }
  const auto exponent = [](double x) {
    return x > 0 && std::isfinite(x) ? static_cast<int>(std::lround(std::log2(x))) : 0;
  };
  const int length =
      per_force > 0 && per_moment > 0 ? exponent(std::sqrt(per_force) / std::sqrt(per_moment)) : 0;
  const int force = length - exponent(per_force);
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Unit r = rows[i], c = columns[j];
      double& x = L(static_cast<Index>(i), static_cast<Index>(j));
      if (x == 0) continue;  // most are
      x = std::ldexp(x, (c.length - r.length) * length + (c.force - r.force) * force);
    }
}

/// Puts the rows of a loop, scalar row after scalar row, into its dense matrix.
struct Filler {
  const Factored& d;
  MatrixXd& L;
  const std::vector<int>& column;  ///< first one of each signal, -1 if it is not of this loop
  Index row = 0;

  template <class Matrix>
  void put(const Matrix& c, double sign, int signal) {
    const Index first = column[at(signal)];
    if (first < 0) return;
    if (c.size() == 1)
      L(row, first) += sign * c.coeff(0, 0);
    else
      L.block(row, first, c.rows(), c.cols()) += sign * c;
  }
  void put_identity(int signal) {
    if (const Index first = column[at(signal)]; first >= 0)
      for (int i = 0; i < d.graph().signals[at(signal)].size; ++i) L(row + i, first + i) += 1;
  }
  void equation(int index) {
    const Equation& e = d.graph().equations[at(index)];
    e.part.whole() ? put_identity(e.target) : put(e.part.rows(), 1, e.target);
    const int first = d.skeleton->joint.equation_coefficient[at(index)];
    for (std::size_t k = 0; k < e.terms.size(); ++k)
      put(*d.numbers.coefficients[at(first) + k], -1, e.terms[k].signal);
  }
  void block_row(int index, int output) {
    const Node& node = d.graph().nodes[at(index)];
    const Signal& y = d.graph().signals[at(output)];
    put_identity(output);
    for (int i = node.first_signal; i < node.end_signal; ++i)
      if (const Signal& u = d.graph().signals[at(i)]; u.role == Signal::Role::input)
        put(d.numbers.blocks[at(index)]->D.block(y.first, u.first, y.size, u.size), -1, i);
  }
};

/// Room for one loop after the other.
struct LoopRoom {
  MatrixXd L = {};
  std::vector<int> column = {};  ///< of every signal, -1 between loops
};

/// Loop matrix of one strong component: its rows and unknowns of the equations, dense. False if
/// rows and unknowns do not match.
bool take_loop_matrix(const Factored& d, const Loop& loop, LoopRoom& room) {
  room.L.setZero(loop.unknowns, loop.unknowns);
  int columns = 0;
  for (const int s : loop.signals)
    room.column[at(s)] = std::exchange(columns, columns + d.graph().signals[at(s)].size);
  Filler fill{d, room.L, room.column};
  for (const int r : loop.rows) {
    const Row& q = d.skeleton->stage.rows[at(r)];
    if (fill.row + q.size <= loop.unknowns)
      q.equation >= 0 ? fill.equation(q.equation) : fill.block_row(q.node, q.output);
    fill.row += q.size;
  }
  for (const int s : loop.signals) room.column[at(s)] = -1;
  return fill.row == loop.unknowns;
}

void to_own_units(const Factored& d, const Loop& loop, MatrixXd& L) {
  const Graph& g = d.graph();
  std::vector<Unit> rows, columns;
  for (const int signal : loop.signals)
    for (int i = 0; i < g.signals[at(signal)].size; ++i)
      columns.push_back(unit_of(g.signals[at(signal)], i));
  for (const int r : loop.rows) {
    const Row& q = d.skeleton->stage.rows[at(r)];
    for (int i = 0; i < q.size; ++i)
      if (q.equation >= 0) {
        const Equation& e = g.equations[at(q.equation)];
        rows.push_back(unit_of(g.signals[at(e.target)], e.part, i));
      } else {
        rows.push_back(unit_of(g.signals[at(q.output)], i));
      }
  }
  to_own_units(rows, columns, L);
}

/// rho(|L^-1| |L|); 1 for a single unknown, 0 if it is not found: of large loops, and if L
/// has no inverse in double.
double margin(const Factored& d, const Loop& loop, LoopRoom& room) {
  if (loop.unknowns == 1) return 1;
  if (loop.unknowns > kMarginUpTo || !take_loop_matrix(d, loop, room)) return 0;
  return linalg::skeel_radius(room.L, [&](MatrixXd& M) { to_own_units(d, loop, M); });
}

}  // namespace

void find_margins(const Factored& d, std::span<const int> loops, std::vector<double>& margins) {
  const std::vector<Loop>& all = d.skeleton->stage.loops;
  margins.resize(all.size(), 0);
  LoopRoom room;
  room.column.assign(d.graph().signals.size(), -1);
  for (const int i : loops) margins[at(i)] = margin(d, all[at(i)], room);
}

void update_margins(Factored& d) {
  std::vector<double> margins = d.margins ? *d.margins : std::vector<double>();
  find_margins(d, d.changed_loops, margins);
  d.margins = std::make_shared<const std::vector<double>>(std::move(margins));
  d.changed_loops.clear();
}

WellPosedness judge_margins(const Stage& stage, std::span<const double> margins) {
  WellPosedness result;
  for (std::size_t i = 0; i < stage.loops.size(); ++i) {
    if (stage.loops[i].unknowns > kMarginUpTo) {
      ++result.too_large;
      continue;
    }
    result.without_inverse += margins[i] == 0;
    // At distance delta from singular a margin is about 4 / delta: above 2 / eps the last two units
    // of a loop's own numbers determine every digit of the solution.
    if ((margins[i] == 0 || margins[i] > 2 / linalg::kEpsilon) && result.without_digit < 0)
      result.without_digit = static_cast<int>(i);
    if (margins[i] <= result.largest) continue;
    result.largest = margins[i];
    result.largest_loop = static_cast<int>(i);
  }
  return result;
}

}  // namespace titop::detail
