#pragma once

#include <Eigen/Core>
#include <titop/compiler/certify_full.hpp>
#include <titop/graph/graph.hpp>
#include <vector>

namespace titop::full {

/// Of the diagram as written, with its transfers at these points (declared order).
FullCertificate::Passivity check_passivity(const Graph& graph, const std::vector<double>& values,
                                           const std::vector<std::complex<double>>& points,
                                           const std::vector<Eigen::MatrixXcd>& transfers);

}  // namespace titop::full
