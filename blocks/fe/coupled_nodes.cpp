#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <titop/blocks/fe/coupled_nodes.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <utility>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const Dof& dof_of(const CoupledNodes& n, std::size_t i) {
  return n.mesh.dofs[static_cast<std::size_t>(n.rows[i])];
}

/// The unit of every row in which rotations and a plate's twist are comparable with displacements.
VectorXd row_units(const CoupledNodes& n) {
  const double length = n.length > 0 ? n.length : 1;
  VectorXd units(static_cast<Index>(n.rows.size()));
  for (std::size_t i = 0; i < n.rows.size(); ++i) {
    const int c = dof_of(n, i).component;
    units(static_cast<Index>(i)) = c < 3 ? 1 : 1 / (c == kTwist ? length * length : length);
  }
  return units;
}

/// Of the radius of gyration: nodes that are farther off a line are beside it, however small the
/// interface is in its mesh.
constexpr double kSurelyBeside = 0.01;

/// Directions of the point, as twists, that rows B of the nodes, with weights W, do not determine:
/// turning about them moves the nodes by less than the accuracy of their places.
MatrixXd undetermined(const CoupledNodes& n, const MatrixXd& B, const MatrixXd& W) {
  const MatrixXd BR = B * row_units(n).cwiseInverse().asDiagonal() * n.R;
  const MatrixXd G = BR.transpose() * W * BR;
  VectorXd scale = VectorXd::Ones(G.rows());
  for (Index i = 0; i < G.rows(); ++i)
    if (n.moving[static_cast<std::size_t>(i)] >= 3) scale(i) = n.length > 0 ? 1 / n.length : 1;
  const SymmetricModes modes = eigh(scale.asDiagonal() * G * scale.asDiagonal());
  const double arm =
      std::min(place_tolerance(n.mesh) / (n.length > 0 ? n.length : 1), kSurelyBeside);
  const double least = std::max(arm * arm, linalg::kAxisRounding) * modes.lambda.tail(1).value();
  const Index count = (modes.lambda.array() <= least).count();
  return scale.asDiagonal() * modes.V.leftCols(count);
}

[[noreturn]] void refuse_undetermined(const CoupledNodes& n, const VectorXd& twist) {
  Vector6 w = Vector6::Zero();
  w(n.moving) = twist;
  w /= w.cwiseAbs().maxCoeff();
  for (double& x : w)
    if (std::abs(x) < linalg::kHalfDigits) x = 0;
  throw Error(
      Code::bad_modes,
      fmt::format("interface {} of mesh {}: {} does not determine its motion in {}", n.name,
                  n.mesh.name, n.set.name, combination(w)),
      "nodes on one line, without rotations, do not turn about it: take nodes beside the line, or "
      "nodes with rotations");
}

double weight_of(const CoupledNodes& n, std::size_t point) {
  return n.set.weights(std::ranges::find(n.set.points, point) - n.set.points.begin());
}

/// Rows of B with their weights.
struct WeightedRows {
  std::vector<VectorXd> rows = {};
  std::vector<double> weights = {};

  void add(VectorXd row, double weight) {
    if (row.isZero(0)) return;
    rows.push_back(std::move(row));
    weights.push_back(weight);
  }
  Observation stacked(Index columns) const {
    const auto count = static_cast<Index>(rows.size());
    Observation m{MatrixXd::Zero(count, columns), MatrixXd::Zero(count, count)};
    for (Index i = 0; i < count; ++i) {
      m.B.row(i) = rows[static_cast<std::size_t>(i)];
      m.W(i, i) = weights[static_cast<std::size_t>(i)];
    }
    return m;
  }
};

/// A node's own rotations, times the rotation of this twist.
VectorXd own_rotation(const CoupledNodes& n, std::size_t point, const VectorXd& twist) {
  VectorXd row = VectorXd::Zero(n.R.rows());
  for (std::size_t i = 0; i < n.rows.size(); ++i) {
    const auto at = std::ranges::find(n.moving, dof_of(n, i).component);
    if (dof_of(n, i).point == point && at != n.moving.end() && *at >= 3)
      row(static_cast<Index>(i)) = twist(at - n.moving.begin());
  }
  return row;
}

}  // namespace

CoupledNodes coupled_nodes(const Mesh& mesh, const std::string& name, const NodeSet& nodes,
                           const Vector3d& centre) {
  CoupledNodes n{mesh, name, nodes, centre};
  for (const std::size_t i : nodes.points)
    n.length += (mesh.points[i].position - centre).squaredNorm() / double(nodes.points.size());
  n.length = std::sqrt(n.length);
  if (n.length <= place_tolerance(mesh)) n.length = 0;
  const std::set<std::size_t> points(nodes.points.begin(), nodes.points.end());
  for (std::size_t i = 0; i < mesh.dofs.size(); ++i)
    if (points.contains(mesh.dofs[i].point)) n.rows.push_back(static_cast<Index>(i));
  const std::array<bool, 6> still = still_directions(mesh, centre);
  for (int c = 0; c < 6; ++c)
    if (!still.at(static_cast<std::size_t>(c))) n.moving.push_back(c);
  n.R = rigid_motions(mesh, centre)(n.rows, n.moving);
  return n;
}

void require_determined(const CoupledNodes& n, const MatrixXd& B) {
  const MatrixXd free = undetermined(n, B, MatrixXd::Identity(B.rows(), B.rows()));
  if (free.cols() > 0) refuse_undetermined(n, free.col(0));
}

Observation measure_of(const CoupledNodes& n) {
  WeightedRows rows;
  for (std::size_t i = 0; i < n.rows.size(); ++i)
    if (dof_of(n, i).component < 3)
      rows.add(VectorXd::Unit(n.R.rows(), static_cast<Index>(i)), weight_of(n, dof_of(n, i).point));
  const Observation displaced = rows.stacked(n.R.rows());
  const MatrixXd free = undetermined(n, displaced.B, displaced.W);
  for (Index k = 0; k < free.cols(); ++k)
    for (const std::size_t point : n.set.points)
      rows.add(own_rotation(n, point, free.col(k)), weight_of(n, point));
  return rows.stacked(n.R.rows());
}

Mesh replaced(const CoupledNodes& n, const MatrixXd& T, const std::vector<Dof>& dofs) {
  Mesh mesh = n.mesh;
  std::vector<Index> others;
  mesh.dofs.clear();
  for (Index i = 0; i < n.mesh.M.rows(); ++i)
    if (!std::binary_search(n.rows.begin(), n.rows.end(), i)) {
      others.push_back(i);
      mesh.dofs.push_back(n.mesh.dofs[static_cast<std::size_t>(i)]);
    }
  mesh.dofs.insert(mesh.dofs.end(), dofs.begin(), dofs.end());
  const auto a = static_cast<Index>(others.size()), b = T.cols();
  const auto transformed = [&](const MatrixXd& S) {
    MatrixXd result(a + b, a + b);
    result.topLeftCorner(a, a) = S(others, others);
    result.topRightCorner(a, b) = S(others, n.rows) * T;
    result.bottomLeftCorner(b, a) = result.topRightCorner(a, b).transpose();
    const MatrixXd corner = T.transpose() * S(n.rows, n.rows) * T;
    result.bottomRightCorner(b, b) = (corner + corner.transpose()) / 2;
    return result;
  };
  mesh.M = transformed(n.mesh.M);
  mesh.K = transformed(n.mesh.K);
  return mesh;
}

MatrixXd null_basis(const CoupledNodes& n, const MatrixXd& A) {
  const VectorXd scale = row_units(n);
  MatrixXd scaled = A * scale.asDiagonal();
  const VectorXd norms = scaled.rowwise().norm();
  scaled = norms.cwiseInverse().asDiagonal() * scaled;
  const SymmetricModes modes = eigh(scaled.transpose() * scaled);
  return scale.asDiagonal() * modes.V.leftCols(A.cols() - A.rows());
}

}  // namespace titop::fe
