#include <fmt/format.h>

#include <titop/graph/modal_form.hpp>
#include <titop/graph/pole.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;

std::shared_ptr<const Dynamics> modal_dynamics(Modal m) {
  const Index n = m.W.rows(), inputs = m.W.cols();
  auto d = std::make_shared<Dynamics>();
  d->A = MatrixXd::Zero(2 * n, 2 * n);
  d->A.topRightCorner(n, n).setIdentity();
  d->A.bottomLeftCorner(n, n) = (-m.stiffness).asDiagonal();
  d->A.bottomRightCorner(n, n) = (-m.damping).asDiagonal();
  d->B = MatrixXd::Zero(2 * n, inputs);
  d->B.bottomRows(n) = m.W;
  d->C.resize(inputs, 2 * n);
  d->C.leftCols(n) = m.W.transpose() * (-m.stiffness).asDiagonal();
  d->C.rightCols(n) = m.W.transpose() * (-m.damping).asDiagonal();
  d->D = m.rigid;
  if (n == 0) return d;
  for (Index i = 0; i < inputs; ++i)  // as symmetric as `rigid`, to the last bit
    for (Index j = 0; j <= i; ++j) {
      const double both = m.W.col(i).dot(m.W.col(j));
      d->D(i, j) += both;
      if (j < i) d->D(j, i) += both;
    }
  d->modes = d->modal = std::make_shared<const Modal>(std::move(m));
  return d;
}

Block::Response modal_response(const Modal& m, std::complex<double> s, std::string_view type) {
  const Index n = m.W.rows();
  Block::Response r{Eigen::MatrixXcd(2 * n, m.W.cols()), m.rigid};
  if (n == 0) return r;
  Eigen::VectorXcd stiff(n), inert(n);
  for (Index i = 0; i < n; ++i) {
    const std::complex<double> den = s * s + m.damping(i) * s + m.stiffness(i);
    if (den == 0.0) throw pole_at(s, fmt::format("mode {} of a {}", i + 1, type));
    stiff(i) = 1.0 / den;
    inert(i) = s * s / den;
  }
  r.X.topRows(n) = stiff.asDiagonal() * m.W;
  r.X.bottomRows(n) = s * r.X.topRows(n);
  r.Y += m.W.transpose() * (inert.asDiagonal() * m.W);
  return r;
}

}  // namespace titop
