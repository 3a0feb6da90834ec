#pragma once

#include <Eigen/Core>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Difference between the results of two methods. Every time is reported with it.
namespace titop_bench {

/// Largest difference of entries of A, B, C, D, each over the largest entry of its row of
/// [A B; C D].
double difference(const titop::StateSpace& a, const titop::StateSpace& b);

/// The same of two vectors: entries over the largest entry.
double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// Transfers over a list of points: per 3 x 3 block (or scalar) the largest difference over the
/// block's largest entry over all points; the largest of all blocks.
double difference(const std::vector<Eigen::MatrixXcd>& a, const std::vector<Eigen::MatrixXcd>& b);

}  // namespace titop_bench
