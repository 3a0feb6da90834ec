#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <titop/blocks/fe/grids.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/symmetric.hpp>

/// Rigid motions, positions and frames by statics.
namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd rigid_motions_by_statics(const GridMatrices& m, int grid) {
  check(m);
  std::vector<Index> r, f, components;
  for (Index i = 0; i < m.K.rows(); ++i) {
    const GridDof& dof = m.dofs[static_cast<std::size_t>(i)];
    const bool of_grid = dof.grid == grid && dof.component > 0;
    (of_grid ? r : f).push_back(i);
    if (of_grid) components.push_back(dof.component - 1);
  }
  if (r.empty())
    throw Error(Code::unknown_name, fmt::format("the matrices of {} have no grid {}", m.name, grid),
                "take one of the grids of GridMatrices::dofs");
  const MatrixXd K_ff = m.K(f, f);
  if (const Index row = weak_pivot(K_ff); row >= 0) {
    const GridDof& dof = m.dofs[static_cast<std::size_t>(f[static_cast<std::size_t>(row)])];
    throw Error(
        Code::bad_modes,
        fmt::format("{} clamped at grid {}, which has {} components, moves without stiffness at "
                    "grid {}, component {}",
                    m.name, grid, r.size(), dof.grid, dof.component),
        "clamp it at a grid with rotations, and leave out rows without stiffness and mass: m = "
        "without(m, empty_rows(m))");
  }
  MatrixXd R = MatrixXd::Zero(m.K.rows(), 6);
  for (std::size_t i = 0; i < r.size(); ++i) R(r[i], components[i]) = 1;
  R(f, components) = -solve_definite(K_ff, m.K(f, r));
  return R;
}

namespace {

/// Rows of R of a grid, by component (0 to 5).
using GridRows = std::map<int, Eigen::Matrix<double, 1, 6>>;

constexpr double kNotRigid = 1e-3;  ///< no rounding of K: parts that move relative to each other

/// A grid that R moves. `turns`: the rotations that the grid of the statics has; R has no others.
struct PlacedGrid {
  const GridRows& rows;
  const std::array<bool, 3>& turns;
  Matrix3d frame = Matrix3d::Identity();  ///< components in the grid's frame to the body's
  Vector3d position = Vector3d::Zero();

  /// The nearest rotation. One that differs from 1 by no more than R from a rotation is 1.
  void find_frame() {
    if (!turns[0] || !turns[1] || !turns[2]) return;
    if (!rows.contains(3) || !rows.contains(4) || !rows.contains(5)) return;
    Matrix3d turned;
    for (int c = 0; c < 3; ++c) turned.row(c) = rows.at(3 + c).tail<3>();
    const Eigen::JacobiSVD<Matrix3d> svd(turned, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Matrix3d nearest = svd.matrixV() * svd.matrixU().transpose();
    const double noise = std::max((svd.singularValues().array() - 1).abs().maxCoeff(), 1e-12);
    if ((nearest - Matrix3d::Identity()).cwiseAbs().maxCoeff() > 10 * noise) frame = nearest;
  }

  /// A translation along t of the point p by a turn about e is t . (e x p) = (t x e) . p.
  void find_position() {
    MatrixXd A = MatrixXd::Zero(9, 3);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(9);
    for (const auto& [component, row] : rows)
      for (int j = 0; j < 3 && component < 3; ++j) {
        if (!turns[static_cast<std::size_t>(j)]) continue;
        A.row(3 * component + j) = frame.col(component).cross(Vector3d::Unit(j)).transpose();
        b(3 * component + j) = row(3 + j);
      }
    position = A.completeOrthogonalDecomposition().solve(b);
  }

  /// Largest difference of R's turns from those of a rigid body, lengths relative to the distance.
  double misfit() const {
    const Matrix6 rigid = tau(-position);
    double worst = 0;
    for (const auto& [component, row] : rows) {
      const int first = component < 3 ? 0 : 3;
      const double size = component < 3 ? std::max(1.0, position.norm()) : 1.0;
      for (int j = 0; j < 3; ++j)
        if (turns[static_cast<std::size_t>(j)])
          worst = std::max(
              worst, std::abs(row(3 + j) -
                              frame.col(component - first).dot(rigid.block<3, 1>(first, 3 + j))) /
                         size);
    }
    return worst;
  }
};

std::map<int, GridRows> rows_of_grids(const GridMatrices& m, const MatrixXd& R) {
  std::map<int, GridRows> rows;
  for (std::size_t i = 0; i < m.dofs.size(); ++i)
    if (m.dofs[i].component > 0)
      rows[m.dofs[i].grid][m.dofs[i].component - 1] = R.row(static_cast<Index>(i));
  return rows;
}

}  // namespace

std::vector<Grid> grids_by_statics(const GridMatrices& m, int grid) {
  const std::map<int, GridRows> all = rows_of_grids(m, rigid_motions_by_statics(m, grid));
  const GridRows& own = all.at(grid);
  const std::array<bool, 3> turns = {own.contains(3), own.contains(4), own.contains(5)};
  std::vector<Grid> grids;
  for (const auto& [id, rows] : all) {
    PlacedGrid placed{rows, turns};
    placed.find_frame();
    placed.find_position();
    const double off = placed.misfit();
    if (off > kNotRigid)
      throw Error(
          Code::bad_modes,
          fmt::format("grid {} of {} does not move with grid {} as a rigid body, by {:.1e}", id,
                      m.name, grid, off),
          "take another grid, where rounding of K has less effect, or give the positions; or "
          "the stiffness has supports, or parts that are joined in some directions only");
    const bool turned = placed.frame != Matrix3d::Identity();
    grids.push_back(
        {id, placed.position, turned ? Rotation::matrix(placed.frame) : Rotation(), {}, off});
  }
  return grids;
}

}  // namespace titop::fe
