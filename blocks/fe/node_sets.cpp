#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <titop/blocks/fe/node_sets.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <utility>

namespace titop::fe {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

std::string print(const Vector3d& r) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", r.x(), r.y(), r.z());
}

/// Largest distance of two corners of the box of all points.
double size_of(const Mesh& mesh) {
  if (mesh.points.empty()) return 0;
  Vector3d low = mesh.points[0].position, high = low;
  for (const MeshPoint& p : mesh.points)
    low = low.cwiseMin(p.position), high = high.cwiseMax(p.position);
  return (high - low).norm();
}

/// Points with displacements or rotations that satisfy the condition.
std::vector<std::size_t> points_where(const Mesh& mesh,
                                      const std::function<bool(const Vector3d&)>& condition) {
  std::vector<bool> moves(mesh.points.size());
  for (const Dof& dof : mesh.dofs)
    if (dof.component < kGeneralised) moves[dof.point] = true;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (moves[i] && condition(mesh.points[i].position)) result.push_back(i);
  return result;
}

NodeSet with_equal_weights(std::string name, std::vector<std::size_t> points) {
  const auto count = static_cast<Index>(points.size());
  return {std::move(name), std::move(points), VectorXd::Ones(count)};
}

/// Points along a line, in order, with half of the lengths to the neighbours as weights.
NodeSet with_lengths(const Mesh& mesh, std::string name, std::vector<std::size_t> points) {
  const auto count = static_cast<Index>(points.size());
  VectorXd weights = count == 1 ? VectorXd::Ones(1) : VectorXd::Zero(count);
  for (Index i = 0; i + 1 < count; ++i) {
    const auto at = [&](Index k) {
      return mesh.points[points[static_cast<std::size_t>(k)]].position;
    };
    const double half = (at(i + 1) - at(i)).norm() / 2;
    weights(i) += half;
    weights(i + 1) += half;
  }
  return {std::move(name), std::move(points), std::move(weights)};
}

const MeshEdge& find_edge(const Mesh& mesh, const std::string& name) {
  const auto found = std::ranges::find(mesh.edges, name, &MeshEdge::name);
  if (found != mesh.edges.end()) return *found;
  std::string names;
  for (const MeshEdge& e : mesh.edges) names += (names.empty() ? "" : ", ") + e.name;
  throw Error(Code::unknown_name, fmt::format("mesh {} has no edge {}", mesh.name, name),
              names.empty() ? "it has no named edges: choose nodes by segment(mesh, A, B)"
                            : "its edges are " + names);
}

/// Index among the edge's points of the one at this fraction of its length.
std::size_t node_at(const Mesh& mesh, const MeshEdge& edge, double fraction) {
  std::vector<double> at = {0};
  for (std::size_t i = 1; i < edge.points.size(); ++i)
    at.push_back(
        at.back() +
        (mesh.points[edge.points[i]].position - mesh.points[edge.points[i - 1]].position).norm());
  const double length = at.back(), place = fraction * length, room = place_tolerance(mesh);
  double before = 0, behind = length;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (std::abs(at[i] - place) <= room) return i;
    (at[i] < place ? before : behind) = at[i];
    if (at[i] > place) break;
  }
  throw Error(Code::bad_value,
              fmt::format("edge {} of mesh {} has no node at {} of its length", edge.name,
                          mesh.name, fraction),
              fmt::format("a segment ends at nodes, here at {:.6g} or {:.6g}: take these, or a "
                          "mesh with a node there",
                          before / length, behind / length));
}

}  // namespace

double place_tolerance(const Mesh& mesh) {
  return 10 * std::max(linalg::kTextDigits, mesh.position_noise) * size_of(mesh);
}

NodeSet nodes(const Mesh& mesh, const std::vector<std::string>& names) {
  std::vector<std::size_t> points;
  for (const std::string& name : names) points.push_back(find_point(mesh, name));
  return with_equal_weights(fmt::format("{} nodes by name", names.size()), std::move(points));
}

NodeSet box(const Mesh& mesh, const Vector3d& low, const Vector3d& high) {
  const double room = place_tolerance(mesh);
  std::vector<std::size_t> points = points_where(mesh, [&](const Vector3d& r) {
    return ((r - low).array() >= -room).all() && ((high - r).array() >= -room).all();
  });
  std::string name = fmt::format("box {} to {}", print(low), print(high));
  if (points.empty())
    throw Error(Code::bad_value, fmt::format("mesh {} has no node in the {}", mesh.name, name),
                "give its lowest and highest corner, in the body's frame and the mesh's unit of "
                "length");
  return with_equal_weights(std::move(name), std::move(points));
}

NodeSet edge(const Mesh& mesh, const std::string& name) {
  return with_lengths(mesh, "edge " + name, find_edge(mesh, name).points);
}

NodeSet segment(const Mesh& mesh, const std::string& name, double from, double to) {
  const MeshEdge& whole = find_edge(mesh, name);
  if (!(from >= 0 && from < to && to <= 1))
    throw Error(Code::bad_value,
                fmt::format("a segment of edge {} is given from {} to {}", name, from, to),
                "give fractions of its length, from 0 to 1, the smaller one first");
  const std::size_t first = node_at(mesh, whole, from), last = node_at(mesh, whole, to);
  return with_lengths(mesh, fmt::format("edge {} from {:g} to {:g}", name, from, to),
                      {whole.points.begin() + static_cast<std::ptrdiff_t>(first),
                       whole.points.begin() + static_cast<std::ptrdiff_t>(last) + 1});
}

NodeSet segment(const Mesh& mesh, const Vector3d& A, const Vector3d& B) {
  const double room = place_tolerance(mesh), length = (B - A).norm();
  const Vector3d along = length > 0 ? Vector3d((B - A) / length) : Vector3d::Zero();
  const auto place = [&](const Vector3d& r) { return along.dot(r - A); };
  std::vector<std::size_t> points = points_where(mesh, [&](const Vector3d& r) {
    return place(r) >= -room && place(r) <= length + room &&
           (r - A - place(r) * along).norm() <= room;
  });
  std::string name = fmt::format("segment {} to {}", print(A), print(B));
  if (points.empty())
    throw Error(Code::bad_value, fmt::format("mesh {} has no node on the {}", mesh.name, name),
                "give both ends in the body's frame and the mesh's unit of length");
  std::ranges::sort(points, {}, [&](std::size_t i) { return place(mesh.points[i].position); });
  return with_lengths(mesh, std::move(name), std::move(points));
}

}  // namespace titop::fe
