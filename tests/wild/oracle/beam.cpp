#include "wild/oracle/beam.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace wild {

namespace {

using Eigen::Index;
using Real = BeamModel::Real;
using Matrix = BeamModel::Matrix;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

Real G_of(const Beam& b) { return b.G > 0 ? Real(b.G) : Real(b.E) / (2 * (1 + Real(b.nu))); }
Real I_x_of(const Beam& b) { return b.I_x > 0 ? Real(b.I_x) : Real(b.I_y) + Real(b.I_z); }

/// Rows u, v, w, theta_x at xi (0 to 1) of an element of length h per its twelve degrees of
/// freedom; of `strains` the u', v'', w'', theta_x' instead.
Matrix shapes(Real xi, Real h, bool strains) {
  const Real x2 = xi * xi, x3 = x2 * xi;
  Matrix s = Matrix::Zero(4, 12);
  const Real line[2] = {strains ? -1 / h : 1 - xi, strains ? 1 / h : xi};
  Real cubic[4] = {1 - 3 * x2 + 2 * x3, h * (xi - 2 * x2 + x3), 3 * x2 - 2 * x3, h * (x3 - x2)};
  if (strains) {
    cubic[0] = (12 * xi - 6) / (h * h), cubic[1] = (6 * xi - 4) / h;
    cubic[2] = (6 - 12 * xi) / (h * h), cubic[3] = (6 * xi - 2) / h;
  }
  for (Index end = 0; end < 2; ++end) {
    s(0, 6 * end) = s(3, 6 * end + 3) = line[end];
    s(1, 6 * end + 1) = s(2, 6 * end + 2) = cubic[2 * end];
    s(1, 6 * end + 5) = cubic[2 * end + 1];   // theta_z = v'
    s(2, 6 * end + 4) = -cubic[2 * end + 1];  // theta_y = -w'
  }
  return s;
}

/// Four Gauss points: exact to degree 7, above the 6 of the mass.
Matrix element(const Beam& b, bool strains) {
  const Real h = Real(b.length) / b.elements, E(b.E), rho(b.rho), A(b.area);
  Vector weight(4);
  if (strains)
    weight << E * A, E * Real(b.I_z), E * Real(b.I_y), G_of(b) * Real(b.J);
  else
    weight << rho * A, rho * A, rho * A, rho * I_x_of(b);
  const Real root = std::sqrt(Real(30)), inner = 2 * std::sqrt(Real(6) / 5) / 7;
  Matrix sum = Matrix::Zero(12, 12);
  for (const int side : {-1, 1})
    for (const int far : {-1, 1}) {
      const Real place = side * std::sqrt(Real(3) / 7 + far * inner);
      const Matrix s = shapes((1 + place) / 2, h, strains);
      sum += (18 - far * root) / 72 * h * s.transpose() * weight.asDiagonal() * s;
    }
  return sum;
}

Matrix assembled(const Beam& b, const Matrix& of_one) {
  const Index n = 6 * (b.elements + 1);
  Matrix all = Matrix::Zero(n, n);
  for (Index e = 0; e < b.elements; ++e) all.block<12, 12>(6 * e, 6 * e) += of_one;
  return all;
}

/// Motion of all points per rigid motion of the parent.
Matrix rigid(const Beam& b) {
  Matrix R = Matrix::Zero(6 * (b.elements + 1), 6);
  for (int i = 0; i <= b.elements; ++i) {
    const Real x = Real(b.length) * (i - b.parent) / b.elements;
    R.middleRows<6>(6 * i).setIdentity();
    R(6 * i + 1, 5) = x;   // theta_z x r
    R(6 * i + 2, 4) = -x;  // theta_y x r
  }
  return R;
}

struct Mode {
  Real omega;
  Vector shape;
};

/// Of the beam clamped at its parent, ascending, mass-normalised; shapes have all rows.
std::vector<Mode> clamped_modes(const Beam& b, const Matrix& M, const Matrix& K) {
  std::vector<Mode> modes;
  for (const std::vector<int>& group : {std::vector{0}, {3}, {1, 5}, {2, 4}}) {
    std::vector<Index> rows;
    for (int i = 0; i <= b.elements; ++i)
      for (const int component : group)
        if (i != b.parent) rows.push_back(6 * i + component);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(Matrix(K(rows, rows)),
                                                                  Matrix(M(rows, rows)));
    for (Index k = 0; k < solver.eigenvalues().size(); ++k) {
      Mode mode{std::sqrt(solver.eigenvalues()(k)), Vector::Zero(M.rows())};
      mode.shape(rows) = solver.eigenvectors().col(k);
      modes.push_back(mode);
    }
  }
  std::stable_sort(modes.begin(), modes.end(),
                   [](const Mode& x, const Mode& y) { return x.omega < y.omega; });
  return modes;
}

/// Static shapes by unit wrenches at the residual points (at the parent: unit accelerations), with
/// the kept modes and each other taken out; the parent's rows are 0.
Matrix residual_shapes(const Beam& b, const Matrix& M, const Matrix& K, const Matrix& kept,
                       std::string& none) {
  std::vector<Index> f;
  for (Index i = 0; i < M.rows(); ++i)
    if (i / 6 != b.parent) f.push_back(i);
  const Eigen::LDLT<Matrix> ldlt(Matrix(K(f, f)));
  Matrix X = Matrix::Zero(M.rows(), 6 * static_cast<Index>(b.residual.size()));
  for (std::size_t r = 0; r < b.residual.size(); ++r) {
    Matrix load = M * rigid(b);
    if (b.residual[r] != b.parent)
      load = Matrix::Identity(M.rows(), M.rows()).middleCols(6 * b.residual[r], 6);
    X(f, Eigen::seqN(6 * static_cast<Index>(r), 6)) =
        Matrix(ldlt.solve(Matrix(load(f, Eigen::all))));
  }
  const auto size = [&](Index j) { return std::sqrt(X.col(j).dot(M * X.col(j))); };
  for (Index j = 0; j < X.cols(); ++j) X.col(j) /= size(j);
  Matrix Q = kept;
  for (Index round = 0; round < X.cols(); ++round) {
    for (int twice = 0; twice < 2; ++twice) X -= Q * (Q.transpose() * M * X);
    Index next = 0;
    for (Index j = 1; j < X.cols(); ++j)
      if (size(j) > size(next)) next = j;
    if (size(next) < 1e-6L && size(next) > 1e-8L) none = "a residual shape is nearly a mode";
    if (size(next) < 1e-7L) break;
    Q.conservativeResize(Eigen::NoChange, Q.cols() + 1);
    Q.rightCols(1) = X.col(next) / size(next);
    X.col(next).setZero();
  }
  return Q.rightCols(Q.cols() - kept.cols());
}

Real xi_of(const Beam& b, std::size_t mode) {
  return b.xi.empty() ? Real(0) : Real(b.xi[std::min(mode, b.xi.size() - 1)]);
}

/// Elastic shapes that are kept, and the damping between their amplitudes.
struct Elastic {
  Matrix shapes, D;
};

Elastic all_of(const Beam& b, const Matrix& M, const std::vector<Mode>& modes) {
  std::vector<Index> f;
  for (Index i = 0; i < M.rows(); ++i)
    if (i / 6 != b.parent) f.push_back(i);
  Elastic e{Matrix::Identity(M.rows(), M.rows())(Eigen::all, f), Matrix::Zero(M.rows(), M.rows())};
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const Vector momentum = M * modes[k].shape;
    e.D += 2 * xi_of(b, k) * modes[k].omega * momentum * momentum.transpose();
  }
  e.D = e.D(f, f).eval();
  return e;
}

Elastic lowest(const Beam& b, const Matrix& M, const Matrix& K, const std::vector<Mode>& modes,
               std::string& none) {
  const auto kept = static_cast<std::size_t>(b.kept);
  if (kept > 0 && kept < modes.size() && modes[kept].omega < 1.000001L * modes[kept - 1].omega)
    none = "one of two equal modes is kept";
  Elastic e{Matrix(M.rows(), b.kept), Matrix::Zero(b.kept, b.kept)};
  for (Index k = 0; k < b.kept; ++k) {
    const Mode& mode = modes[static_cast<std::size_t>(k)];
    e.shapes.col(k) = mode.shape;
    e.D(k, k) = 2 * xi_of(b, static_cast<std::size_t>(k)) * mode.omega;
  }
  if (b.residual.empty()) return e;
  const Matrix Q = residual_shapes(b, M, K, e.shapes, none);
  if (Q.cols() == 0) return e;
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(Matrix(Q.transpose() * K * Q));
  const Index total = b.kept + Q.cols();
  e.shapes.conservativeResize(Eigen::NoChange, total);
  e.D.conservativeResizeLike(Matrix::Zero(total, total));
  e.shapes.rightCols(Q.cols()) = Q * solver.eigenvectors();
  for (Index k = 0; k < Q.cols(); ++k)
    e.D(b.kept + k, b.kept + k) = 2 * xi_of(b, modes.size()) * std::sqrt(solver.eigenvalues()(k));
  return e;
}

}  // namespace

BeamModel beam_model(const Beam& b) {
  const Matrix M = assembled(b, element(b, false)), K = assembled(b, element(b, true));
  const std::vector<Mode> modes = clamped_modes(b, M, K);
  BeamModel model;
  const Elastic e = b.kept < 0 ? all_of(b, M, modes) : lowest(b, M, K, modes, model.none);
  const Index n = 6 + e.shapes.cols();
  Matrix T(M.rows(), n);
  T << rigid(b), e.shapes;
  model.M = T.transpose() * M * T;
  model.D = model.K = Matrix::Zero(n, n);
  model.K.bottomRightCorner(n - 6, n - 6) = e.shapes.transpose() * K * e.shapes;
  model.D.bottomRightCorner(n - 6, n - 6) = e.D;
  for (const int point : b.sites) model.sites.push_back(T.middleRows(6 * point, 6));
  model.fastest = static_cast<double>(modes.back().omega);
  return model;
}

}  // namespace wild
