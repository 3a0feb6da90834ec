#include <complex>
#include <titop/analysis/simulation/discrete_model.hpp>

namespace titop {

Eigen::MatrixXcd DiscreteModel::at(double omega) const {
  return model.transfer(std::polar(1.0, omega * period));
}

}  // namespace titop
