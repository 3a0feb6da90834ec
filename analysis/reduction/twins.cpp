#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <titop/analysis/reduction/twins.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAlike = 1e-10;  ///< of an entry, on the scale of its row and column

using linalg::at;

/// node -> channel by channel (index in the block's interface) the nodes at its equations.
using Neighbours = std::vector<std::map<int, std::set<int>>>;

Neighbours neighbours(const Graph& g) {
  Neighbours n(g.nodes.size());
  const auto join = [&](int a, int b) {
    const Signal &s = g.signals[at(a)], &t = g.signals[at(b)];
    if (s.node >= 0 && t.node >= 0 && s.node != t.node) n[at(s.node)][s.spec].insert(t.node);
  };
  for (const Equation& e : g.equations)
    for (const Term& t : e.terms)
      if (e.target >= 0 && t.signal >= 0) join(e.target, t.signal), join(t.signal, e.target);
  return n;
}

/// The exchange of nodes implied by the exchange of a and b: their neighbours are exchanged, too,
/// as long as they are equal; common neighbours stay. None if a node has no counterpart.
std::optional<std::map<int, int>> exchange(const Graph& g, const Neighbours& n, int a, int b) {
  std::map<int, int> image{{a, b}, {b, a}};
  std::vector<std::pair<int, int>> front{{a, b}};
  while (!front.empty()) {
    const auto [p, q] = front.back();
    front.pop_back();
    if (n[at(p)].size() != n[at(q)].size()) return std::nullopt;
    for (const auto& [channel, of_p] : n[at(p)]) {
      const auto found = n[at(q)].find(channel);
      if (found == n[at(q)].end() || found->second.size() != of_p.size()) return std::nullopt;
      auto j = found->second.begin();
      for (const int x : of_p) {
        const int y = *j++;
        if (x == y || image.count(x) > 0) continue;
        // Every joint is a block of its own: compare their types.
        const Block &bx = *g.nodes[at(x)].block, &by = *g.nodes[at(y)].block;
        if (&bx != &by && (bx.type() != by.type() ||
                           bx.interface().states.size() != by.interface().states.size()))
          return std::nullopt;
        image[x] = y;
        image[y] = x;
        front.emplace_back(x, y);
      }
    }
  }
  return image;
}

/// Places of the elastic coordinates after the exchange; empty if they do not match.
std::vector<Index> permutation(const Coordinates& c, const std::map<int, int>& image) {
  std::map<int, std::vector<Index>> of_node;
  for (Index i = 0; i < c.n_elastic; ++i) of_node[c.nodes[at(i)]].push_back(i);
  std::vector<Index> to(at(c.n_elastic));
  bool moves = false;
  for (const auto& [node, list] : of_node) {
    const auto found = image.find(node);
    const auto& other = found == image.end() ? list : of_node[found->second];
    if (other.size() != list.size()) return {};
    for (std::size_t k = 0; k < list.size(); ++k) to[at(list[k])] = other[k];
    moves = moves || found != image.end();
  }
  return moves ? to : std::vector<Index>{};
}

/// Signs t with t_i t_j X(i, j) = X(to i, to j) and t_i F(i) = F(to i) along the strongest entries,
/// from the columns of F on.
VectorXd find_signs(const MatrixXd& X, const MatrixXd& F, const std::vector<Index>& to) {
  const Index n = X.rows();
  VectorXd sign = VectorXd::Zero(n), best = VectorXd::Zero(n), offered = VectorXd::Ones(n);
  for (Index i = 0; i < n; ++i)
    for (Index m = 0; m < F.cols(); ++m)
      if (const double f = std::abs(F(i, m)); f > best(i))
        best(i) = f, offered(i) = F(i, m) * F(to[at(i)], m) < 0 ? -1 : 1;
  for (Index step = 0; step < n; ++step) {
    Index next = -1;
    for (Index i = 0; i < n; ++i)
      if (sign(i) == 0 && (next < 0 || best(i) > best(next))) next = i;
    sign(next) = sign(to[at(next)]) != 0 ? sign(to[at(next)]) : offered(next);
    for (Index i = 0; i < n; ++i)
      if (const double x = std::abs(X(next, i)); sign(i) == 0 && x > best(i))
        best(i) = x,
        offered(i) = sign(next) * (X(next, i) * X(to[at(next)], to[at(i)]) < 0 ? -1 : 1);
  }
  return sign;
}

bool same(const MatrixXd& X, const VectorXd& sign, const std::vector<Index>& to) {
  for (Index i = 0; i < X.rows(); ++i)
    for (Index j = 0; j <= i; ++j)
      if (!(std::abs(X(i, j) - sign(i) * sign(j) * X(to[at(i)], to[at(j)])) <= kAlike))
        return false;
  return true;
}

bool same_rows(const MatrixXd& F, const VectorXd& sign, const std::vector<Index>& to) {
  for (Index i = 0; i < F.rows(); ++i)
    for (Index m = 0; m < F.cols(); ++m)
      if (!(std::abs(F(i, m) - sign(i) * F(to[at(i)], m)) <= kAlike)) return false;
  return true;
}

/// Columns of largest entry 1.
MatrixXd unit_columns(MatrixXd m) {
  for (Index j = 0; j < m.cols(); ++j)
    if (const double size = m.col(j).cwiseAbs().maxCoeff(); size > 0) m.col(j) /= size;
  return m;
}

/// The motions that stay: common ones of pairs, and single ones of sign 1.
MatrixXd even(const VectorXd& sign, const std::vector<Index>& to, std::vector<Index>& first) {
  for (Index i = 0; i < sign.size(); ++i)
    if (to[at(i)] > i || (to[at(i)] == i && sign(i) > 0)) first.push_back(i);
  MatrixXd S = MatrixXd::Zero(sign.size(), static_cast<Index>(first.size()));
  for (std::size_t k = 0; k < first.size(); ++k) {
    const Index i = first[k], j = to[at(i)];
    S(i, static_cast<Index>(k)) = i == j ? 1 : std::sqrt(0.5);
    if (i != j) S(j, static_cast<Index>(k)) = sign(i) * std::sqrt(0.5);
  }
  return S;
}

/// Root mean square of each row over coordinates scaled to stiffness 1.
VectorXd row_sizes(const MatrixXd& C, const VectorXd& K) {
  const MatrixXd scaled = C.leftCols(K.size()) * K.cwiseSqrt().cwiseInverse().asDiagonal();
  return scaled.rowwise().norm() / std::sqrt(static_cast<double>(K.size()));
}

/// Outputs that depend only on removed motions: sets their rounding in the others to exact zeros.
/// Their direct terms stay.
void silence(Coordinates& c, const Coordinates& before) {
  const VectorXd q = row_sizes(before.C_q, before.K.diagonal()),
                 v = row_sizes(before.C_v, before.K.diagonal());
  const VectorXd q_left = row_sizes(c.C_q, c.K.diagonal()),
                 v_left = row_sizes(c.C_v, c.K.diagonal());
  const Index loose = c.size() - c.n_elastic;
  for (Index i = 0; i < q.size(); ++i) {
    if (q(i) + v(i) == 0 || q_left(i) > kAlike * q(i) || v_left(i) > kAlike * v(i)) continue;
    if (!c.C_q.row(i).tail(loose).isZero(0) || !c.C_v.row(i).tail(loose).isZero(0)) continue;
    c.C_q.row(i).setZero();
    c.C_v.row(i).setZero();
    c.silent.row(i) << q(i), v(i);
  }
}

void project(Coordinates& c, const MatrixXd& S, const std::vector<Index>& first) {
  const Coordinates old = c;
  const Index n = c.n_elastic, loose = c.size() - n;
  const auto widened = [&](const MatrixXd& C) {
    MatrixXd result(C.rows(), S.cols() + loose);
    result << C.leftCols(n) * S, C.rightCols(loose);
    return result;
  };
  c.G = S.transpose() * old.G * S;
  c.K = MatrixXd((S.transpose() * old.K * S).diagonal().asDiagonal());
  if (c.D.size() > 0) c.D = S.transpose() * old.D * S;
  c.A_loose = old.A_loose * S;
  c.B = widened(old.B.transpose()).transpose();
  c.C_q = widened(old.C_q);
  c.C_v = widened(old.C_v);
  c.shares = old.shares * S.cwiseAbs2();
  c.n_elastic = S.cols();
  std::vector<Index> kept = first;
  for (Index i = n; i < n + loose; ++i) kept.push_back(i);
  c.names.clear(), c.nodes.clear(), c.position.clear(), c.rate.clear();
  for (const Index i : kept) {
    c.names.push_back(old.names[at(i)]);
    c.nodes.push_back(old.nodes[at(i)]);
    c.position.push_back(old.position[at(i)]);
    c.rate.push_back(old.rate[at(i)]);
  }
  silence(c, old);
}

bool same_sizes(const MatrixXd& F, const std::vector<Index>& to) {
  for (Index m = 0; m < F.cols(); ++m)
    for (Index i = 0; i < F.rows(); ++i)
      if (!(std::abs(std::abs(F(i, m)) - std::abs(F(to[at(i)], m))) <= kAlike)) return false;
  return true;
}

bool same_diagonal(const MatrixXd& X, const std::vector<Index>& to) {
  for (Index i = 0; i < X.rows(); ++i)
    if (std::abs(X(i, i) - X(to[at(i)], to[at(i)])) > kAlike * X(i, i)) return false;
  return true;
}

/// Tries one exchange; true if coordinates were removed. An exchange that is no symmetry with any
/// signs is rejected in O(n).
bool try_exchange(Coordinates& c, const std::vector<Index>& to) {
  const Index n = c.n_elastic;
  if (!same_diagonal(c.K, to) || !same_diagonal(c.G, to) || !same_diagonal(c.D, to)) return false;
  const VectorXd d = c.G.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd B = unit_columns(d.asDiagonal() * c.B.topRows(n));
  const VectorXd k = c.K.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd read = unit_columns(k.asDiagonal() * c.C_q.leftCols(n).transpose());
  const MatrixXd rates = unit_columns(k.asDiagonal() * c.C_v.leftCols(n).transpose());
  MatrixXd C(n, read.cols() + rates.cols());
  C << read, rates;
  for (const bool driven : {true, false}) {
    if (!driven && c.size() > n) return false;  // loose motions are read from all others
    const MatrixXd& F = driven ? B : C;
    if (!same_sizes(F, to)) continue;
    const MatrixXd G = d.asDiagonal() * c.G * d.asDiagonal();
    const VectorXd sign = find_signs(G, F, to);
    if (!same_rows(F, sign, to) || !same(G, sign, to)) continue;
    std::vector<Index> first;
    const MatrixXd S = even(sign, to, first);
    if (S.cols() == n) return false;
    project(c, S, first);
    return true;
  }
  return false;
}

}  // namespace

TwinReduction join_twins(Coordinates& c, const Graph& g) {
  TwinReduction result;
  if (!c.diagonal) return result;
  const Neighbours near = neighbours(g);
  for (int a = 0; a < static_cast<int>(g.nodes.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(g.nodes.size()); ++b) {
      if (g.nodes[at(a)].block != g.nodes[at(b)].block || g.nodes[at(a)].state < 0) continue;
      const auto image = exchange(g, near, a, b);
      if (!image) continue;
      const std::vector<Index> to = permutation(c, *image);
      const Index before = c.n_elastic;
      if (to.empty() || !try_exchange(c, to)) continue;
      result.removed += static_cast<int>(before - c.n_elastic);
      result.pairs.push_back(fmt::format("{} and {}", g.nodes[at(a)].name, g.nodes[at(b)].name));
    }
  return result;
}

}  // namespace titop::detail
