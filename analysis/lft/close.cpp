#include <algorithm>
#include <cmath>
#include <titop/analysis/lft/close.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The largest sum of magnitudes of a column.
double norm1(const MatrixXd& m) { return m.cwiseAbs().colwise().sum().maxCoeff(); }

/// I - D_zw Delta and its inverse.
struct LoopMatrix {
  MatrixXd product;   ///< D_zw Delta, with w and z scaled
  MatrixXd inverse;   ///< of I - D_zw Delta, not scaled; empty if that is singular
  double margin = 0;  ///< see well_posed, without its sign
};

/// With w and z in sizes that give rows and columns of D_zw equal norms: the margin then depends on
/// no units.
LoopMatrix loop(const StateSpace& m, const VectorXd& deltas) {
  const Index r = deltas.size();
  LoopMatrix l{m.D.topLeftCorner(r, r), {}};
  const VectorXd d = linalg::similarity_scaling(l.product);
  l.product = l.product * deltas.asDiagonal();
  const MatrixXd E = MatrixXd::Identity(r, r) - l.product;
  const linalg::Inverse inverse = linalg::inverse(E);
  if (inverse.rcond == 0) return l;
  l.inverse = d.asDiagonal() * inverse.matrix * d.cwiseInverse().asDiagonal();
  l.margin = inverse.rcond * norm1(E) / (1 + norm1(l.product));
  return l;
}

/// I - t D_zw Delta is singular for a t in (0, 1): D_zw Delta has a real eigenvalue above 1; none
/// if its norm is below 1. Rounding splits equal ones into pairs of half the digits; a pair so near
/// the axis comes within 1e-6 of singular.
bool singular_between(const LoopMatrix& l) {
  if (norm1(l.product) < 1) return false;
  const Eigen::VectorXcd values = linalg::eigenvalues(l.product);
  return std::any_of(values.begin(), values.end(), [](const std::complex<double>& z) {
    return z.real() > 1 && std::abs(z.imag()) <= linalg::kDoubleRoot * std::abs(z);
  });
}

}  // namespace

double well_posed(const StateSpace& m, const VectorXd& deltas) {
  if (deltas.size() == 0) return 1;
  const LoopMatrix l = loop(m, deltas);
  return singular_between(l) ? -l.margin : l.margin;
}

std::optional<StateSpace> closed(const StateSpace& m, const VectorXd& deltas) {
  const Index r = deltas.size(), nu = m.D.cols() - r, ny = m.D.rows() - r;
  StateSpace c;
  c.states = m.states;
  c.inputs.assign(m.inputs.begin() + r, m.inputs.end());
  c.outputs.assign(m.outputs.begin() + r, m.outputs.end());
  MatrixXd K(r, r);  // w = K (z without w)
  if (r > 0) {
    const LoopMatrix l = loop(m, deltas);
    if (!(l.margin > kWellPosed)) return std::nullopt;
    K = deltas.asDiagonal() * l.inverse;
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
