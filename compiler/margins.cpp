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

/// Loop matrix of one strong component: its rows and unknowns of the equations, dense.
MatrixXd loop_matrix(const SystemData& d, const Loop& loop) {
  const Graph& g = d.graph();
  std::vector<int> column;  // of the loop's signals, which ascend
  int n = 0;
  for (const int s : loop.signals) column.push_back(n), n += g.signals[at(s)].size;
  MatrixXd L = MatrixXd::Zero(n, n);
  int row = 0;
  const auto put = [&](const MatrixXd& c, int signal) {
    const auto found = std::lower_bound(loop.signals.begin(), loop.signals.end(), signal);
    if (found != loop.signals.end() && *found == signal)
      L.block(row, column[static_cast<std::size_t>(found - loop.signals.begin())], c.rows(),
              c.cols()) += c;
  };
  for (const int r : loop.rows) {
    const Row& q = d.skeleton->stage.rows[at(r)];
    if (row + q.size > n) return {};
    if (q.equation >= 0) {
      const Equation& e = g.equations[at(q.equation)];
      const int size = g.signals[at(e.target)].size;
      put(e.part.whole() ? MatrixXd::Identity(size, size) : e.part.rows, e.target);
      const int first = d.skeleton->joint.equation_coefficient[at(q.equation)];
      for (std::size_t k = 0; k < e.terms.size(); ++k)
        put(-*d.numbers.coefficients[at(first) + k], e.terms[k].signal);
    } else {
      const Signal& y = g.signals[at(q.output)];
      put(MatrixXd::Identity(y.size, y.size), q.output);
      for (int i = g.nodes[at(q.node)].first_signal; i < end_signal(g, q.node); ++i)
        if (const Signal& u = g.signals[at(i)]; u.role == Signal::Role::input)
          put(-d.numbers.blocks[at(q.node)]->D.block(y.first, u.first, y.size, u.size), i);
    }
    row += q.size;
  }
  return row == n ? L : MatrixXd();
}

/// rho(|L^-1| |L|); 1 for a single unknown, 0 where it is not found.
double margin(const SystemData& d, const Loop& loop) {
  if (loop.unknowns == 1) return 1;
  if (loop.unknowns > kExactUpTo) return 0;
  const MatrixXd L = loop_matrix(d, loop);
  if (L.size() == 0) return 0;
  const linalg::Inverse inverse = linalg::inverse(L);
  if (inverse.rcond == 0) return 0;
  return linalg::perron(inverse.matrix.cwiseAbs() * L.cwiseAbs());
}

}  // namespace

void find_margins(const SystemData& d, std::span<const int> loops, std::vector<double>& margins) {
  const std::vector<Loop>& all = d.skeleton->stage.loops;
  margins.resize(all.size(), 0);
  for (const int i : loops) margins[at(i)] = margin(d, all[at(i)]);
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
