#include <algorithm>
#include <titop/analysis/control/zeros.hpp>
#include <titop/analysis/norms/scaled.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

struct SystemMatrix {
  MatrixXd A, B, C, D;

  SystemMatrix dual() const { return {A.transpose(), C.transpose(), B.transpose(), D.transpose()}; }
};

MatrixXd stacked(const MatrixXd& upper, const MatrixXd& lower) {
  MatrixXd both(upper.rows() + lower.rows(), upper.cols());
  both << upper, lower;
  return both;
}

Index rank_of(const Eigen::JacobiSVD<MatrixXd>& svd, double zero) {
  return (svd.singularValues().array() > zero).count();
}

/// The same zeros with a direct term of full row rank. Outputs C2 x without direct term are 0 along
/// a zero: the states that they see are 0 there, and their derivatives are outputs in their place.
SystemMatrix with_full_rows(SystemMatrix m, double zero) {
  while (m.C.rows() > 0) {
    Index direct = 0;
    if (m.D.size() > 0) {
      const Eigen::JacobiSVD<MatrixXd> svd(m.D, Eigen::ComputeFullU);
      direct = rank_of(svd, zero);
      m.C = (svd.matrixU().transpose() * m.C).eval();
      m.D = (svd.matrixU().transpose() * m.D).eval();
    }
    const Index n = m.A.rows(), others = m.C.rows() - direct;
    const MatrixXd C1 = m.C.topRows(direct), C2 = m.C.bottomRows(others), D1 = m.D.topRows(direct);
    if (others == 0) return m;
    Index seen = 0;
    MatrixXd V = MatrixXd::Identity(n, n);
    if (n > 0) {
      const Eigen::JacobiSVD<MatrixXd> svd(C2, Eigen::ComputeFullV);
      seen = rank_of(svd, zero);
      V << svd.matrixV().rightCols(n - seen), svd.matrixV().leftCols(seen);
    }
    if (seen == 0) return {m.A, m.B, C1, D1};
    const MatrixXd A = V.transpose() * m.A * V, B = V.transpose() * m.B, C = C1 * V;
    const Index rest = n - seen;
    m = {A.topLeftCorner(rest, rest), B.topRows(rest),
         stacked(A.bottomLeftCorner(seen, rest), C.leftCols(rest)),
         stacked(B.bottomRows(seen), D1)};
  }
  return m;
}

/// In units of inputs and outputs in which B and C are as large as A.
double common_scale(SystemMatrix& m) {
  const double a = m.A.norm(), b = m.B.norm(), c = m.C.norm();
  const double size = a > 0 ? a : 1;
  const double to_b = b > 0 ? size / b : 1, to_c = c > 0 ? size / c : 1;
  m.B *= to_b, m.C *= to_c, m.D *= to_b * to_c;
  return std::max(size, m.D.norm());
}

}  // namespace

Eigen::VectorXcd transmission_zeros(const StateSpace& model) {
  require_fitting(model, "transmission_zeros");
  detail::require_finite(model, "zeros");
  const StateSpace s = detail::scaled(model);
  SystemMatrix m{s.A, s.B, s.C, s.D};
  const double size = common_scale(m);
  const double zero =
      static_cast<double>(m.A.rows() + m.B.cols() + m.C.rows()) * linalg::kEpsilon * size;
  m = with_full_rows(with_full_rows(std::move(m), zero).dual(), zero).dual();
  if (m.A.rows() == 0) return {};
  if (m.D.size() == 0) return linalg::eigenvalues(m.A);
  const MatrixXd inverse = linalg::inverse(m.D).matrix;
  return linalg::eigenvalues(m.A - m.B * inverse * m.C);
}

}  // namespace titop
