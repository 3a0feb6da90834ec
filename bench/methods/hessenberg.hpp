#pragma once

#include <complex>
#include <titop/graph/state_space.hpp>

namespace titop_bench {

/// The frequency response of control packages: A = Q H Q' with H upper Hessenberg once, O(n^3),
/// then O(n^2) per s.
class Hessenberg {
 public:
  explicit Hessenberg(const titop::StateSpace& model);
  Eigen::MatrixXcd transfer(std::complex<double> s) const;

 private:
  Eigen::MatrixXd H_, B_, C_, D_;
};

}  // namespace titop_bench
