#include "by_hand.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace by_hand {

Structure empty(Index n, Index inputs, Index outputs) {
  return {MatrixXd::Zero(n, n), MatrixXd::Zero(n, n), MatrixXd::Zero(n, n),
          MatrixXd::Zero(n, inputs), MatrixXd::Zero(outputs, n)};
}

MatrixXcd position_transfer(const Structure& a, Complex s) {
  const MatrixXcd Z = s * s * a.M + s * a.D + a.K;
  const VectorXd scale = Z.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  const MatrixXcd S = scale.asDiagonal() * Z * scale.asDiagonal();
  const MatrixXcd load = (scale.asDiagonal() * a.B).cast<Complex>();
  return a.C * scale.asDiagonal() * S.partialPivLu().solve(load);
}

MatrixXcd accel_transfer(const Structure& a, Complex s) { return s * s * position_transfer(a, s); }

Structure elastic(const Structure& a, Index rigid) {
  const Index n = a.M.rows() - rigid;
  Structure e = empty(n, 0, 0);
  e.M = a.M.bottomRightCorner(n, n) -
        a.M.bottomLeftCorner(n, rigid) *
            a.M.topLeftCorner(rigid, rigid).ldlt().solve(a.M.topRightCorner(rigid, n));
  e.D = a.D.bottomRightCorner(n, n);
  e.K = a.K.bottomRightCorner(n, n);
  return e;
}

std::vector<Complex> poles(const Structure& a) {
  const Index n = a.M.rows();
  if (a.D.isZero(0)) {
    std::vector<Complex> list;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(a.K, a.M,
                                                                   Eigen::EigenvaluesOnly);
    for (const double w2 : modes.eigenvalues()) list.emplace_back(0, std::sqrt(std::max(w2, 0.0)));
    return list;
  }
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  const Eigen::LLT<MatrixXd> M(a.M);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -M.solve(a.K);
  A.bottomRightCorner(n, n) = -M.solve(a.D);
  return poles(A);
}

std::vector<Complex> poles(const MatrixXd& A) {
  // Scaled first (powers of two until rows and columns have equal norms): positions and
  // velocities differ by the frequency.
  MatrixXd scaled = A;
  for (int sweep = 0; sweep < 40; ++sweep)
    for (Index i = 0; i < A.rows(); ++i) {
      const double own = std::abs(scaled(i, i));
      const double row = scaled.row(i).cwiseAbs().sum() - own;
      const double column = scaled.col(i).cwiseAbs().sum() - own;
      if (row == 0 || column == 0) continue;
      const double f = std::exp2(std::round(0.5 * std::log2(row / column)));
      scaled.col(i) *= f;
      scaled.row(i) /= f;
    }
  std::vector<Complex> list;
  const Eigen::EigenSolver<MatrixXd> modes(scaled, /*computeEigenvectors=*/false);
  for (const Complex s : modes.eigenvalues())
    if (s.imag() >= 0) list.push_back(s);
  return list;
}

int least_order(const Structure& a) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(a.K, a.M);
  const VectorXd& w2 = modes.eigenvalues();
  MatrixXd b = modes.eigenvectors().transpose() * a.B, c = a.C * modes.eigenvectors();
  for (Index j = 0; j < b.cols(); ++j) b.col(j).normalize();
  for (Index i = 0; i < c.rows(); ++i) c.row(i).normalize();
  int order = 0;
  for (Index first = 0, last; first < w2.size(); first = last) {
    last = first + 1;
    while (last < w2.size() && w2(last) - w2(first) <= 1e-9 * w2(last) + 1e-13 * w2.maxCoeff())
      ++last;
    if (w2(first) <= 1e-12 * w2.maxCoeff()) continue;  // rigid: a constant acceleration, no state
    const MatrixXd residue = c.middleCols(first, last - first) * b.middleRows(first, last - first);
    Eigen::JacobiSVD<MatrixXd> svd(residue);
    for (const double sigma : svd.singularValues()) order += sigma > 1e-9 ? 2 : 0;
  }
  return order;
}

Matrix6 tau(const Eigen::Vector3d& CP) {
  Matrix6 t = Matrix6::Identity();
  t.topRightCorner<3, 3>() << 0, -CP.z(), CP.y(), CP.z(), 0, -CP.x(), -CP.y(), CP.x(), 0;
  return t;
}

Matrix6 dual(const Eigen::Matrix3d& T) {
  Matrix6 t = Matrix6::Zero();
  t.topLeftCorner<3, 3>() = t.bottomRightCorner<3, 3>() = T;
  return t;
}

FreeBeam free_beam(const Beam& b) {
  const double h = b.length / b.elements;
  Eigen::Matrix2d linear_K, linear_M;
  linear_K << 1, -1, -1, 1;
  linear_M << 2, 1, 1, 2;
  Eigen::Matrix4d K4, M4;  // of (v, slope) at both ends
  K4 << 12, 6 * h, -12, 6 * h, 6 * h, 4 * h * h, -6 * h, 2 * h * h, -12, -6 * h, 12, -6 * h, 6 * h,
      2 * h * h, -6 * h, 4 * h * h;
  M4 << 156, 22 * h, 54, -13 * h, 22 * h, 4 * h * h, 13 * h, -3 * h * h, 54, 13 * h, 156, -22 * h,
      -13 * h, -3 * h * h, -22 * h, 4 * h * h;
  const Eigen::Vector4d flip(1, -1, 1, -1);  // in the x-z plane the slope is -ry
  Eigen::Matrix<double, 12, 12> k = decltype(k)::Zero(), m = k;
  const auto add = [&](const auto& rows, const MatrixXd& stiffness, const MatrixXd& mass) {
    k(rows, rows) += stiffness;
    m(rows, rows) += mass;
  };
  add(std::vector<Index>{0, 6}, b.EA / h * linear_K, b.mass * h / 6 * linear_M);
  add(std::vector<Index>{3, 9}, b.GJ / h * linear_K, b.inertia_x * h / 6 * linear_M);
  const MatrixXd bend_K = b.EI / (h * h * h) * K4, bend_M = b.mass * h / 420 * M4;
  add(std::vector<Index>{1, 5, 7, 11}, bend_K, bend_M);
  add(std::vector<Index>{2, 4, 8, 10}, flip.asDiagonal() * bend_K * flip.asDiagonal(),
      flip.asDiagonal() * bend_M * flip.asDiagonal());
  const Index n = 6 * (b.elements + 1);
  FreeBeam whole{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n)};
  for (Index e = 0; e < b.elements; ++e) {
    whole.M.block<12, 12>(6 * e, 6 * e) += m;
    whole.K.block<12, 12>(6 * e, 6 * e) += k;
  }
  return whole;
}

Beam tube(double length, double outer, double inner, double E, double rho, int elements) {
  const double pi = std::acos(-1.0), area = pi / 4 * (outer * outer - inner * inner);
  const double I = pi / 64 * (std::pow(outer, 4) - std::pow(inner, 4));
  return {length, E * area, E * I, E / 2.5 * 2 * I, rho * area, rho * 2 * I, elements};
}

MatrixXd rigid_motion(const Beam& b) {
  MatrixXd R(6 * (b.elements + 1), 6);
  for (Index i = 0; i <= b.elements; ++i)
    R.middleRows<6>(6 * i) = tau({-b.length * static_cast<double>(i) / b.elements, 0, 0});
  return R;
}

// --- how far apart -------------------------------------------------------------------------------

double transfer_error(const std::vector<MatrixXcd>& a, const std::vector<MatrixXcd>& exact,
                      Index rows, Index cols) {
  const Index m = exact.front().rows() / rows, n = exact.front().cols() / cols;
  MatrixXd size = MatrixXd::Zero(m, n), error = size;
  for (std::size_t k = 0; k < exact.size(); ++k)
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < n; ++j) {
        const auto block = exact[k].block(i * rows, j * cols, rows, cols);
        const auto off = a[k].block(i * rows, j * cols, rows, cols) - block;
        if (!a[k].allFinite()) return 1;
        size(i, j) = std::max(size(i, j), block.cwiseAbs().maxCoeff());
        error(i, j) = std::max(error(i, j), off.cwiseAbs().maxCoeff());
      }
  double worst = 0;
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < n; ++j) {
      const double mean = std::sqrt(size.row(i).maxCoeff() * size.col(j).maxCoeff());
      const double scale = size(i, j) > 1e-13 * mean ? size(i, j) : mean;
      if (error(i, j) > 0) worst = std::max(worst, scale > 0 ? error(i, j) / scale : 1);
    }
  return worst;
}

std::vector<Complex> ray(double zeta, double hertz, int points) {
  std::vector<Complex> s;
  for (int k = 1; k <= points; ++k)
    s.push_back(Complex{zeta, std::sqrt(1 - zeta * zeta)} *
                (2 * 3.141592653589793 * hertz * k / points));
  return s;
}

double pole_error(std::vector<Complex> a, const std::vector<Complex>& exact) {
  if (a.size() != exact.size()) return 1;
  double worst = 0;
  for (const Complex s : exact) {
    const auto best = std::min_element(a.begin(), a.end(), [&](const Complex x, const Complex y) {
      return std::abs(x - s) < std::abs(y - s);
    });
    worst = std::max(worst, std::abs(*best - s) / std::abs(s));
    a.erase(best);
  }
  return worst;
}

bool agrees(const char* subject, double error, double limit) {
  const bool yes = error <= limit;
  std::printf("%s: to %.0e %s\n", subject, limit, yes ? "yes" : "NO");
  if (!yes) std::printf("  off by %.1e\n", error);
  if (std::getenv("SHOW_ERRORS")) std::fprintf(stderr, "%s: %.1e\n", subject, error);
  return yes;
}

}  // namespace by_hand
