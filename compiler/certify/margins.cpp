#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/system_data.hpp>
#include <titop/graph/linalg/dense.hpp>

/// Well-posedness of the algebraic loops, in a number that no change of units moves.
namespace titop::detail {
namespace {

using Eigen::MatrixXd;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr int kExactUpTo = 120;  ///< unknowns; above it a dense inverse per loop costs too much

/// Loop matrix of one strong component: its rows and unknowns of the equations, dense. False where
/// rows and unknowns do not match.
bool take_loop_matrix(const SystemData& d, const Loop& loop, MatrixXd& L) {
  const Graph& g = d.graph();
  L.setZero(loop.unknowns, loop.unknowns);
  const auto column_of = [&](int signal) {  // -1: not of this loop, whose signals ascend
    Eigen::Index column = 0;
    for (const int s : loop.signals) {
      if (s == signal) return column;
      column += g.signals[at(s)].size;
    }
    return Eigen::Index{-1};
  };
  Eigen::Index row = 0;
  const auto put = [&](const auto& c, double sign, int signal) {
    if (const Eigen::Index column = column_of(signal); column >= 0)
      L.block(row, column, c.rows(), c.cols()) += sign * c;
  };
  const auto put_identity = [&](int signal) {
    const int n = g.signals[at(signal)].size;
    put(MatrixXd::Identity(n, n), 1, signal);
  };
  for (const int r : loop.rows) {
    const Row& q = d.skeleton->stage.rows[at(r)];
    if (row + q.size > loop.unknowns) return false;
    if (q.equation >= 0) {
      const Equation& e = g.equations[at(q.equation)];
      e.part.whole() ? put_identity(e.target) : put(e.part.rows, 1, e.target);
      const int first = d.skeleton->joint.equation_coefficient[at(q.equation)];
      for (std::size_t k = 0; k < e.terms.size(); ++k)
        put(*d.numbers.coefficients[at(first) + k], -1, e.terms[k].signal);
    } else {
      const Signal& y = g.signals[at(q.output)];
      put_identity(q.output);
      for (int i = g.nodes[at(q.node)].first_signal; i < end_signal(g, q.node); ++i)
        if (const Signal& u = g.signals[at(i)]; u.role == Signal::Role::input)
          put(d.numbers.blocks[at(q.node)]->D.block(y.first, u.first, y.size, u.size), -1, i);
    }
    row += q.size;
  }
  return row == loop.unknowns;
}

/// rho(|L^-1| |L|); 1 for a single unknown, 0 where it is not found. `L` is room for the matrix.
double margin(const SystemData& d, const Loop& loop, MatrixXd& L) {
  if (loop.unknowns == 1) return 1;
  if (loop.unknowns > kExactUpTo || !take_loop_matrix(d, loop, L)) return 0;
  return linalg::skeel_radius(L);
}

}  // namespace

void find_margins(const SystemData& d, std::span<const int> loops, std::vector<double>& margins) {
  const std::vector<Loop>& all = d.skeleton->stage.loops;
  margins.resize(all.size(), 0);
  MatrixXd L;
  for (const int i : loops) margins[at(i)] = margin(d, all[at(i)], L);
}

void worst_margin(const SystemData& d, std::span<const double> margins, Check& check) {
  Certificate& c = check.certificate;
  const std::vector<Loop>& loops = d.skeleton->stage.loops;
  int skipped = 0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    skipped += loops[i].unknowns > kExactUpTo;
    if (margins[i] <= c.margin) continue;
    c.margin = margins[i];
    c.margin_where = name_of(d.graph(), loops[i].signals.front());
  }
  c.margin_is_exact = skipped == 0;
  if (skipped > 0)
    check.notes.push_back(
        {Note::Kind::info, "certify",
         fmt::format("{} loop{} of more than {} unknowns: judged by {} pivots, "
                     "not by {} margin",
                     skipped, skipped == 1 ? "" : "s", kExactUpTo, skipped == 1 ? "its" : "their",
                     skipped == 1 ? "its" : "their")});
}

}  // namespace titop::detail
