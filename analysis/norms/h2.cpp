#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/norms/gramian.hpp>
#include <titop/analysis/norms/h2.hpp>
#include <titop/analysis/norms/scaled.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/schur.hpp>

namespace titop {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

namespace {

[[noreturn]] void refuse_h2(const std::string& why, const char* way_out) {
  throw Error(Code::singular, "the H2 norm is infinite: " + why, way_out);
}

}  // namespace

namespace detail {

MatrixXd gramian(const MatrixXd& A, const MatrixXd& B) {
  const linalg::Schur s = linalg::schur(A);
  const MatrixXcd QU = s.Q * linalg::lyapunov_factor(s.T, s.Q.adjoint() * B);
  return (QU * QU.adjoint()).real();
}

void require_stable_h2(const StateSpace& scaled) {
  if (scaled.order() == 0) return;
  const Eigen::VectorXcd poles = linalg::eigenvalues(scaled.A);
  Eigen::Index worst = 0;
  poles.real().maxCoeff(&worst);
  if (!(poles(worst).real() < -rounding_of_poles(scaled)))
    refuse_h2(fmt::format("the pole {:.6g}{:+.6g}j is not left of the axis, beyond rounding",
                          poles(worst).real(), poles(worst).imag()),
              "damp it, or leave out the output that reads its position");
}

void refuse_direct_h2() {
  refuse_h2("there is a direct term", "read rates or positions, or filter the inputs or outputs");
}

}  // namespace detail

double norm_h2(const StateSpace& model) {
  require_fitting(model, "norm_h2");
  detail::require_finite(model, "H2 norm");
  const StateSpace m = detail::scaled(model);
  detail::require_stable_h2(m);
  if (!m.D.isZero(0)) detail::refuse_direct_h2();
  if (m.order() == 0) return 0;
  return std::sqrt((m.C * detail::gramian(m.A, m.B) * m.C.transpose()).trace());
}

}  // namespace titop
