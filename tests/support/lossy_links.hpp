#pragma once

#include <complex>
#include <titop/titop.hpp>
#include <vector>

/// Chains, ladders and grids of equal bodies with six degrees of freedom, on hinges or bushings
/// with springs and dampers, lossless to thirty times critical. Their transfers by a recursion of
/// compliances in 50 digits, link by link, without a line of the library.
namespace titop_test {

struct LossyLinks {
  enum class Joint { hinge, bushing };

  int n;          ///< links from the ground to the tip
  int rails = 1;  ///< chains side by side; 2: a ladder, 3: a grid
  Joint joint = Joint::bushing;
  int modes = 0;       ///< of each body
  double damping = 0;  ///< ratio of each joint with the mass of one body

  /// Input: a wrench "F" (6) on the tip of the first rail. Outputs: the accelerations (6 each)
  /// "base", of the far point of the first link of that rail, and "tip", where the wrench acts.
  titop::Diagram diagram() const;
  /// [base; tip] x F.
  Eigen::MatrixXcd exact(std::complex<double> s) const;
};

/// Largest error of a block of three by three over the block's largest entry, or over this share of
/// the block of the same units at the tip, if that is more; blocks below 1e-290, whose numbers have
/// not all their digits, are left out.
double worst_block(const Eigen::MatrixXcd& found, const Eigen::MatrixXcd& exact, double share);

}  // namespace titop_test
