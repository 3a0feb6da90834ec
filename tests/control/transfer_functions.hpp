#pragma once

#include <titop/graph/state_space.hpp>
#include <vector>

/// Transfer functions as state-space models.
namespace titop_test {

using Eigen::MatrixXd;

/// num / den, coefficients from the highest power; the degree of num at most that of den.
/// Controllable canonical form.
inline titop::StateSpace ratio(std::vector<double> num, std::vector<double> den) {
  const auto n = static_cast<Eigen::Index>(den.size()) - 1;
  num.insert(num.begin(), den.size() - num.size(), 0.0);
  for (double& x : num) x /= den[0];
  for (std::size_t i = den.size(); i-- > 0;) den[i] /= den[0];
  titop::StateSpace m;
  m.A = MatrixXd::Zero(n, n), m.B = MatrixXd::Zero(n, 1), m.C = MatrixXd::Zero(1, n);
  m.D = MatrixXd::Constant(1, 1, num[0]);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(n - i);  // of s^i
    if (i + 1 < n) m.A(i, i + 1) = 1;
    m.A(n - 1, i) = -den[k];
    m.C(0, i) = num[k] - num[0] * den[k];
  }
  if (n > 0) m.B(n - 1, 0) = 1;
  return m;
}

}  // namespace titop_test
