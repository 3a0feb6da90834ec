#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <titop/titop.hpp>
#include <vector>

/// Errors of small models over a band, on points that are not their bounds'.
namespace titop_bench {

using TransferOf = std::function<Eigen::MatrixXcd(std::complex<double>)>;

/// The full system's transfers on the scene's ray: at equal steps of the band (without its start,
/// if that is 0 Hz), and at thirteen points across each pole, each a fifth of its peak's width from
/// the next. One grid serves all models.
class FineGrid {
 public:
  /// `poles` [rad/s]; `least`, outputs x inputs: lower limit of a pair's peak, by which its error
  /// is divided (ErrorBound::peak: pairs that symmetry makes 0).
  FineGrid(const titop::System& full, const titop::Scene& scene, int steps,
           const Eigen::VectorXd& poles, const Eigen::MatrixXd& least);

  /// Largest difference over the peak of its pair.
  double error(const TransferOf& transfer) const;

  std::size_t size() const { return s_.size(); }

 private:
  std::vector<std::complex<double>> s_;
  std::vector<Eigen::MatrixXcd> H_;
  Eigen::MatrixXd peak_;
};

}  // namespace titop_bench
