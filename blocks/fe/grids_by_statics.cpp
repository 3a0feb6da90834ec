#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <titop/blocks/fe/grids.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
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

using linalg::kThreeDigits;  ///< positions that have fewer are of no use

/// R by statics, and the errors of its rows that errors of K make.
class Statics {
 public:
  Statics(const GridMatrices& m, int grid) : m_(m), R_(rigid_motions_by_statics(m, grid)) {
    for (Index i = 0; i < m.K.rows(); ++i) {
      const GridDof& dof = m.dofs[static_cast<std::size_t>(i)];
      if (dof.grid != grid || dof.component == 0) free_.push_back(i);
    }
    terms_ = m.K.cwiseAbs() * R_.cwiseAbs();
    require_free(grid);
  }
  const MatrixXd& motions() const { return R_; }

  /// n x 6: with K + dK, R changes by -K_ff^-1 dK R to first order: |K_ff^-1| |dK| |R|.
  MatrixXd errors() const {
    const auto n = std::ssize(free_);
    const MatrixXd inverse =
        solve_definite(m_.K(free_, free_), MatrixXd::Identity(n, n)).cwiseAbs();
    // Besides that of its entries the rounding of the factorisation [Higham 10.3].
    const Eigen::VectorXd root = m_.K.diagonal().cwiseAbs().cwiseSqrt();
    const double rounding = static_cast<double>(n + 1) * linalg::kEpsilon;
    const MatrixXd off = relative_ * terms_ + rounding * root * (root.transpose() * R_.cwiseAbs());
    MatrixXd result = MatrixXd::Zero(R_.rows(), 6);
    result(free_, Eigen::all) = inverse * off(free_, Eigen::all);
    return result;
  }

 private:
  /// The reaction R'KR of the grid is 0 but for R'dK R. The relative error of K is half a unit of
  /// its last digit, or what the reaction shows.
  void require_free(int grid) {
    const MatrixXd reaction = (R_.transpose() * m_.K * R_).cwiseAbs();
    const MatrixXd scale = R_.cwiseAbs().transpose() * terms_;
    Index row = 0, column = 0;
    const double resists =
        (scale.array() > 0).select(reaction.array() / scale.array(), 0.0).maxCoeff(&row, &column);
    const double digit = std::pow(10, -m_.digits);
    if (resists > std::max(linalg::kTextDigits, 100 * digit))
      throw Error(Code::bad_modes,
                  fmt::format("the stiffness of {} resists the rigid motion of grid {} along {}, "
                              "by {:.1e} of its terms",
                              m_.name, grid, component_name(static_cast<int>(row)), resists),
                  "leave supports out of it: they are part of the diagram");
    relative_ = std::max(5 * digit, resists);
  }

  const GridMatrices& m_;
  MatrixXd R_, terms_;
  std::vector<Index> free_;
  double relative_ = 0;
};

/// A grid that R moves. `turns`: the rotations that the grid of the statics has; R has no others.
struct PlacedGrid {
  const GridRows &rows, &errors;
  const std::array<bool, 3>& turns;
  Matrix3d frame = Matrix3d::Identity();  ///< components in the grid's frame to the body's
  Vector3d position = Vector3d::Zero();

  /// The nearest rotation. One that differs from 1 by no more than R from a rotation is 1.
  void find_frame() {
    if (!turns[0] || !turns[1] || !turns[2]) return;
    if (!rows.contains(3) || !rows.contains(4) || !rows.contains(5)) return;
    Matrix3d turned, unsure;
    for (int c = 0; c < 3; ++c) {
      turned.row(c) = rows.at(3 + c).tail<3>();
      unsure.row(c) = errors.at(3 + c).tail<3>();
    }
    const Eigen::JacobiSVD<Matrix3d> svd(turned, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double noise =
        std::max((svd.singularValues().array() - 1).abs().maxCoeff(), linalg::kAxisRounding);
    const double off = (turned - Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (off > std::min(10 * noise, unsure.maxCoeff()))
      frame = svd.matrixV() * svd.matrixU().transpose();
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

  /// Largest difference of R's turns from those of a rigid body, lengths relative to `size`.
  double misfit(double size) const {
    const Matrix6 rigid = tau(-position);
    double worst = 0;
    for (const auto& [component, row] : rows) {
      const int first = component < 3 ? 0 : 3;
      for (int j = 0; j < 3; ++j)
        if (turns[static_cast<std::size_t>(j)])
          worst = std::max(
              worst, std::abs(row(3 + j) -
                              frame.col(component - first).dot(rigid.block<3, 1>(first, 3 + j))) /
                         (component < 3 ? size : 1.0));
    }
    return worst;
  }

  /// The misfit that the errors e of the turns may make: the nearest rotation, or 1, is within 3 e
  /// of R in Frobenius's norm, within 6 e of the frame; with it, lengths are off by 6 e + 3 e.
  double explained(double size) const {
    double e = 0;
    for (const auto& [component, row] : errors)
      e = std::max(e, row.tail<3>().maxCoeff() / (component < 3 ? size : 1.0));
    return 9 * e;
  }
};

std::map<int, GridRows> rows_of_grids(const GridMatrices& m, const MatrixXd& R) {
  std::map<int, GridRows> rows;
  for (std::size_t i = 0; i < m.dofs.size(); ++i)
    if (m.dofs[i].component > 0)
      rows[m.dofs[i].grid][m.dofs[i].component - 1] = R.row(static_cast<Index>(i));
  return rows;
}

[[noreturn]] void refuse_flexible(const GridMatrices& m, int id, int grid, double off,
                                  double limit) {
  throw Error(Code::bad_modes,
              fmt::format("grid {} of {} does not move with grid {} as a rigid body, by {:.1e}; "
                          "errors of the stiffness explain {:.1e}",
                          id, m.name, grid, off, limit),
              off > limit ? "the stiffness has parts that are joined in some directions only, or "
                            "rows of other grids; or give the positions"
                          : "take another grid, where rounding of K has less effect, or give the "
                            "positions");
}

}  // namespace

std::vector<Grid> grids_by_statics(const GridMatrices& m, int grid) {
  const Statics statics(m, grid);
  const std::map<int, GridRows> all = rows_of_grids(m, statics.motions()),
                                errors = rows_of_grids(m, statics.errors());
  const GridRows& own = all.at(grid);
  const std::array<bool, 3> turns = {own.contains(3), own.contains(4), own.contains(5)};
  std::map<int, PlacedGrid> placed;
  double size = 0;
  for (const auto& [id, rows] : all) {
    PlacedGrid& p = placed.insert({id, PlacedGrid{rows, errors.at(id), turns}}).first->second;
    p.find_frame();
    p.find_position();
    size = std::max(size, p.position.norm());
  }
  if (size == 0) size = 1;  // of one grid
  std::vector<Grid> grids;
  for (const auto& [id, p] : placed) {
    const double off = p.misfit(size), limit = p.explained(size);
    if (off > std::min(limit, kThreeDigits)) refuse_flexible(m, id, grid, off, limit);
    const bool turned = p.frame != Matrix3d::Identity();
    grids.push_back({id, p.position, turned ? Rotation::matrix(p.frame) : Rotation(), {}, off});
  }
  return grids;
}

}  // namespace titop::fe
