#pragma once

#include <vector>

#include "wild/oracle/oracle.hpp"

namespace wild {

/// C (s - A)^-1 B + D per s, and the effect of changing each entry of A, B, C, D by `relative` of
/// itself: |C (s - A)^-1| (|A| |x| + |B|) + |C| |x| + |D| times `relative`, x = (s - A)^-1 B. No
/// model written in doubles is better than that of 1e-16.
struct ModelTransfer {
  std::vector<Eigen::MatrixXcd> H;
  std::vector<Eigen::MatrixXd> rounding;
};
ModelTransfer model_transfer(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                             const MatrixXd& D, const std::vector<Complex>& s, double relative,
                             Digits digits);

}  // namespace wild
