#include <fmt/format.h>

#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/port_hamiltonian.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// True if the rows of C and C_rate are rounding beside the terms of the acceleration, C_accel qdd
/// with qdd = B u - D qd - K q. Of positions and rates they are as large as these.
bool is_acceleration(const SecondOrderModel& m, Index output) {
  const Eigen::RowVectorXd a = m.C_accel.row(output);
  const double momenta = m.G.size() > 0 ? (a * m.G).norm() : 0;
  return m.C.row(output).norm() <= linalg::kHalfDigits * (a * m.K).norm() &&
         m.C_rate.row(output).norm() <= linalg::kHalfDigits * ((a * m.D).norm() + momenta);
}

void require_accelerations(const SecondOrderModel& m) {
  std::vector<Mistake> mistakes;
  for (Index i = 0; i < m.C.rows(); ++i)
    if (!is_acceleration(m, i))
      mistakes.push_back({Code::bad_value,
                          fmt::format("{} reads a rate or a position: it has no form N pdot + P u",
                                      m.outputs[static_cast<std::size_t>(i)]),
                          {},
                          "read its acceleration (.accel), or leave it out of Scene::outputs"});
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

MatrixXd inverse_of(const MatrixXd& M) {
  const Eigen::LLT<MatrixXd> factors(M);
  if (factors.info() != Eigen::Success)
    throw Error(Code::bad_value, "M of the second-order model is not positive definite",
                "take the model of ReducedSystem::second_order()");
  return factors.solve(MatrixXd::Identity(M.rows(), M.cols()));
}

}  // namespace

PortHamiltonian port_hamiltonian(const SecondOrderModel& model) {
  require_accelerations(model);
  const Index n = model.M.rows();
  const MatrixXd mobility = inverse_of(model.M);
  PortHamiltonian s = detail::canonical((model.D + model.D.transpose()) / 2);
  if (model.G.size() > 0) s.J.bottomRightCorner(n, n) = (model.G.transpose() - model.G) / 2;
  s.Q = MatrixXd::Zero(2 * n, 2 * n);
  s.Q.topLeftCorner(n, n) = model.K;
  s.Q.bottomRightCorner(n, n) = mobility;
  s.G = MatrixXd::Zero(2 * n, model.B.cols());
  s.G.bottomRows(n) = model.B;
  s.N = model.C_accel * mobility;
  s.P = model.direct;
  return s;
}

}  // namespace titop
