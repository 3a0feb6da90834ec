#include <algorithm>
#include <deque>
#include <numeric>
#include <titop/compiler/passes/close/motion.hpp>
#include <titop/compiler/passes/union_find.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::passes::closing {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool has_orthonormal_rows(const MatrixXd& m) {
  return m.rows() <= m.cols() &&
         (m * m.transpose() - MatrixXd::Identity(m.rows(), m.rows())).cwiseAbs().maxCoeff() <= 1e-9;
}

/// Blocks of three by three of a 6-dof matrix have each their own unit; others are one block.
double relative_gap(const MatrixXd& gap, const MatrixXd& sizes) {
  double worst = 0;
  const Index step = gap.cols() == 6 ? 3 : gap.cols();
  for (Index j = 0; j < gap.cols(); j += step)
    for (Index i = 0; i < gap.rows(); i += (gap.rows() == 6 ? 3 : gap.rows())) {
      const Index rows = gap.rows() == 6 ? 3 : gap.rows();
      const double size = sizes.block(i, j, rows, step).maxCoeff();
      const double off = gap.block(i, j, rows, step).cwiseAbs().maxCoeff();
      if (off > 0) worst = std::max(worst, off / size);
    }
  return worst;
}

}  // namespace

Motion::Motion(const Graph& graph, ParameterValues values, const Twins& twins, Ground ground)
    : g_(graph), ground_(static_cast<int>(graph.channels.size())), at_point_(at(ground_) + 1) {
  add_bodies(values);
  add_ties(twins);
  plant(ground);
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
  const auto k = node.block->kinematics(values);
  const auto count = static_cast<int>(channels.size());
  for (int i = 0; i < count; ++i) {
    const int point = node.first_channel + i;
    if (!k) {
      if (i == 0) continue;
      Edge e{.to = point, .from = node.first_channel, .silent = index, .one_way = true};
      e.R = MatrixXd::Zero(channels[at(i)].size, channels.front().size);
      e.own[{Column::Kind::root, point}] =
          MatrixXd::Identity(channels[at(i)].size, channels[at(i)].size);
      edges_.push_back(std::move(e));
      continue;
    }
    if (i == k->reference) continue;
    const MatrixXd& tau = k->tau[at(i)];
    const bool carried = !tau.isZero(0);
    Edge e{.to = point, .from = carried ? node.first_channel + k->reference : ground_};
    e.R = carried ? tau : MatrixXd(tau.rows(), 0);
    e.one_way = tau.rows() != tau.cols() || !(linalg::inverse(tau).rcond > 1e-12);
    if (node.state >= 0) e.own[{Column::Kind::states, index}] = k->Phi[at(i)];
    edges_.push_back(std::move(e));
  }
}

void Motion::add_ties(const Twins& twins) {
  std::vector<Tie> inverted;
  for (int e = 0; e < static_cast<int>(g_.equations.size()); ++e) {
    const Equation& q = g_.equations[at(e)];
    const Signal& target = g_.signals[at(q.target)];
    if (q.of_block || target.channel < 0 || target.quantity != Quantity::acceleration) continue;
    Tie tie{.equation = e, .target = target.channel};
    tie.S = q.part.whole() ? MatrixXd::Identity(target.size, target.size) : q.part.rows;
    const Twin twin = twins.of(q.terms);
    tie.points = twin.points;
    for (const auto* list : {&twin.rates, &twin.integrals, &twin.states, &twin.others})
      for (const auto& [signal, c] : *list) add(tie.own, {Column::Kind::prescribed, signal}, c);
    const Channel& c = g_.channels[at(target.channel)];
    (c.takes == Takes::accel ? ties_ : inverted).push_back(std::move(tie));
  }
  // A locked child point closes the chain rather than the joint that carries the body.
  for (Tie& tie : inverted) ties_.push_back(std::move(tie));
}

/// The tie as an edge of the tree, if its coefficient can be turned round: whole, or orthonormal.
std::optional<Motion::Edge> Motion::edge_of(const Tie& tie) const {
  if (tie.points.size() > 1) return std::nullopt;
  Edge e{.to = tie.target, .from = ground_, .equation = tie.equation};
  const auto free = complement(tie.S, static_cast<int>(tie.S.cols()));
  for (const auto& [column, matrix] : tie.own) e.own[column] = tie.S.transpose() * matrix;
  if (free.rows() > 0) e.own[{Column::Kind::angle, tie.equation}] = free.transpose();
  e.R = MatrixXd(tie.S.cols(), 0);
  if (tie.points.empty()) return e;
  const auto& [point, c] = *tie.points.begin();
  e.from = point;
  if (c.cols() != tie.S.cols()) return std::nullopt;  // a scalar point beside one of six
  e.rigid = has_orthonormal_rows(c);
  if (!e.rigid && (c.rows() != c.cols() || free.rows() > 0 || !(linalg::inverse(c).rcond > 1e-3)))
    return std::nullopt;
  // What the joint leaves free is counted from the other side: any completion of c will do.
  e.R = tie.S.transpose() * c;
  if (free.rows() > 0) {
    if (c.rows() == 3 && c.cols() == 6 && c.rightCols(3).isZero(0) && tie.S.rightCols(3).isZero(0))
      e.R.bottomRightCorner(3, 3) =
          tie.S.leftCols(3).transpose() * c.leftCols(3);  // the same rotation for both halves
    else
      e.R += free.transpose() * complement(c, static_cast<int>(c.cols()));
  }
  return e;
}

Motion::Edge Motion::reversed(const Edge& e) const {
  Edge r = e;
  r.to = e.from, r.from = e.to;
  r.R = linalg::inverse(e.R).matrix;
  for (auto& [column, matrix] : r.own) matrix = -(r.R * matrix);
  return r;
}

void Motion::plant(Ground ground) {
  UnionFind joined(ground_ + 1);
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
  const auto take = [&](Tie& tie) {
    auto edge = edge_of(tie);
    // A point that only its own body can place is never the way to anything else.
    tie.closes = !edge || one_way[at(edge->to)] || one_way[at(edge->from)] ||
                 joined.find(edge->to) == joined.find(edge->from);
    if (tie.closes) return;
    edges_.push_back(std::move(*edge));
    join(static_cast<int>(edges_.size()) - 1);
  };
  for (Tie& tie : ties_)
    if (ground == Ground::by_name || !tie.points.empty()) take(tie);
  for (Tie& tie : ties_)
    if (ground == Ground::last && tie.points.empty()) take(tie);
  up_.assign(at(ground_) + 1, {});
  depth_.assign(at(ground_) + 1, -1);
  root_.assign(at(ground_) + 1, -1);
  std::vector<int> starts{ground_};
  for (int p = 0; p < ground_; ++p)
    if (!one_way[at(p)]) starts.push_back(p);
  for (const int start : starts) {
    if (depth_[at(start)] >= 0) continue;
    depth_[at(start)] = 0, root_[at(start)] = start;
    std::deque<int> queue{start};
    while (!queue.empty()) {
      const int p = queue.front();
      queue.pop_front();
      for (const int e : at_point_[at(p)]) {
        const Edge& edge = edges_[at(e)];
        const int other = edge.from == p ? edge.to : edge.from;
        if (depth_[at(other)] >= 0) continue;
        up_[at(other)] = edge.from == p ? edge : reversed(edge);
        depth_[at(other)] = depth_[at(p)] + 1, root_[at(other)] = start;
        queue.push_back(other);
      }
    }
  }
}

int Motion::meeting(int a, int b) const {
  if (root_[at(a)] != root_[at(b)]) return -1;
  while (a != b)
    (depth_[at(a)] >= depth_[at(b)] ? a : b) = up_[at(depth_[at(a)] >= depth_[at(b)] ? a : b)].from;
  return a;
}

bool Motion::rigid_between(int point, int above) const {
  for (; point != above; point = up_[at(point)].from)
    if (!up_[at(point)].rigid) return false;
  return true;
}

MatrixXd Motion::walk(Form& form, MatrixXd factor, int point, int above, MatrixXd* sizes) const {
  while (point != above && depth_[at(point)] > 0) {
    const Edge& e = up_[at(point)];
    add(form, factor, e.own);
    if (e.from == ground_) return MatrixXd(factor.rows(), 0);
    factor = factor * e.R;
    point = e.from;
    if (sizes && sizes->cols() == factor.cols()) *sizes = sizes->cwiseMax(factor.cwiseAbs());
  }
  return factor;
}

void Motion::add_root(Form& form, const MatrixXd& factor, int root) const {
  if (root != ground_) add(form, {Column::Kind::root, root}, factor);
}

Form Motion::position(int channel) const {
  Form form;
  const int size = g_.channels[at(channel)].size;
  add_root(form, walk(form, MatrixXd::Identity(size, size), channel, -1), root_[at(channel)]);
  return form;
}

std::vector<char> Motion::at_rest(const std::function<bool(const Column&, int)>& held) const {
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

void Motion::list_ties(int point, int above, std::vector<int>& equations) const {
  for (; point != above && depth_[at(point)] > 0; point = up_[at(point)].from)
    if (up_[at(point)].equation >= 0) equations.push_back(up_[at(point)].equation);
}

Closing Motion::closing(const Tie& tie) const {
  Closing result{.tie = &tie, .equations = {tie.equation}};
  add(result.form, -MatrixXd::Identity(tie.S.rows(), tie.S.rows()), tie.own);
  const int other = tie.points.empty() ? ground_ : tie.points.begin()->first;
  int top = tie.points.size() > 1 ? -1 : meeting(tie.target, other);
  for (int p = tie.target; p != ground_ && p != top && depth_[at(p)] > 0; p = up_[at(p)].from)
    result.chain.push_back(p);
  if (top >= 0) result.chain.push_back(top);
  std::vector<int> back;
  for (int p = other; top >= 0 && p != top; p = up_[at(p)].from) back.push_back(p);
  result.chain.insert(result.chain.end(), back.rbegin(), back.rend());
  // A gear passes on motions that are not rigid: there the whole assembly's motion counts.
  const bool rigid = top >= 0 && top != ground_ && rigid_between(tie.target, top) &&
                     rigid_between(other, top) &&
                     (tie.points.empty() || has_orthonormal_rows(tie.points.begin()->second));
  if (top != ground_ && !rigid) top = -1;
  list_ties(tie.target, top, result.equations);
  for (const auto& [point, c] : tie.points) list_ties(point, top, result.equations);
  MatrixXd sizes = tie.S.cwiseAbs();  // how far the way round leads
  MatrixXd here = walk(result.form, tie.S, tie.target, top, &sizes);
  if (top < 0) add_root(result.form, here, root_[at(tie.target)]);
  MatrixXd gap = here;
  for (const auto& [point, c] : tie.points) {
    const MatrixXd there = walk(result.form, -c, point, top, &sizes);
    if (top < 0)
      add_root(result.form, there, root_[at(point)]);
    else if (top != ground_)
      gap += there;
  }
  if (top < 0 || top == ground_) return result;
  // What a free angle on the way can take up is no gap.
  MatrixXd free(gap.rows(), 0);
  for (const auto& [column, matrix] : result.form)
    if (column.kind == Column::Kind::angle) {
      free.conservativeResize(gap.rows(), free.cols() + matrix.cols());
      free.rightCols(matrix.cols()) = matrix;
    }
  if (free.cols() > 0) {
    MatrixXd basis(0, gap.rows());
    for (Index j = 0; j < free.cols(); ++j) {
      Eigen::RowVectorXd v = free.col(j).transpose();
      const double size = v.norm();
      for (int twice = 0; twice < 2; ++twice) v -= (v * basis.transpose()) * basis;
      if (!(v.norm() > 1e-9 * size)) continue;
      basis.conservativeResize(basis.rows() + 1, gap.rows());
      basis.bottomRows(1) = v.normalized();
    }
    gap -= basis.transpose() * (basis * gap);
  }
  result.gap = relative_gap(gap, sizes);
  return result;
}

int Motion::silent(const std::vector<int>& chain) const {
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    const int below = depth_[at(chain[i])] > depth_[at(chain[i + 1])] ? chain[i] : chain[i + 1];
    if (up_[at(below)].silent >= 0) return up_[at(below)].silent;
  }
  return -1;
}

}  // namespace titop::passes::closing
