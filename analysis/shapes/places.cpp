#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <titop/analysis/shapes/places.hpp>
#include <titop/compiler/loops/common_rotation.hpp>
#include <titop/compiler/loops/expanded_sum.hpp>
#include <titop/graph/declared.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::detail {
namespace {

using Eigen::MatrixXd;
using linalg::at;

/// A frame with its origin.
struct Pose {
  Matrix3d R = Matrix3d::Identity();  ///< to the frame of the assembly's first point
  Vector3d r = Vector3d::Zero();      ///< [m]
  Pose operator*(const Pose& p) const { return {R * p.R, r + R * p.r}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * r)}; }
};

/// Point `to` in the frame of point `from`.
struct PointLink {
  int from = -1, to = -1;
  Pose pose;
};

/// Accelerations of two points in the rows of an equation: S x_target = c x_point.
struct TiedRows {
  MatrixXd S, c;
  void add(const MatrixXd& more_S, const MatrixXd& more_c) {
    MatrixXd both(S.rows() + more_S.rows(), more_S.cols());
    if (S.rows() > 0) both.topRows(S.rows()) = S;
    both.bottomRows(more_S.rows()) = more_S;
    S = both;
    both.resize(c.rows() + more_c.rows(), more_c.cols());
    if (c.rows() > 0) both.topRows(c.rows()) = c;
    both.bottomRows(more_c.rows()) = more_c;
    c = both;
  }
};
using Ties = std::map<std::pair<int, int>, TiedRows>;  // (target, point)

int size_of(const Graph& g, int channel) { return g.channels[at(channel)].size; }

Ties ties_of(const Graph& g) {
  const loops::SumExpander sums(g);
  Ties ties;
  for (const Equation& e : g.equations) {
    const Signal& target = g.signals[at(e.target)];
    if (e.of_block || target.channel < 0 || target.quantity != Quantity::acceleration) continue;
    const loops::ExpandedSum sum = sums.of(e.terms);
    if (sum.points.size() != 1) continue;
    const auto& [point, c] = *sum.points.begin();
    ties[{target.channel, point}].add(
        e.part.whole() ? MatrixXd(MatrixXd::Identity(target.size, target.size)) : e.part.rows(), c);
  }
  return ties;
}

/// tau = [[A, A (*CP)], [0, A]], A from the frame of P to that of C.
Pose pose_of(const MatrixXd& tau) {
  const Matrix3d A = tau.topLeftCorner<3, 3>();
  const Matrix3d CP = A.transpose() * tau.topRightCorner<3, 3>();
  return {A.transpose(), -Vector3d(CP(2, 1), CP(0, 2), CP(1, 0))};
}

void add_links_of_block(const Graph& g, int node, ParameterValues values,
                        std::vector<PointLink>& links, std::vector<std::string>& silent) {
  const Node& n = g.nodes[at(node)];
  const auto& channels = n.block->interface().channels;
  const bool spatial =
      std::any_of(channels.begin(), channels.end(), [](const auto& c) { return c.size == 6; });
  if (!spatial) return;
  const auto k = n.block->kinematics(values);
  if (!k) return silent.push_back(n.name);
  for (int i = 0; i < static_cast<int>(channels.size()); ++i)
    if (i != k->reference && k->tau[at(i)].rows() == 6 && k->tau[at(i)].cols() == 6)
      links.push_back(
          {n.first_channel + k->reference, n.first_channel + i, pose_of(k->tau[at(i)])});
}

/// Points that share two translations or more coincide.
std::optional<PointLink> link_of(const Graph& g, std::pair<int, int> points, const TiedRows& tie) {
  constexpr double kOneTranslation = 1.5;  // trace of a projection: a whole number
  const auto [target, point] = points;
  if (size_of(g, target) != 6 || size_of(g, point) != 6) return std::nullopt;
  if (tie.S.leftCols(3).squaredNorm() < kOneTranslation) return std::nullopt;
  const auto Q = loops::common_rotation(tie.S, tie.c);  // from the point's frame to the target's
  if (!Q) return std::nullopt;
  return PointLink{point, target, {Q->transpose(), Vector3d::Zero()}};
}

/// Poses of all points that are linked to one another; each assembly begins at its first point.
class Poses {
 public:
  Poses(const Graph& g, std::vector<PointLink> links) : pose_(g.channels.size()) {
    std::vector<std::vector<PointLink>> from(g.channels.size());
    for (const PointLink& l : links) {
      from[at(l.from)].push_back(l);
      from[at(l.to)].push_back({l.to, l.from, l.pose.inverse()});
    }
    for (const int n : as_declared(g.nodes)) {
      const Node& node = g.nodes[at(n)];
      const int end =
          node.first_channel + static_cast<int>(node.block->interface().channels.size());
      for (int c = end - 1; c >= node.first_channel; --c)  // the parent is the last
        if (!from[at(c)].empty() && !pose_[at(c)]) start(from, c, node.name);
    }
  }
  const std::optional<Pose>& operator[](int channel) const { return pose_[at(channel)]; }
  const std::vector<std::string>& assemblies() const { return assemblies_; }

 private:
  void start(const std::vector<std::vector<PointLink>>& from, int first, const std::string& name) {
    assemblies_.push_back(name);
    pose_[at(first)] = Pose{};
    for (std::deque<int> queue{first}; !queue.empty(); queue.pop_front())
      for (const PointLink& l : from[at(queue.front())])
        if (!pose_[at(l.to)]) {
          pose_[at(l.to)] = *pose_[at(l.from)] * l.pose;
          queue.push_back(l.to);
        }
  }

  std::vector<std::optional<Pose>> pose_;
  std::vector<std::string> assemblies_;  ///< the first block of each
};

/// The point of one axis that follows another point along a direction; none if it turns.
std::optional<PlacedPoint> on_axis(const PlacedPoint& of, int channel, const MatrixXd& c) {
  PlacedPoint p{channel, of.place, of.translation * c.transpose(), MatrixXd::Zero(3, 1)};
  const bool turns = c.cols() == 6 && !c.rightCols(3).isZero(linalg::kAxisRounding);
  if (turns || p.translation.norm() == 0) return std::nullopt;
  p.translation.normalize();
  return p;
}

/// Adds points of one axis that hang on known points, until there are no more.
void add_axes(const Graph& g, const Ties& ties, ParameterValues values,
              std::vector<PlacedPoint>& points) {
  std::vector<char> known(g.channels.size(), 0);
  for (const PlacedPoint& p : points) known[at(p.channel)] = 1;
  std::multimap<int, std::pair<int, MatrixXd>> ways;  // from -> to, x_to = c x_from
  for (const auto& [pair, tie] : ties)
    if (tie.S.size() == 1) ways.insert({pair.second, {pair.first, tie.S(0, 0) * tie.c}});
  for (const Node& n : g.nodes) {
    const auto count = static_cast<int>(n.block->interface().channels.size());
    const auto k =
        count > 0 && size_of(g, n.first_channel) == 1 ? n.block->kinematics(values) : std::nullopt;
    for (int i = 0; k && i < count; ++i)
      if (i != k->reference && k->tau[at(i)].size() == 1)
        ways.insert({n.first_channel + k->reference, {n.first_channel + i, k->tau[at(i)]}});
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [begin, end] = ways.equal_range(points[i].channel);
    for (auto way = begin; way != end; ++way) {
      const auto& [to, c] = way->second;
      if (known[at(to)]) continue;
      if (auto p = on_axis(points[i], to, c)) points.push_back(*p), known[at(to)] = 1;
    }
  }
}

}  // namespace

Places places(const Graph& g, ParameterValues values) {
  std::vector<PointLink> links;
  std::vector<std::string> silent;
  for (int n = 0; n < static_cast<int>(g.nodes.size()); ++n)
    add_links_of_block(g, n, values, links, silent);
  const Ties ties = ties_of(g);
  for (const auto& [points, tie] : ties)
    if (auto link = link_of(g, points, tie)) links.push_back(*link);
  const Poses poses(g, links);
  Places result;
  for (int c = 0; c < static_cast<int>(g.channels.size()); ++c) {
    if (!poses[c]) continue;
    PlacedPoint p{c, poses[c]->r, MatrixXd::Zero(3, 6), MatrixXd::Zero(3, 6)};
    p.translation.leftCols<3>() = p.rotation.rightCols<3>() = poses[c]->R;
    result.points.push_back(std::move(p));
  }
  add_axes(g, ties, values, result.points);
  if (!silent.empty())
    result.notes.push_back(
        fmt::format("without positions (no Block::kinematics): {}", some_names(silent)));
  if (poses.assemblies().size() > 1)
    result.notes.push_back(
        fmt::format("drawn at one origin, as no joint tells their distance: the assemblies of {}",
                    some_names(poses.assemblies())));
  return result;
}

}  // namespace titop::detail
