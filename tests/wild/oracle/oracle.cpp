#include "wild/oracle/oracle.hpp"

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "support/rng.hpp"
#include "wild/oracle/digits.hpp"
#include "wild/oracle/equations.hpp"

namespace wild {

namespace {

using Real = Equations::Real;
static_assert(std::is_same_v<WideComplex, std::complex<Real>>);

double size_of_entry(const WideComplex& z) {
  return static_cast<double>(std::abs(z.real()) + std::abs(z.imag()));
}
double size_of_entry(const FiftyComplex& z) {
  return static_cast<double>(abs(z.real())) + static_cast<double>(abs(z.imag()));
}

/// Powers of two that bring rows and columns to about 1.
template <class Matrix>
void equilibrate(Matrix& P, VectorXd& rows, VectorXd& cols) {
  using Scalar = typename Matrix::Scalar;
  MatrixXd size = P.unaryExpr([](const Scalar& z) { return size_of_entry(z); });
  rows.setOnes(P.rows());
  cols.setOnes(P.cols());
  const auto scale = [](double largest) {
    return largest > 0 ? std::exp2(-std::round(std::log2(largest))) : 1;
  };
  for (int round = 0; round < 4; ++round) {
    for (Index i = 0; i < P.rows(); ++i) {
      const double f = scale(size.row(i).maxCoeff());
      rows(i) *= f;
      size.row(i) *= f;
    }
    for (Index j = 0; j < P.cols(); ++j) {
      const double f = scale(size.col(j).maxCoeff());
      cols(j) *= f;
      size.col(j) *= f;
    }
  }
  for (Index j = 0; j < P.cols(); ++j)
    for (Index i = 0; i < P.rows(); ++i) P(i, j) *= Scalar(rows(i) * cols(j));
}

Complex to_double(const WideComplex& z) { return Complex(z); }
Complex to_double(const FiftyComplex& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}

template <class C>
Eigen::Matrix<C, Eigen::Dynamic, Eigen::Dynamic> at_s(const std::array<Equations::Matrix, 3>& p,
                                                      const C& s) {
  using M = Eigen::Matrix<C, Eigen::Dynamic, Eigen::Dynamic>;
  M sum(p[0].rows(), p[0].cols());
  for (Index j = 0; j < sum.cols(); ++j)
    for (Index i = 0; i < sum.rows(); ++i)
      sum(i, j) = C(p[0](i, j)) + s * (C(p[1](i, j)) + s * C(p[2](i, j)));
  return sum;
}

/// Both with pivots of a column's largest size; most of the entries are 0. Throws
/// std::domain_error if a sparse pivot is exactly 0: s is a pole.
template <class Matrix>
auto factored(const Matrix& P) {
  if constexpr (std::is_same_v<typename Matrix::Scalar, WideComplex>) {
    const Eigen::SparseMatrix<WideComplex> sparse = P.sparseView(WideComplex(0), 0);
    auto lu = std::make_unique<Eigen::SparseLU<Eigen::SparseMatrix<WideComplex>>>(sparse);
    if (lu->info() != Eigen::Success) throw std::domain_error("the equations are singular");
    return lu;
  } else {
    return std::make_unique<Eigen::PartialPivLU<Matrix>>(P);
  }
}

template <class C>
Eigen::MatrixXcd solve(const Equations& e, const C& s) {
  using M = Eigen::Matrix<C, Eigen::Dynamic, Eigen::Dynamic>;
  M P = at_s<C>(e.P, s), Q = at_s<C>(e.Q, s);
  VectorXd rows, cols;
  equilibrate(P, rows, cols);
  const auto scaled = [&](const auto& matrix, const VectorXd& by, bool from_left) {
    M m(matrix.rows(), matrix.cols());
    for (Index j = 0; j < m.cols(); ++j)
      for (Index i = 0; i < m.rows(); ++i) m(i, j) = C(matrix(i, j)) * C(by(from_left ? i : j));
    return m;
  };
  const M R = scaled(e.R, rows, true);
  const auto lu = factored(P);
  M z = lu->solve(R);
  z += M(lu->solve(M(R - P * z)));
  const M H = scaled(Q, cols, false) * z;
  Eigen::MatrixXcd result(H.rows(), H.cols());
  for (Index j = 0; j < H.cols(); ++j)
    for (Index i = 0; i < H.rows(); ++i) result(i, j) = to_double(C(H(i, j) + C(e.E(i, j))));
  return result;
}

template <class C>
Truth truth_in(const Scene& scene, const std::vector<Complex>& s) {
  const Equations e(scene);
  Truth t;
  t.none = e.none;
  t.redundant = e.redundant;
  if (t.none.empty())
    for (const Complex& point : s) t.H.push_back(solve<C>(e, C(point.real(), point.imag())));
  return t;
}

}  // namespace

Truth truth(const Scene& scene, const std::vector<Complex>& s, Digits digits) {
  return digits == Digits::wide ? truth_in<WideComplex>(scene, s)
                                : truth_in<FiftyComplex>(scene, s);
}

Scene disturbed(const Scene& scene, double relative, unsigned seed) {
  titop_test::Rng rng(seed);
  Scene d = scene;
  const auto number = [&](double& x) { x *= 1 + relative * rng.between(-1, 1); };
  const auto all = [&](auto& matrix) {
    for (Index i = 0; i < matrix.size(); ++i) number(matrix.data()[i]);
  };
  const auto sum = [&](Sum& shares) {
    for (Share& share : shares) all(share.gain);
  };
  for (Node& n : d.nodes) {
    for (double* x : {&n.m, &n.k, &n.c, &n.m0, &n.mass}) number(*x);
    all(n.inertia);
    n.inertia = (0.5 * (n.inertia + n.inertia.transpose())).eval();
    all(n.PA);
    all(n.omega);
    all(n.xi);
    all(n.L_P);
    for (Index j = 0; j < 6; ++j)
      for (Index i = 0; i <= j; ++i) number(n.D_P(i, j)), n.D_P(j, i) = n.D_P(i, j);
    for (Site& site : n.sites) {
      all(site.PC);
      all(site.Phi);
    }
    if (n.beam) {
      Beam& b = *n.beam;
      for (double* x :
           {&b.length, &b.area, &b.I_y, &b.I_z, &b.J, &b.I_x, &b.E, &b.rho, &b.nu, &b.G})
        number(*x);
      for (double& x : b.xi) number(x);
    }
    for (Matrix6d* m : {&n.stiffness, &n.damping}) all(*m);
    for (MatrixXd* m : {&n.A, &n.B, &n.C, &n.D}) all(*m);
    sum(n.in);
  }
  for (Tie& t : d.ties)  // a rotation's entries have the digits of its largest
    for (Index i = 0; i < t.T.size(); ++i) t.T.data()[i] += relative * rng.between(-1, 1);
  for (Mechanism& m : d.mechanisms) {
    number(m.k);
    number(m.c);
    sum(m.more);
  }
  for (Load& load : d.loads) sum(load.sum);
  return d;
}

namespace {

VectorXd talbot(const Equations& e, Index column, double t, int order) {
  using std::numbers::pi_v;
  const long double pi = pi_v<long double>, M = order;
  VectorXd y = VectorXd::Zero(e.E.rows());
  for (int k = 0; k < order; ++k) {
    WideComplex delta(2 * M / 5, 0), gamma = std::exp(delta) / WideComplex(2, 0);
    if (k > 0) {
      const long double angle = static_cast<long double>(k) * pi / M, cot = 1 / std::tan(angle);
      delta = WideComplex(cot, 1) * (2 * static_cast<long double>(k) * pi / 5);
      gamma = WideComplex(1, angle * (1 + cot * cot) - cot) * std::exp(delta);
    }
    const WideComplex s = delta / WideComplex(t, 0);
    const Eigen::MatrixXcd H = solve<WideComplex>(e, s);
    const Complex weight(gamma / s * WideComplex(0.4L / t, 0));
    y += (weight * H.col(column)).real();
  }
  return y;
}

}  // namespace

VectorXd step_response(const Scene& scene, int column, double t) {
  const Equations e(scene);
  VectorXd coarse, fine = VectorXd::Constant(e.E.rows(), std::nan(""));
  try {
    coarse = talbot(e, column, t, 24);
    fine = talbot(e, column, t, 32);
  } catch (const std::domain_error&) {
    return fine;
  }
  for (Index i = 0; i < fine.size(); ++i)
    if (!(std::abs(fine(i) - coarse(i)) <= 1e-10 * std::abs(fine(i)))) fine(i) = std::nan("");
  return fine;
}

}  // namespace wild
