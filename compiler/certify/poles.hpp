#pragma once

#include <titop/compiler/certify_full.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Items of the full certificate (compiler/certify_full.hpp). For the compiler's own files.
namespace titop::full {

struct FoundPoles {
  FullCertificate::Poles poles;
  std::vector<double> omegas;  ///< |s| of what is not 0 and not rounding, ascending
  struct Right {
    std::complex<double> s;
    double rounding;  ///< may move it by so much
  };
  std::vector<Right> right;  ///< of the axis, both of a pair
};

/// Poles of the dense model against the factors, but for those that rounding may have made of 0 or
/// moved by more than 1e-8 of their size: `rounding` of each entry of A, and what eigenvalues in
/// double lose.
FoundPoles check_poles(const System& system, const StateSpace& model,
                       const Eigen::MatrixXd& rounding);

/// How many of these poles are none of the minimal model. O(n^3) where there are any.
int count_hidden(const std::vector<FoundPoles::Right>& right, const StateSpace& minimal);

}  // namespace titop::full
