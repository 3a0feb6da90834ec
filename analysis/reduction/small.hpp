#pragma once

#include <titop/analysis/reduction/whole.hpp>
#include <titop/graph/linalg/symmetric.hpp>

/// A small model in second order, as a projection of the whole. For the library's own files only.
namespace titop::detail {

/// Reciprocal condition number of eigenvectors below which modes count as defective.
constexpr double kDefective = 1e-5;

/// q'' + Z q' + k q = b u, y = D0 u + ca q'' + cv q' + cq q. The first `own` coordinates,
/// those without stiffness among them unless momenta couple these, are decoupled from all others.
struct Small {
  Eigen::VectorXd k;  ///< r, ascending; 0 for motions without stiffness
  Eigen::Index own = 0;
  Eigen::MatrixXd Z;           ///< r x r, or 0 x 0; its antisymmetric part is that of momenta
  Eigen::Index resting = 0;    ///< poles at 0 among the coupled rates: Whole::resting
  Eigen::MatrixXd b;           ///< r x inputs
  Eigen::MatrixXd ca, cv, cq;  ///< outputs x r
  Eigen::MatrixXd D0;          ///< outputs x inputs
  Eigen::MatrixXd V;           ///< modes of the whole x r, orthonormal columns

  /// If damping couples the last coordinates, their part of the transfer by its poles:
  /// sum of left * right / (s - pole); empty if these are too close to defective.
  Eigen::VectorXcd pole;
  Eigen::MatrixXcd left, right;  ///< outputs x poles, poles x inputs
  Eigen::MatrixXd instant;       ///< its direct term

  Eigen::Index order() const { return k.size(); }
  /// False for a motion without stiffness whose position is not read: it has a rate only.
  bool has_position(Eigen::Index j) const { return k(j) != 0 || !cq.col(j).isZero(0); }
  /// Of the model: the rates, and the positions that it has.
  int states() const;
  /// Outputs x inputs. O(r), O((r - own)^3) without `pole`.
  Eigen::MatrixXcd transfer(std::complex<double> s) const;
  /// Responses of the coordinates to input m at s.
  Eigen::VectorXcd response(std::complex<double> s, Eigen::Index m) const;
  /// Its poles, those of positive imaginary part for pairs. O(r^3).
  std::vector<std::complex<double>> poles() const;
};

/// Eigenvectors of W' Lambda W, by the inverse problem: stiff directions do not reduce the accuracy
/// of soft ones.
SymmetricModes ritz(const Eigen::VectorXd& lambda, const Eigen::MatrixXd& W);

/// The whole in the span of all motions without stiffness, the modes `kept` and the columns W
/// (elastic modes x columns, orthonormal, 0 in the rows of `kept`): Galerkin, so that M = I, k >= 0
/// and Z + Z' >= 0. Static gains stay those of the whole.
Small project(const Whole& whole, const std::vector<Eigen::Index>& kept, const Eigen::MatrixXd& W);

}  // namespace titop::detail
