#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <titop/blocks/fe/coupled_nodes.hpp>
#include <titop/blocks/fe/interfaces.hpp>
#include <titop/blocks/fe/line_shapes.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <utility>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

bool is_line(const Coupling& coupling) {
  return coupling.kind == Coupling::Kind::shapes || coupling.kind == Coupling::Kind::moments;
}

/// Number of nodes without those at the place of another one.
Index distinct_places(const Mesh& mesh, const NodeSet& set) {
  const double room = place_tolerance(mesh);
  std::vector<Vector3d> places;
  for (const std::size_t i : set.points)
    if (std::ranges::none_of(places, [&](const Vector3d& r) {
          return (r - mesh.points[i].position).norm() <= room;
        }))
      places.push_back(mesh.points[i].position);
  return static_cast<Index>(places.size());
}

void check_coupling(const Mesh& mesh, const std::string& name, const Coupling& coupling) {
  const NodeSet& set = coupling.nodes;
  const auto refuse = [&](Code code, const std::string& mistake, const char* hint) {
    throw Error(code, fmt::format("interface {} of mesh {}: {}", name, mesh.name, mistake), hint);
  };
  const auto named = [&](const auto& list) {
    return std::ranges::any_of(list, [&](const auto& item) { return item.name == name; });
  };
  if (named(mesh.points) || named(mesh.interfaces))
    refuse(Code::duplicate_name, "the mesh has a point or interface of this name",
           "give each a name of its own");
  const auto count = static_cast<Index>(set.points.size());
  if (set.weights.size() != count)
    refuse(Code::size, fmt::format("{} weights for {} nodes", set.weights.size(), count),
           "give one weight per node, in their order");
  for (const double w : set.weights)
    if (!(w > 0) || !std::isfinite(w))
      refuse(Code::bad_value, fmt::format("a weight of {}", w), "weights are positive");
  std::set<std::size_t> seen, moving;
  for (const Dof& dof : mesh.dofs) moving.insert(dof.point);
  if (count == 0) refuse(Code::bad_value, "it has no nodes", "choose at least one");
  for (const std::size_t i : set.points) {
    if (i >= mesh.points.size() || !seen.insert(i).second)
      refuse(Code::bad_value, fmt::format("its node {} is given twice, or is none", i),
             "indices into Mesh::points, each once");
    if (!moving.contains(i))
      refuse(Code::bad_modes,
             fmt::format("node {} has no degrees of freedom of its own", mesh.points[i].name),
             "it is part of another interface, or of a rigid body: a node belongs to one "
             "interface, leave it out of the other");
  }
  if (!is_line(coupling)) return;
  if (coupling.count < 2)
    refuse(Code::bad_value, fmt::format("{} polynomials", coupling.count),
           "the first two are its rigid motion: legendre(2) or more");
  const Index places = distinct_places(mesh, set);
  if (coupling.count > places)
    refuse(Code::bad_value,
           fmt::format("{} polynomials for {} nodes of {}{}", coupling.count, places, set.name,
                       places < count ? " that differ in their places" : ""),
           "not more polynomials than nodes, or a finer mesh");
}

Vector3d weighted_centre(const Mesh& mesh, const NodeSet& set) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < set.points.size(); ++i)
    sum += set.weights(static_cast<Index>(i)) * mesh.points[set.points[i]].position;
  return sum / set.weights.sum();
}

/// The nodes' motion by the interface's coordinates c, u = T c, and how c is measured if the nodes
/// stay free.
struct CoupledMotion {
  CoupledNodes nodes;
  MatrixXd T;
  std::vector<LineShape> shapes = {};
  EdgeLine line = {};
  Observation measure = {};
};

CoupledMotion motion_of(const Mesh& mesh, const std::string& name, const Coupling& coupling) {
  if (!is_line(coupling)) {
    CoupledMotion m{
        coupled_nodes(mesh, name, coupling.nodes, weighted_centre(mesh, coupling.nodes)), {}};
    m.T = m.nodes.R;
    if (coupling.kind == Coupling::Kind::average) m.measure = measure_of(m.nodes);
    return m;
  }
  const EdgeLine line = line_of(mesh, coupling.nodes);
  CoupledMotion m{coupled_nodes(mesh, name, line.nodes, line.middle), {}};
  m.line = line;
  m.shapes = shapes_of(mesh, line, m.nodes.rows, coupling.count);
  const auto rigid = m.nodes.R.cols();
  m.T.resize(m.nodes.R.rows(), rigid + static_cast<Index>(m.shapes.size()));
  m.T.leftCols(rigid) = m.nodes.R;
  for (std::size_t i = 0; i < m.shapes.size(); ++i)
    m.T.col(rigid + static_cast<Index>(i)) = displacements(mesh, line, m.nodes.rows, m.shapes[i]);
  if (coupling.kind == Coupling::Kind::moments) m.measure = measure_of(mesh, line, m.nodes.rows);
  return m;
}

/// Adds coordinates of the nodes' motion that c does not contain: u = T c + Z z, with c of Z z = 0.
void add_rest(CoupledMotion& m) {
  require_determined(m.nodes, m.measure.B);
  const MatrixXd BT = m.measure.B * m.T, weighted = BT.transpose() * m.measure.W;
  const MatrixXd A = solve_definite(weighted * BT, weighted * m.measure.B);
  const MatrixXd Z = null_basis(m.nodes, A);
  m.T.conservativeResize(Eigen::NoChange, m.T.cols() + Z.cols());
  m.T.rightCols(Z.cols()) = Z;
}

/// The interface's point, its shapes and the rest of the nodes' motion as points of the mesh.
Mesh with_motion(const CoupledMotion& m, const std::string& name) {
  const std::size_t centre = m.nodes.mesh.points.size();
  std::vector<MeshPoint> points = {
      {fmt::format("{} ({})", name, m.nodes.set.name), m.nodes.centre}};
  std::vector<Dof> dofs;
  const auto add = [&](std::string of) {
    dofs.push_back({centre + points.size(), kGeneralised});
    points.push_back({std::move(of), m.nodes.centre});
  };
  for (const int c : m.nodes.moving) dofs.push_back({centre, c});
  MeshLine line{name, m.line.axis, m.line.length, m.shapes, {}};
  for (const LineShape& shape : m.shapes) {
    line.points.push_back(centre + points.size());
    add(fmt::format("{}.{}", name, to_string(shape)));
  }
  for (int k = 1; static_cast<Index>(dofs.size()) < m.T.cols(); ++k)
    add(fmt::format("{} rest {}", name, k));
  Mesh mesh = replaced(m.nodes, m.T, dofs);
  mesh.points.insert(mesh.points.end(), points.begin(), points.end());
  mesh.interfaces.push_back({name, centre, m.nodes.set.points});
  if (!m.shapes.empty()) mesh.lines.push_back(std::move(line));
  return mesh;
}

}  // namespace

Legendre legendre(int m) { return {m}; }
Coupling rigid(NodeSet nodes) { return {Coupling::Kind::rigid, std::move(nodes)}; }
Coupling average(NodeSet nodes) { return {Coupling::Kind::average, std::move(nodes)}; }
Coupling average(NodeSet nodes, const std::vector<double>& weights) {
  nodes.weights = Eigen::Map<const VectorXd>(weights.data(), static_cast<Index>(weights.size()));
  return average(std::move(nodes));
}
Coupling shapes(NodeSet edge, Legendre polynomials) {
  return {Coupling::Kind::shapes, std::move(edge), polynomials.count};
}
Coupling moments(NodeSet edge, Legendre polynomials) {
  return {Coupling::Kind::moments, std::move(edge), polynomials.count};
}

Mesh with_interface(const Mesh& given, const std::string& name, const Coupling& coupling) {
  check(given);
  check_coupling(given, name, coupling);
  if (coupling.nodes.points.size() == 1) {
    Mesh mesh = given;
    mesh.interfaces.push_back({name, coupling.nodes.points[0]});
    return mesh;
  }
  CoupledMotion motion = motion_of(given, name, coupling);
  require_determined(motion.nodes, MatrixXd::Identity(motion.T.rows(), motion.T.rows()));
  if (coupling.kind == Coupling::Kind::average || coupling.kind == Coupling::Kind::moments)
    add_rest(motion);
  return with_motion(motion, name);
}

}  // namespace titop::fe
