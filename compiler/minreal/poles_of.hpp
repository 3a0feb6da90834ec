#pragma once

#include <Eigen/Core>
#include <functional>
#include <titop/compiler/minreal/poles.hpp>
#include <vector>

namespace titop::detail {

/// titop::poles with a rounding of A that costs about as much as the model: it is computed only if
/// the poles are not those of a symmetric problem.
std::vector<Pole> poles_of(const StateSpace& model,
                           const std::function<Eigen::MatrixXd()>& rounding,
                           const Eigen::MatrixXd& energy);

}  // namespace titop::detail
