#pragma once

#include <complex>
#include <titop/titop.hpp>
#include <vector>

/// Chains, ladders and grids of equal bodies with six degrees of freedom: on hinges or bushings
/// with springs and dampers, lossless to thirty times critical, or beams clamped on each other.
/// Their transfers by a recursion of compliances in 50 digits, link by link, without a line of the
/// library but for the modal data of a beam, which are numbers here as there.
namespace titop_test {

struct LossyLinks {
  enum class Joint {
    hinge,
    bushing,
    clamp  ///< of beams
  };
  enum class Base { held, free };
  enum class Tip { force, motion };

  int n;          ///< links from the base to the tip
  int rails = 1;  ///< chains side by side; 2: a ladder, 3: a grid
  Joint joint = Joint::bushing;
  int modes = 0;  ///< of each body but a beam, which has all of its two elements
  double damping =
      0;  ///< ratio: of each joint with the mass of one body, of the modes of beams (below 1)
  Base base = Base::held;
  Tip tip = Tip::force;

  /// Input "u" (6): a wrench on the tip of the first rail, or its acceleration. Outputs (6 each):
  /// "base", the acceleration of the far point of the first link of that rail; "tip", the other one
  /// of the tip's two.
  titop::Diagram diagram() const;
  /// [base; tip] x u.
  Eigen::MatrixXcd exact(std::complex<double> s) const;
};

/// Largest error of a block of three by three over the block's largest entry, or over this share of
/// the block of the same units at the tip, if that is more; blocks below 1e-290, whose numbers have
/// not all their digits, are left out.
double worst_block(const Eigen::MatrixXcd& found, const Eigen::MatrixXcd& exact, double share);

}  // namespace titop_test
