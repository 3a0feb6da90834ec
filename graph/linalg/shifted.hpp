#pragma once

#include <titop/graph/linalg/dense.hpp>
#include <vector>

namespace titop::linalg {

/// (s - A) X = B for many s, by one complex Schur form of each uncoupled part of A after a
/// similarity scaling by powers of two: O(25 n^3) once for a part of n states, then O(n^2 m) per s
/// in place of the O(n^3) of `solve`. Faster from 4 to 7 points on, for parts of 16 to 100 states.
/// Modal blocks of 2 x 2 cost O(states m) per s.
class ShiftedSolver {
 public:
  /// A n x n, B n x m. Throws not_finite; singular if the eigenvalue iteration does not converge.
  ShiftedSolver(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

  /// X with one step of refinement. If that changes a column of a part by more than 2^-26 of it, or
  /// s is an eigenvalue to rounding, that part is found by `solve`: rcond is then at most that of
  /// its factors. Otherwise rcond is the least over the largest distance of s to an eigenvalue.
  Solution solve(std::complex<double> s) const;

 private:
  /// States that no others act on, nor they on others.
  struct UncoupledPart {
    std::vector<int> states;
    Eigen::MatrixXd A, B;
    Eigen::VectorXd scale;  ///< of the states
    Eigen::MatrixXcd T, Q;  ///< Schur form of diag(scale)^-1 A diag(scale)
    Eigen::MatrixXcd R;     ///< Q^H diag(scale)^-1 B
    double size = 0;        ///< largest entry of T
  };
  /// As the whole; the range of distances grows by those of this part, unless its own rcond counts.
  static Solution solve(const UncoupledPart& part, std::complex<double> s, double& nearest,
                        double& farthest);

  Eigen::Index n_, columns_;
  std::vector<UncoupledPart> parts_;
};

}  // namespace titop::linalg
