#include <algorithm>
#include <cmath>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/converged.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::linalg {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double power_of_two_near(double x) {
  return x > 0 && std::isfinite(x) ? std::exp2(std::round(std::log2(x))) : 1;
}

/// Scales so that every row and column has its largest entry near 1.
struct Equilibration {
  VectorXd rows, cols;
  explicit Equilibration(MatrixXd a)
      : rows(VectorXd::Ones(a.rows())), cols(VectorXd::Ones(a.cols())) {
    for (int sweep = 0; sweep < 4; ++sweep) {
      for (Eigen::Index i = 0; i < a.rows(); ++i) {
        const double f = 1 / power_of_two_near(std::sqrt(a.row(i).maxCoeff()));
        a.row(i) *= f;
        rows(i) *= f;
      }
      for (Eigen::Index j = 0; j < a.cols(); ++j) {
        const double f = 1 / power_of_two_near(std::sqrt(a.col(j).maxCoeff()));
        a.col(j) *= f;
        cols(j) *= f;
      }
    }
  }
};

}  // namespace

Solution solve(const MatrixXcd& E, const MatrixXcd& F) {
  if (E.rows() == 0) return {MatrixXcd(0, F.cols()), 1, 0};
  const Equilibration scale(E.cwiseAbs());
  const MatrixXcd S = scale.rows.asDiagonal() * E * scale.cols.asDiagonal();
  const MatrixXcd R = scale.rows.asDiagonal() * F;
  const Eigen::PartialPivLU<MatrixXcd> lu(S);
  if ((lu.matrixLU().diagonal().array() == 0.0).any()) return {MatrixXcd(), 0, 0};
  MatrixXcd z = lu.solve(R);
  const MatrixXcd more = lu.solve(R - S * z);
  z += more;
  double moved = 0;
  for (Eigen::Index j = 0; j < z.cols(); ++j)
    if (const double size = z.col(j).norm(); size > 0)
      moved = std::max(moved, more.col(j).norm() / size);
  return {scale.cols.asDiagonal() * z, lu.rcond(), moved};
}

namespace {

using Long = std::complex<long double>;
using MatrixXcl = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

/// z += E^-1 (F - E z) by `lu` until nothing changes; the size of the last step relative to z, per
/// column.
template <class Lu>
double refine(const Lu& lu, const MatrixXcl& E, const MatrixXcl& F, MatrixXcl& z) {
  using Scalar = typename Lu::Scalar;
  constexpr int kSteps = 12;
  double before = HUGE_VAL;
  for (int step = 0; step < kSteps; ++step) {
    const MatrixXcl more =
        lu.solve((F - E * z).eval().template cast<Scalar>()).template cast<Long>();
    z += more;
    double now = 0;
    for (Eigen::Index j = 0; j < z.cols(); ++j)
      if (const auto size = z.col(j).cwiseAbs().maxCoeff(); size > 0)
        now = std::max(now, static_cast<double>(more.col(j).cwiseAbs().maxCoeff() / size));
    if (!(now <= kShrinks * before)) return std::min(now, before);
    before = now;
    if (now == 0) break;
  }
  return before;
}

}  // namespace

Solution refined_response(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                          const MatrixXd& D, std::complex<double> s) {
  if (A.rows() == 0) return {D.cast<std::complex<double>>(), 1, 0};
  MatrixXcl E = -A.cast<Long>();
  E.diagonal().array() += Long(s);
  const Equilibration scale(E.cwiseAbs().cast<double>());
  E = scale.rows.cast<Long>().asDiagonal() * E * scale.cols.cast<Long>().asDiagonal();
  const MatrixXcl F = (scale.rows.asDiagonal() * B).cast<Long>();
  const Eigen::PartialPivLU<MatrixXcd> lu(E.cast<std::complex<double>>());
  MatrixXcl z = MatrixXcl::Zero(F.rows(), F.cols());
  Solution result{.z = {}, .rcond = lu.rcond(), .moved = HUGE_VAL};
  if ((lu.matrixLU().diagonal().array() != 0.0).all()) result.moved = refine(lu, E, F, z);
  if (!(result.moved <= std::numeric_limits<double>::epsilon())) {
    const Eigen::PartialPivLU<MatrixXcl> finer(E);
    result.rcond = static_cast<double>(finer.rcond());
    if ((finer.matrixLU().diagonal().array() == Long(0)).any()) return {MatrixXcd(), 0, 0};
    z.setZero();
    result.moved = refine(finer, E, F, z);
  }
  const MatrixXcl y = (C * scale.cols.asDiagonal()).eval().cast<Long>() * z + D.cast<Long>();
  result.z = y.cast<std::complex<double>>();
  return result;
}

Inverse inverse(const MatrixXd& M) {
  if (M.rows() == 0) return {MatrixXd(0, 0), 1};
  const Eigen::PartialPivLU<MatrixXd> lu(M);
  if ((lu.matrixLU().diagonal().array() == 0.0).any()) return {MatrixXd(), 0};
  return {lu.inverse(), lu.rcond()};
}

Inverse equilibrated_inverse(const MatrixXd& M) {
  const Equilibration scale(M.cwiseAbs());
  Inverse result = inverse(scale.rows.asDiagonal() * M * scale.cols.asDiagonal());
  if (result.rcond > 0)
    result.matrix = (scale.cols.asDiagonal() * result.matrix * scale.rows.asDiagonal()).eval();
  return result;
}

namespace {

void check(const MatrixXd& A, Eigen::ComputationInfo info) {
  if (!A.allFinite())
    throw Error(Code::not_finite, "eigenvalues of a matrix with entries that are not finite",
                "look for overflow in the data");
  if (info != Eigen::Success)
    throw Error(Code::singular, "the eigenvalue iteration did not converge",
                "look for entries that differ by more than 1e15");
}

}  // namespace

Eigen::VectorXcd eigenvalues(const MatrixXd& A) {
  if (A.rows() == 0) return {};
  check(A, Eigen::Success);
  Eigen::VectorXcd result(A.rows());
  Eigen::Index first = 0;
  for (const std::vector<int>& part : parts(A)) {
    MatrixXd scaled = A(part, part);
    similarity_scaling(scaled);
    const auto solver = converged<Eigen::EigenSolver<MatrixXd>>(scaled, /*vectors=*/false).solver;
    check(A, solver.info());
    result.segment(first, scaled.rows()) = solver.eigenvalues();
    first += scaled.rows();
  }
  return result;
}

Eigensystem eigensystem(const MatrixXd& A, VectorXd (*scaling)(MatrixXd&)) {
  if (A.rows() == 0) return {{}, MatrixXcd(0, 0), MatrixXcd(0, 0), {}, 1};
  check(A, Eigen::Success);
  MatrixXd scaled = A;
  const VectorXd d = scaling(scaled);
  const auto [solver, order] = converged<Eigen::EigenSolver<MatrixXd>>(scaled, /*vectors=*/true);
  check(A, solver.info());
  Eigensystem result;
  result.values = solver.eigenvalues();
  MatrixXcd V(A.rows(), A.cols());
  V(order, Eigen::all) = solver.eigenvectors();
  const Eigen::PartialPivLU<MatrixXcd> lu(V);
  result.rcond_V = lu.rcond();
  result.scale = d;
  result.V = d.asDiagonal() * V;
  result.W = lu.inverse() * d.cwiseInverse().asDiagonal();
  for (Eigen::Index j = 0; j < result.V.cols(); ++j) {
    const double norm = result.V.col(j).norm();
    result.V.col(j) /= norm;
    result.W.row(j) *= norm;
  }
  return result;
}

}  // namespace titop::linalg
