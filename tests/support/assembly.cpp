#include "loops/assembly.hpp"

namespace loops_test {

Assembly::Assembly(Index n, Index inputs, Index outputs) : a(by_hand::empty(n, inputs, outputs)) {}

void Assembly::add(const MatrixXd& M, const MatrixXd& K, const MatrixXd& Y) {
  a.M += Y.transpose() * M * Y;
  a.K += Y.transpose() * K * Y;
}

void Assembly::beam(const by_hand::Beam& b, const MatrixXd& start, const MatrixXd& end,
                    Index first) {
  const by_hand::FreeBeam fe = by_hand::free_beam(b);
  const Index inner = 6 * (b.elements - 1);
  MatrixXd Y = MatrixXd::Zero(fe.M.rows(), a.M.rows());
  Y.topRows(6) = start;
  Y.block(6, first, inner, inner).setIdentity();
  Y.bottomRows(6) = end;
  add(fe.M, fe.K, Y);
}

MatrixXd Assembly::unit(Index first, Index count) const {
  MatrixXd rows = MatrixXd::Zero(count, a.M.rows());
  rows.middleCols(first, count).setIdentity();
  return rows;
}

by_hand::Matrix6 mass_at_P(double mass, const Eigen::Matrix3d& inertia, const Eigen::Vector3d& PA) {
  by_hand::Matrix6 D = by_hand::Matrix6::Zero();
  D.topLeftCorner<3, 3>().diagonal().setConstant(mass);
  D.bottomRightCorner<3, 3>() = inertia;
  const by_hand::Matrix6 t = by_hand::tau(-PA);
  return t.transpose() * D * t;
}

Eigen::Matrix3d along_x(const Eigen::Vector3d& direction, const Eigen::Matrix3d& any) {
  Eigen::Matrix3d R;
  R.col(0) = direction.normalized();
  R.col(1) = R.col(0).cross(any.col(1)).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

Constraints::Constraints(const MatrixXd& rows)
    : held(rows), svd(rows, Eigen::ComputeFullU | Eigen::ComputeFullV) {
  const VectorXd& sigma = svd.singularValues();
  for (Index i = 0; i < sigma.size(); ++i) {
    const double relative = sigma(i) / sigma(0);
    rank += relative > 1e-9;
    clear = clear && (relative > 1e-4 || relative < 1e-13);
  }
}

namespace {

/// to S^-1 from' right on the first `rank` singular values.
template <class Matrix>
Matrix through(const MatrixXd& from, const MatrixXd& to, const Constraints& c,
               const Matrix& right) {
  const VectorXd inverse = c.svd.singularValues().head(c.rank).cwiseInverse();
  return to.leftCols(c.rank) * (inverse.asDiagonal() * (from.leftCols(c.rank).transpose() * right));
}

}  // namespace

MatrixXd Constraints::motion(const MatrixXd& right) const {
  return through(svd.matrixU(), svd.matrixV(), *this, right);
}
MatrixXcd Constraints::multipliers(const MatrixXcd& f) const {
  return through(svd.matrixV(), svd.matrixU(), *this, f);
}

by_hand::Structure constrained(const by_hand::Structure& a, const Constraints& constraints) {
  const MatrixXd N = constraints.motions();
  return {N.transpose() * a.M * N, N.transpose() * a.D * N, N.transpose() * a.K * N,
          N.transpose() * a.B, a.C * N};
}

ConstrainedMotion constrained_motion(const by_hand::Structure& a, const Constraints& constraints,
                                     Complex s, const MatrixXcd& force, const MatrixXcd& given) {
  using Wide = std::complex<long double>;
  using RealWide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using ComplexWide = Eigen::Matrix<Wide, Eigen::Dynamic, Eigen::Dynamic>;
  const MatrixXd motions = constraints.motions();
  RealWide real = motions.cast<long double>();
  const RealWide off = constraints.held.cast<long double>() * real;
  real -= constraints.motion(MatrixXd(off.cast<double>())).cast<long double>();
  const ComplexWide N = real.cast<Wide>(), F = force.cast<Wide>();
  const Wide z(s);
  const ComplexWide Z = z * z * a.M.cast<Wide>() + z * a.D.cast<Wide>() + a.K.cast<Wide>();
  ComplexWide q = given.cast<Wide>(), borne = F - Z * q;
  if (N.cols() > 0) {
    const MatrixXcd dynamic = s * s * a.M + s * a.D + a.K;
    const Eigen::PartialPivLU<MatrixXcd> lu(motions.transpose() * dynamic * motions);
    for (int step = 0; step < 4; ++step) {
      const ComplexWide work = N.transpose() * borne;
      const MatrixXcd y = lu.solve(MatrixXcd(work.cast<Complex>()));
      q += N * y.cast<Wide>();
      borne = F - Z * q;
    }
  }
  return {q.cast<Complex>(), borne.cast<Complex>()};
}

std::vector<Complex> elastic_poles(const by_hand::Structure& a, Index zeros) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(a.K, a.M, Eigen::EigenvaluesOnly);
  std::vector<Complex> list;
  for (Index i = zeros; i < a.M.rows(); ++i)
    list.emplace_back(0, std::sqrt(std::max(modes.eigenvalues()(i), 0.0)));
  return list;
}

std::vector<Complex> all_poles(const titop::System& system) {
  std::vector<Complex> list;
  for (const titop::Pole& p : system.poles()) list.push_back(p.s);
  return list;
}

}  // namespace loops_test
