#pragma once

#include <complex>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Separates the part with Gramians from the part without. For the library's own files only.
namespace titop::detail {

/// Damping ratio below which a pole counts as undamped.
inline constexpr double kUndamped = 1e-6;

/// Of its terms: an entry of the integrals that is 0, up to rounding of the separation.
inline constexpr double kNothing = 1e-12;

/// A separate part: the sum of all parts is the whole model.
struct SpectralPart {
  Eigen::MatrixXd A, B, C;
  /// Coordinates of this part in terms of the model's states and back: z = left x, x = right z for
  /// this part alone, left right = I. Units of states cancel in left(j, i) right(i, j).
  Eigen::MatrixXd left, right;
  Eigen::Index order() const { return A.rows(); }
};

/// `integrals`: states that no other one depends on, or that depend on no other one, and so on
/// inwards: motions without stiffness that are only read, integrators of inputs. Found by the
/// pattern, exactly; A is strictly upper triangular; those that reach no output or that no input
/// reaches are left out. `kept`: poles on the axis, nearer to it than rounding or 1e-6 of their
/// modulus, or right of it. `stable`: the rest, with poles well left of the axis. The parts are
/// separated by an ordered Schur form and Sylvester equations; if the solution of these is larger
/// than 1e6 (poles that belong together), the poles nearest the axis are kept, too.
struct Split {
  SpectralPart integrals, kept, stable;
  Eigen::MatrixXcd T, U;                    ///< stable.A = U T U^H, T upper triangular, U unitary
  std::vector<std::complex<double>> poles;  ///< of the model, those with Im >= 0
  /// Outputs: |C| times the units of linalg::similarity_scaling, over all states of the model as
  /// written: size of an output to which the model without ineffective states may have nothing
  /// left.
  Eigen::VectorXd reading;
  /// Damping ratio up to which poles are kept as if they were on the axis.
  double near = kUndamped;
};

/// Throws singular if the parts cannot be separated. O(30 n^3).
Split split(const StateSpace& model);

/// Split::reading of a model. O(n^2).
Eigen::VectorXd reading(const StateSpace& model);

/// Outputs x inputs: size of a pair at s without cancellation of the terms of states and inputs,
/// |C| |x| + |D|; and 1e-3 of its size if all states moved as far as the one that moves farthest,
/// in the units of linalg::similarity_scaling (Split::reading). O(n^2) per input.
Eigen::MatrixXd terms(const StateSpace& model, const Split& split, std::complex<double> s);

}  // namespace titop::detail
