#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <titop/blocks/fe/mesh.hpp>
#include <vector>

/// A mesh clamped at its parent. For the folder's own files.
namespace titop::fe {

/// A mesh clamped at its parent. f: all rows but the parent's.
struct Clamped {
  const Mesh& mesh;
  std::vector<Eigen::Index> f;  ///< n_f rows of the mesh
  Eigen::MatrixXd M, K;         ///< n_f x n_f
  Eigen::MatrixXd M_rf;         ///< 6 x n_f
  Matrix6 D_P;
  std::array<bool, 6> rigid = {};  ///< directions without degrees of freedom, by ModeOptions::rigid
};

/// Throws bad_modes and bad_value, as `modal_data` does.
Clamped clamp(const Mesh& mesh, const std::string& parent, const ModeOptions& options);

/// Name of a row of f.
std::string name_of(const Clamped& clamped, Eigen::Index row);

/// Throws bad_modes: rows without stiffness and mass, or else a mechanism that moves at this row of
/// f.
[[noreturn]] void refuse_mechanism(const Clamped& clamped, Eigen::Index row);

/// Rows of f at which one of the children has a degree of freedom.
std::vector<Eigen::Index> loaded_rows(const Clamped& clamped,
                                      const std::vector<std::string>& children);

}  // namespace titop::fe
