#include <titop/analysis/norms/scaled.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>

namespace titop::detail {

StateSpace scaled(StateSpace m) {
  const Eigen::VectorXd d = linalg::similarity_scaling(m.A);
  m.B = d.cwiseInverse().asDiagonal() * m.B;
  m.C = m.C * d.asDiagonal();
  return m;
}

double rounding_of_poles(const StateSpace& m) {
  return static_cast<double>(m.order()) * linalg::kEpsilon * m.A.norm();
}

}  // namespace titop::detail
