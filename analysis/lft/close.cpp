#include <titop/analysis/lft/close.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

linalg::Inverse loop(const StateSpace& m, const VectorXd& deltas) {
  const Index r = deltas.size();
  return linalg::inverse(MatrixXd::Identity(r, r) - m.D.topLeftCorner(r, r) * deltas.asDiagonal());
}

}  // namespace

double well_posed(const StateSpace& m, const VectorXd& deltas) {
  return deltas.size() == 0 ? 1 : loop(m, deltas).rcond;
}

std::optional<StateSpace> closed(const StateSpace& m, const VectorXd& deltas) {
  const Index r = deltas.size(), nu = m.D.cols() - r, ny = m.D.rows() - r;
  StateSpace c;
  c.states = m.states;
  c.inputs.assign(m.inputs.begin() + r, m.inputs.end());
  c.outputs.assign(m.outputs.begin() + r, m.outputs.end());
  MatrixXd K(r, r);  // w = K (z without w)
  if (r > 0) {
    const linalg::Inverse inverse = loop(m, deltas);
    if (!(inverse.rcond > kWellPosed)) return std::nullopt;
    K = deltas.asDiagonal() * inverse.matrix;
  }
  const MatrixXd to_x = m.B.leftCols(r) * K, to_y = m.D.bottomLeftCorner(ny, r) * K;
  const MatrixXd of_x = m.C.topRows(r), of_u = m.D.topRightCorner(r, nu);
  c.A = m.A + to_x * of_x;
  c.B = m.B.rightCols(nu) + to_x * of_u;
  c.C = m.C.bottomRows(ny) + to_y * of_x;
  c.D = m.D.bottomRightCorner(ny, nu) + to_y * of_u;
  return c;
}

}  // namespace titop::detail
