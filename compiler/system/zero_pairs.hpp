#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/compiler/solve/transfer_blocks.hpp>
#include <vector>

/// Pairs of an output and an input that are rounding beside the others of their ports. For the
/// library's own files only.
namespace titop::detail {

struct SystemData;

/// Pairs that are 0: on every sample they are below the accuracy of the transfer, 1e-12 of their
/// block (a port by a port, dual vectors in halves: entries of one unit). An example is the torque
/// about a hinge without drive, in the reaction of the body on it.
class ZeroPairs {
 public:
  /// H: the system's transfer on the samples, outputs x inputs. O(samples * pairs).
  ZeroPairs(const SystemData& data, const std::vector<Eigen::MatrixXcd>& H);

  /// These sizes of pairs, with 0 for those that are 0.
  Eigen::MatrixXd cleared(const Eigen::MatrixXd& sizes) const;

  /// These sizes of pairs. A row (column) whose pairs all are 0 gets, in each column (row), at
  /// least the largest size among the other rows (columns) of its port and unit.
  Eigen::MatrixXd of_ports(Eigen::MatrixXd sizes) const;

 private:
  PortGroups outputs_, inputs_;
  Eigen::ArrayXX<bool> zero_;
};

}  // namespace titop::detail
