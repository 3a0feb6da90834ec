#pragma once

#include <titop/analysis/lft/derivatives.hpp>

/// For the folder's own files.
namespace titop {

/// Parts of M(s) for some parameters, w and z in their order.
struct Derivatives::Paths {
  std::vector<Eigen::Index> first;  ///< of the pairs of each parameter
  Eigen::MatrixXcd yw, zu;
  Eigen::MatrixXcd zw, yu;  ///< if requested
  TransferCost cost;
};

}  // namespace titop
