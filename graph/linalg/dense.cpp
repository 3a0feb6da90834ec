#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::linalg {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double power_of_two_near(double x) {
  return x > 0 && std::isfinite(x) ? std::exp2(std::round(std::log2(x))) : 1;
}

/// Scales so that every row and column has its largest entry near 1.
struct Scaling {
  VectorXd rows, cols;
  explicit Scaling(MatrixXd a) : rows(VectorXd::Ones(a.rows())), cols(VectorXd::Ones(a.cols())) {
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
  if (E.rows() == 0) return {MatrixXcd(0, F.cols()), 1};
  const Scaling scale(E.cwiseAbs());
  const MatrixXcd S = scale.rows.asDiagonal() * E * scale.cols.asDiagonal();
  const MatrixXcd R = scale.rows.asDiagonal() * F;
  const Eigen::PartialPivLU<MatrixXcd> lu(S);
  if ((lu.matrixLU().diagonal().array() == 0.0).any()) return {MatrixXcd(), 0};
  MatrixXcd z = lu.solve(R);
  z += lu.solve(R - S * z);
  return {scale.cols.asDiagonal() * z, lu.rcond()};
}

Inverse inverse(const MatrixXd& M) {
  if (M.rows() == 0) return {MatrixXd(0, 0), 1};
  const Eigen::PartialPivLU<MatrixXd> lu(M);
  if ((lu.matrixLU().diagonal().array() == 0.0).any()) return {MatrixXd(), 0};
  return {lu.inverse(), lu.rcond()};
}

namespace {

/// Diagonal similarity by powers of two that makes rows and columns alike [Parlett, Reinsch 1969].
VectorXd balance(MatrixXd& A) {
  const auto n = A.rows();
  VectorXd d = VectorXd::Ones(n);
  for (int sweep = 0; sweep < 20; ++sweep) {
    bool changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double c = A.col(i).cwiseAbs().sum() - std::abs(A(i, i));
      const double r = A.row(i).cwiseAbs().sum() - std::abs(A(i, i));
      if (c == 0 || r == 0) continue;
      const double f = power_of_two_near(std::sqrt(r / c));
      if (c * f + r / f >= 0.95 * (c + r)) continue;
      A.col(i) *= f;
      A.row(i) /= f;
      d(i) *= f;
      changed = true;
    }
    if (!changed) break;
  }
  return d;
}

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
  MatrixXd balanced = A;
  balance(balanced);
  const Eigen::EigenSolver<MatrixXd> solver(balanced, /*computeEigenvectors=*/false);
  check(A, solver.info());
  return solver.eigenvalues();
}

Eigensystem eigensystem(const MatrixXd& A) {
  if (A.rows() == 0) return {{}, MatrixXcd(0, 0), MatrixXcd(0, 0), {}, 1};
  check(A, Eigen::Success);
  MatrixXd balanced = A;
  const VectorXd d = balance(balanced);
  const Eigen::EigenSolver<MatrixXd> solver(balanced);
  check(A, solver.info());
  Eigensystem result;
  result.values = solver.eigenvalues();
  const MatrixXcd V = solver.eigenvectors();
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

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr int kSmall = 12;
/// Small loops are many: no memory is asked for.
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSmall, kSmall>;

/// From M^k, k = 1, 2, 4 ... 1024: the row sums v of M^k give max (M v)_i / v_i, never below the
/// radius [Collatz 1942]; where that stays loose, |M^1024|^(1/1024), the norm's own factor n having
/// become n^(1/1024).
double perron_by_squaring(const Small& M) {
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSmall, 1>;
  Small power = M;
  double log_scale = 0, weight = 1;
  for (int step = 0; step <= 10; ++step, weight /= 2) {
    const Column v = power.rowwise().sum();
    const double size = v.maxCoeff();
    if (!(size > 0)) return 0;
    if (v.minCoeff() > 0) {
      const Column grown = M.lazyProduct(v).cwiseQuotient(v);
      if (grown.maxCoeff() - grown.minCoeff() <= 1e-3 * grown.maxCoeff()) return grown.maxCoeff();
    }
    log_scale += weight * std::log(size);
    if (step == 10) break;
    power /= size;
    power = power.lazyProduct(power).eval();
  }
  return std::exp(log_scale);
}

/// Spectral radius of M: the largest of its irreducible diagonal blocks. Loops that a zero
/// coefficient cuts open have rows that reach each other one way only; on them no power converges.
double perron_of_parts(const Small& M) {
  const int n = static_cast<int>(M.rows());
  std::array<unsigned, kSmall> reach{};
  const auto has = [&](int i, int j) { return (reach[at(i)] >> j & 1u) != 0; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i == j || M(i, j) != 0) reach[at(i)] |= 1u << j;
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i)
      if (has(i, k)) reach[at(i)] |= reach[at(k)];
  double radius = 0;
  unsigned done = 0;
  for (int i = 0; i < n; ++i) {
    if (done >> i & 1u) continue;
    std::array<int, kSmall> members{};
    int size = 0;
    for (int j = i; j < n; ++j)
      if (has(i, j) && has(j, i)) members[at(size++)] = j, done |= 1u << j;
    Small part(size, size);
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c) part(r, c) = M(members[at(r)], members[at(c)]);
    radius = std::max(radius, size == 1 ? part(0, 0) : perron_by_squaring(part));
  }
  return radius;
}

/// |M^-1| |M|; 0 x 0 if a pivot is 0.
template <class M>
M skeel_product(const M& m) {
  const Eigen::PartialPivLU<M> lu(m);
  if ((lu.matrixLU().diagonal().array() == 0.0).any()) return M(0, 0);
  return M(lu.inverse()).cwiseAbs() * m.cwiseAbs();
}

double perron_by_iteration(const MatrixXd& M) {
  const auto n = M.rows();
  VectorXd v = VectorXd::Ones(n), w(n);
  const double shift = 1e-3 * M.maxCoeff();
  double high = 0;
  for (int step = 0; step < 200; ++step) {
    // The shift keeps the iteration from oscillating on cyclic matrices.
    w.noalias() = M * v;
    w += shift * v;
    high = w.cwiseQuotient(v).maxCoeff();
    const double low = w.cwiseQuotient(v).minCoeff();
    v = (w / w.maxCoeff()).cwiseMax(1e-300);
    if (high - low <= 1e-3 * high) break;
  }
  return high - shift;
}

}  // namespace

double perron(const MatrixXd& M) {
  if (M.rows() == 0) return 0;
  return M.rows() <= kSmall ? perron_of_parts(M) : perron_by_iteration(M);
}

namespace {

/// [a, b; c, d]: (1 + sqrt|t|)^2 / |1 - t|, t = bc/ad or its inverse, whichever is below 1.
double skeel_radius_of_two(const MatrixXd& M) {
  const bool diagonal = M(0, 0) != 0 && M(1, 1) != 0;
  double t = diagonal ? (M(0, 1) / M(0, 0)) * (M(1, 0) / M(1, 1)) : 2;
  if (!(std::abs(t) <= 1)) {
    if (M(0, 1) == 0 || M(1, 0) == 0) return 0;
    t = (M(0, 0) / M(0, 1)) * (M(1, 1) / M(1, 0));
  }
  const double sum = 1 + std::sqrt(std::abs(t));
  return t == 1 ? 0 : sum * sum / std::abs(1 - t);
}

}  // namespace

double skeel_radius(const MatrixXd& M) {
  if (M.rows() == 2) return skeel_radius_of_two(M);
  if (M.rows() > kSmall) return perron(skeel_product(M));
  const Small product = skeel_product<Small>(M);
  return product.size() == 0 ? 0 : perron_of_parts(product);
}

}  // namespace titop::linalg
