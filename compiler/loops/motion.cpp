#include <algorithm>
#include <deque>
#include <numeric>
#include <titop/compiler/loops/common_rotation.hpp>
#include <titop/compiler/loops/gap.hpp>
#include <titop/compiler/loops/motion.hpp>
#include <titop/compiler/loops/relations.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <utility>

namespace titop::loops {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

bool has_orthonormal_rows(const MatrixXd& m) {
  return m.rows() <= m.cols() &&
         (m * m.transpose() - MatrixXd::Identity(m.rows(), m.rows())).cwiseAbs().maxCoeff() <=
             linalg::kMatrixDigits;
}

/// In any unit of length: lever arms are entries beside 1.
bool invertible(const MatrixXd& tau) {
  if (tau.rows() != tau.cols()) return false;
  if (linalg::inverse(tau).rcond > kMatrixDigits) return true;
  const auto [row, column] = linalg::two_sided_scaling(tau);
  return linalg::inverse(row.asDiagonal() * tau * column.asDiagonal()).rcond > kMatrixDigits;
}

}  // namespace

Motion::Motion(const Graph& graph, ParameterValues values, const SumExpander& sums, Ground ground,
               std::span<const Released> released)
    : g_(graph), ground_(static_cast<int>(graph.channels.size())), at_point_(at(ground_) + 1) {
  add_bodies(values);
  add_ties(sums, ground);
  std::vector<Tie> whole;
  for (const Released& r : released) whole.push_back(tie_of(r.whole, r.closing, sums, ground));
  find_rotations(whole);
  plant(std::move(whole));
}

std::string Motion::name(int point) const {
  return point == ground_ ? "the ground" : channel_name(g_, point);
}

void Motion::add_bodies(ParameterValues values) {
  for (int i = 0; i < static_cast<int>(g_.nodes.size()); ++i)
    if (!g_.nodes[at(i)].block->interface().channels.empty()) add_body(i, values);
}

void Motion::add_body(int index, ParameterValues values) {
  const Node& node = g_.nodes[at(index)];
  const auto& channels = node.block->interface().channels;
  const ClosedForm* const closed = closed_form_of(*node.block);
  const auto k = closed ? closed->undeformed() : node.block->kinematics(values);
  const auto count = static_cast<int>(channels.size());
  for (int i = 0; i < count; ++i) {
    const int point = node.first_channel + i;
    if (!k) {
      if (i == 0) continue;
      Edge e{.to = point, .from = node.first_channel, .silent = index, .one_way = true};
      e.R = MatrixXd::Zero(channels[at(i)].size, channels.front().size);
      e.own[{FormColumn::Kind::root, point}] =
          MatrixXd::Identity(channels[at(i)].size, channels[at(i)].size);
      edges_.push_back(std::move(e));
      continue;
    }
    if (i == k->reference) continue;
    const MatrixXd& tau = k->tau[at(i)];
    const bool carried = !tau.isZero(0);
    Edge e{.to = point, .from = carried ? node.first_channel + k->reference : ground_};
    e.R = carried ? tau : MatrixXd(tau.rows(), 0);
    e.one_way = !invertible(tau);
    if (node.state >= 0) e.own[{FormColumn::Kind::states, index}] = k->Phi[at(i)];
    if (closed) e.own[{FormColumn::Kind::root, point}] = MatrixXd::Identity(tau.rows(), tau.rows());
    edges_.push_back(std::move(e));
  }
}

void Motion::add_ties(const SumExpander& sums, Ground ground) {
  for (int e = 0; e < static_cast<int>(g_.equations.size()); ++e) {
    const Equation& q = g_.equations[at(e)];
    const Signal& target = g_.signals[at(q.target)];
    if (q.of_block || target.channel < 0 || target.quantity != Quantity::acceleration) continue;
    ties_.push_back(tie_of(q, e, sums, ground));
  }
  std::sort(ties_.begin(), ties_.end(),
            [](const Tie& a, const Tie& b) { return a.order < b.order; });
  find_rotations(ties_);
}

/// Finds the common rotation of all ties between the same two points.
void Motion::find_rotations(std::vector<Tie>& ties) {
  std::map<std::pair<int, int>, std::vector<Tie*>> between;
  for (Tie& tie : ties)
    if (tie.S.cols() == 6 && tie.points.size() == 1 && tie.points.begin()->second.cols() == 6)
      between[{tie.target, tie.points.begin()->first}].push_back(&tie);
  for (const auto& [points, together] : between) {
    MatrixXd S(0, 6), c(0, 6);
    for (const Tie* tie : together) {
      S.conservativeResize(S.rows() + tie->S.rows(), 6);
      S.bottomRows(tie->S.rows()) = tie->S;
      c.conservativeResize(S.rows(), 6);
      c.bottomRows(tie->S.rows()) = tie->points.begin()->second;
    }
    const auto rotation = common_rotation(S, c);
    for (Tie* tie : together) tie->rotation = rotation;
  }
}

Tie Motion::tie_of(const Equation& q, int index, const SumExpander& sums, Ground ground) const {
  const Signal& target = g_.signals[at(q.target)];
  Tie tie{.equation = index, .target = target.channel};
  tie.S = q.part.whole() ? MatrixXd::Identity(target.size, target.size) : q.part.rows();
  const ExpandedSum sum = sums.of(q.terms);
  tie.points = sum.points;
  for (const auto* list : {&sum.rates, &sum.integrals, &sum.states, &sum.others})
    for (const auto& [signal, c] : *list) add(tie.own, {FormColumn::Kind::prescribed, signal}, c);
  // A locked child point closes the chain rather than the joint that carries the body.
  const auto all = static_cast<int>(g_.equations.size());
  const bool inverted = g_.channels[at(target.channel)].takes != Takes::accel;
  tie.late = ground == Ground::last && tie.points.empty();
  tie.order = index + (inverted ? all : 0) + (tie.late ? 2 * all : 0);
  return tie;
}

/// The tie as an edge of the tree, if its coefficient can be turned round: whole, or orthonormal.
std::optional<Motion::Edge> Motion::edge_of(const Tie& tie) const {
  if (tie.points.size() > 1) return std::nullopt;
  Edge e{.to = tie.target, .from = ground_, .equation = tie.equation};
  const auto free = complement(tie.S, static_cast<int>(tie.S.cols()));
  for (const auto& [column, matrix] : tie.own) e.own[column] = tie.S.transpose() * matrix;
  if (free.rows() > 0) e.own[{FormColumn::Kind::angle, tie.equation}] = free.transpose();
  e.R = MatrixXd(tie.S.cols(), 0);
  if (tie.points.empty()) return e;
  const auto& [point, c] = *tie.points.begin();
  e.from = point;
  if (c.cols() != tie.S.cols()) return std::nullopt;  // a scalar point joined to one of six
  const bool six = c.cols() == 6, orthonormal = has_orthonormal_rows(c);
  e.rigid = six ? tie.rotation.has_value() : orthonormal;
  if (!orthonormal &&
      (c.rows() != c.cols() || free.rows() > 0 || !(linalg::inverse(c).rcond > kThreeDigits)))
    return std::nullopt;
  // Freedom of the joint is counted from the other side: any completion of c suffices. One that
  // moves both points as one body has no gap.
  e.R = tie.S.transpose() * c;
  if (free.rows() == 0) return e;
  if (six && tie.rotation) {
    const Matrix3d& Q = *tie.rotation;
    MatrixXd turned(free.rows(), 6);
    turned << free.leftCols(3) * Q, free.rightCols(3) * Q;
    e.R += free.transpose() * turned;
  } else {
    e.R += free.transpose() * complement(c, static_cast<int>(c.cols()));
  }
  return e;
}

Motion::Edge Motion::reversed(const Edge& e) const {
  Edge r = e;
  r.to = e.from, r.from = e.to;
  r.R = linalg::inverse(e.R).matrix;
  RoundedSum own(units_of_rows(MatrixXd::Identity(r.R.rows(), r.R.rows())));
  own.meet(r.R), own.add(-r.R, e.own);
  r.own = own.cleaned();
  return r;
}

void Motion::plant(std::vector<Tie> released) {
  passes::UnionFind joined(ground_ + 1);
  std::vector<char> one_way(at(ground_) + 1, 0);
  const auto join = [&](int e) {
    joined.unite(edges_[at(e)].to, edges_[at(e)].from);
    at_point_[at(edges_[at(e)].to)].push_back(e);
    at_point_[at(edges_[at(e)].from)].push_back(e);
  };
  for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
    join(e);
    if (edges_[at(e)].one_way && edges_[at(e)].from != ground_) one_way[at(edges_[at(e)].to)] = 1;
  }
  for (Tie& tie : ties_) {
    auto edge = edge_of(tie);
    // A point that only its own body can place is never the way to anything else.
    tie.closes = !edge || one_way[at(edge->to)] || one_way[at(edge->from)] ||
                 joined.find(edge->to) == joined.find(edge->from);
    if (tie.closes) continue;
    edges_.push_back(std::move(*edge));
    join(static_cast<int>(edges_.size()) - 1);
  }
  hang(one_way);
  for (Tie& tie : ties_)
    if (tie.closes) tie.length = tree_way(tie);
  plant_shortcuts(std::move(released), one_way);
}

void Motion::hang(const std::vector<char>& one_way) {
  up_.assign(at(ground_) + 1, {});
  below_.resize(at(ground_) + 1);
  depth_.assign(at(ground_) + 1, -1);
  root_.assign(at(ground_) + 1, -1);
  jump_.resize(at(ground_) + 1);
  std::vector<int> starts{ground_};
  for (int p = 0; p < ground_; ++p)
    if (!one_way[at(p)]) starts.push_back(p);
  for (const int start : starts) {
    if (depth_[at(start)] >= 0) continue;
    depth_[at(start)] = 0, root_[at(start)] = start, jump_[at(start)] = start;
    std::deque<int> queue{start};
    while (!queue.empty()) {
      const int p = queue.front();
      queue.pop_front();
      for (const int e : at_point_[at(p)]) {
        const Edge& edge = edges_[at(e)];
        const int other = edge.from == p ? edge.to : edge.from;
        if (depth_[at(other)] >= 0) continue;
        up_[at(other)] = edge.from == p ? edge : reversed(edge);
        below_[at(p)].push_back(other);
        depth_[at(other)] = depth_[at(p)] + 1, root_[at(other)] = start;
        const int far = jump_[at(p)], farther = jump_[at(far)];
        const bool even = depth_[at(p)] - depth_[at(far)] == depth_[at(far)] - depth_[at(farther)];
        jump_[at(other)] = even ? farther : p;
        queue.push_back(other);
      }
    }
  }
}

int Motion::meeting(int a, int b) const {
  if (root_[at(a)] != root_[at(b)]) return -1;
  if (depth_[at(a)] < depth_[at(b)]) std::swap(a, b);
  while (depth_[at(a)] > depth_[at(b)])
    a = depth_[at(jump_[at(a)])] >= depth_[at(b)] ? jump_[at(a)] : up_[at(a)].from;
  while (a != b) {
    const bool far = jump_[at(a)] != jump_[at(b)];
    a = far ? jump_[at(a)] : up_[at(a)].from;
    b = far ? jump_[at(b)] : up_[at(b)].from;
  }
  return a;
}

Motion::Way Motion::up_from(int point, int above) const {
  Way way;
  for (; point != above && depth_[at(point)] > 0; point = up_[at(point)].from)
    way.edges.push_back(up_[at(point)]);
  way.to = point;
  return way;
}

bool Motion::Way::rigid() const {
  return std::all_of(edges.begin(), edges.end(), [](const Edge& e) { return e.rigid; });
}

MatrixXd Motion::walk(RoundedSum& sum, MatrixXd factor, const Way& way) const {
  sum.meet(factor);
  for (const Edge& e : way.edges) {
    sum.add(factor, e.own);
    if (e.from == ground_) return MatrixXd(factor.rows(), 0);
    factor = factor * e.R;
    sum.meet(factor);
  }
  return factor;
}

void Motion::add_root(RoundedSum& sum, const MatrixXd& factor, int root) const {
  if (root == ground_) return;
  sum.add(factor,
          {{{FormColumn::Kind::root, root}, MatrixXd::Identity(factor.cols(), factor.cols())}});
}

Form Motion::position(int channel) const {
  const int size = g_.channels[at(channel)].size;
  const MatrixXd all = MatrixXd::Identity(size, size);
  RoundedSum sum(units_of_rows(all));
  add_root(sum, walk(sum, all, up_from(channel, -1)), root_[at(channel)]);
  return sum.cleaned();
}

std::vector<char> Motion::at_rest(const std::function<bool(const FormColumn&, int)>& held) const {
  std::vector<char> result(at(ground_) + 1, 0);
  std::vector<int> points(result.size());
  std::iota(points.begin(), points.end(), 0);
  std::stable_sort(points.begin(), points.end(),
                   [&](int a, int b) { return depth_[at(a)] < depth_[at(b)]; });
  for (const int p : points) {
    if (p == ground_) result[at(p)] = 1;
    if (depth_[at(p)] <= 0) continue;
    result[at(p)] = result[at(up_[at(p)].from)];
    for (const auto& [column, matrix] : up_[at(p)].own)
      for (Index j = 0; j < matrix.cols(); ++j)
        if (!matrix.col(j).isZero(0) && !held(column, static_cast<int>(j))) result[at(p)] = 0;
  }
  result.pop_back();
  return result;
}

void Motion::add_gap(RoundedSum& sum, const MatrixXd& gap, int point, Closing& closing) const {
  const Way up = up_from(point, -1);
  add_root(sum, walk(sum, gap, up), root_[at(point)]);
  for (const Edge& e : up.edges)
    if (e.equation >= 0) closing.equations.push_back(e.equation);
}

Closing Motion::closing(const Tie& tie) const {
  Closing result{.tie = &tie, .equations = {tie.equation}};
  const MatrixXd minus = -MatrixXd::Identity(tie.S.rows(), tie.S.rows());
  RoundedSum sum(units_of_rows(tie.S));
  sum.meet(minus), sum.add(minus, tie.own);
  auto [there, back] = ways(tie);
  const bool meets = tie.points.size() <= 1 && there.to == back.to;
  for (const Edge& e : there.edges) result.chain.push_back(e.to);
  if (meets) {
    result.chain.push_back(there.to);
    for (auto e = back.edges.rbegin(); e != back.edges.rend(); ++e) result.chain.push_back(e->to);
  }
  const auto list = [&](const Way& way) {
    for (const Edge& e : way.edges)
      if (e.equation >= 0) result.equations.push_back(e.equation);
  };
  // A gear passes on motions that are not rigid: there the whole assembly's motion counts.
  const bool to_ground = meets && there.to == ground_;
  const bool rigid = meets && !to_ground && there.rigid() && back.rigid() &&
                     (tie.points.empty() || has_orthonormal_rows(tie.points.begin()->second));
  if (!rigid && !to_ground) {
    there = up_from(tie.target, -1);
    list(there);
    add_root(sum, walk(sum, tie.S, there), root_[at(tie.target)]);
    for (const auto& [point, c] : tie.points) {
      back = up_from(point, -1);
      list(back);
      add_root(sum, walk(sum, -c, back), root_[at(point)]);
    }
    result.form = sum.cleaned();
    return result;
  }
  list(there), list(back);
  MatrixXd gap = walk(sum, tie.S, there);
  for (const auto& [point, c] : tie.points) {
    const MatrixXd at_meeting = walk(sum, -c, back);
    if (!to_ground) gap += at_meeting;
  }
  result.form = sum.cleaned();
  if (to_ground) return result;
  const Gap found = gap_of(gap, result.form, units_of_rows(tie.S), sum.lever());
  result.gap = found.off;
  result.gap_length = found.length;
  if (found.taken.size() == 0) return result;
  add_gap(sum, found.taken, there.to, result);
  result.form = sum.cleaned();
  return result;
}

int Motion::silent(const std::vector<int>& chain) const {
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    const int below = depth_[at(chain[i])] > depth_[at(chain[i + 1])] ? chain[i] : chain[i + 1];
    if (up_[at(below)].silent >= 0) return up_[at(below)].silent;
  }
  return -1;
}

}  // namespace titop::loops
