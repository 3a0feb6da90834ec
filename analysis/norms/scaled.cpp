#include <fmt/format.h>

#include <titop/analysis/norms/scaled.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>

namespace titop::detail {

void require_finite(const StateSpace& m, const char* user) {
  for (const Eigen::MatrixXd* matrix : {&m.A, &m.B, &m.C, &m.D})
    if (!matrix->allFinite())
      throw Error(Code::not_finite,
                  fmt::format("an entry of the model is not finite: it has no {}", user),
                  "check the source of its matrices");
}

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
