#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/simulation/hold.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

template <class T>
using DenseMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

constexpr Index kMostInLongDouble = 128;  // states: some tenths of a second

double power_of_two_near(double x) { return std::exp2(std::round(std::log2(x))); }

/// Diagonal d, powers of two, such that the first n rows and columns of d^-1 X d have equal norms;
/// the others (inputs) are scaled down to the size of the rows that they drive.
Eigen::VectorXd similarity_scaling(MatrixXd X, Index n) {
  Eigen::VectorXd d = Eigen::VectorXd::Ones(X.rows());
  const auto scale = [&](Index i, double f) {
    X.col(i) *= f;
    X.row(i) /= f;
    d(i) *= f;
  };
  for (int sweep = 0; sweep < 20; ++sweep)
    for (Index i = 0; i < n; ++i) {
      const double c = X.col(i).head(n).cwiseAbs().sum() - std::abs(X(i, i));
      const double r = X.row(i).head(n).cwiseAbs().sum() - std::abs(X(i, i));
      if (c > 0 && r > 0) scale(i, power_of_two_near(std::sqrt(r / c)));
    }
  const double size = n > 0 ? X.topLeftCorner(n, n).cwiseAbs().colwise().sum().maxCoeff() : 0;
  for (Index j = n; j < X.cols(); ++j)
    if (const double c = X.col(j).cwiseAbs().sum(); c > 0 && size > 0)
      scale(j, power_of_two_near(size / c));
  return d;
}

/// exp(X) - I: Taylor at X / 2^k, then (I + E)^2 - I = 2 E + E^2, k times. Without the I a slow
/// state keeps its digits if others are fast.
template <class T>
DenseMatrix<T> exponential_less_one(DenseMatrix<T> X) {
  const auto norm = static_cast<double>(X.cwiseAbs().colwise().sum().maxCoeff());
  const int k = norm > 0.25 ? static_cast<int>(std::ceil(std::log2(norm / 0.25))) : 0;
  X /= static_cast<T>(std::exp2(k));
  DenseMatrix<T> E = X, term = X;
  for (int i = 2; i <= 18; ++i) {
    term = (term * X / T(i)).eval();
    E += term;
  }
  for (int i = 0; i < k; ++i) E = (T(2) * E + E * E).eval();
  return E;
}

/// [exp(A h) - I, integral B] as one n x (n + nu) matrix: the exponential of [[A, B], [0, 0]] h.
template <class T>
DenseMatrix<T> increments(const MatrixXd& A, const MatrixXd& B, double h) {
  const Index n = A.rows(), m = B.cols();
  if (n == 0) return DenseMatrix<T>::Zero(0, m);
  MatrixXd X = MatrixXd::Zero(n + m, n + m);
  X << A, B, MatrixXd::Zero(m, n + m);
  const Eigen::VectorXd d = similarity_scaling(X, n);
  const MatrixXd scaled = d.cwiseInverse().asDiagonal() * X * d.asDiagonal();  // exact
  const DenseMatrix<T> E = exponential_less_one<T>(scaled.cast<T>() * T(h));
  return d.cast<T>().head(n).asDiagonal() * E.topRows(n) * d.cwiseInverse().cast<T>().asDiagonal();
}

template <class T>
MatrixXd run(const StateSpace& m, double h, const MatrixXd& inputs) {
  const Index n = m.A.rows();
  const DenseMatrix<T> step = increments<T>(m.A, m.B, h), u = inputs.cast<T>();
  const DenseMatrix<T> C = m.C.cast<T>(), D = m.D.cast<T>();
  DenseMatrix<T> x = DenseMatrix<T>::Zero(n, 1), y(m.C.rows(), inputs.cols());
  for (Index k = 0; k < inputs.cols(); ++k) {
    y.col(k) = C * x + D * u.col(k);
    x += (step.leftCols(n) * x + step.rightCols(u.rows()) * u.col(k)).eval();
  }
  return y.template cast<double>();
}

void check_step(double h) {
  if (h > 0 && std::isfinite(h)) return;
  throw Error(Code::bad_value, fmt::format("a sample time of {} s", h),
              "give a positive, finite time in seconds");
}

}  // namespace

Hold hold(const MatrixXd& A, const MatrixXd& B, double h) {
  check_step(h);
  const Index n = A.rows();
  if (A.cols() != n || B.rows() != n)
    throw Error(Code::size,
                fmt::format("hold: A is {} x {}, B {} x {}", n, A.cols(), B.rows(), B.cols()),
                "A is square, and B has as many rows");
  const MatrixXd all = n <= kMostInLongDouble
                           ? MatrixXd(increments<long double>(A, B, h).cast<double>())
                           : increments<double>(A, B, h);
  Hold result{all.leftCols(n), all.rightCols(B.cols())};
  result.A.diagonal().array() += 1;
  return result;
}

MatrixXd held_response(const StateSpace& model, double h, const MatrixXd& inputs) {
  check_step(h);
  require_fitting(model, "held_response");
  if (inputs.rows() != model.B.cols())
    throw Error(Code::size, fmt::format("held_response: {} rows of inputs", inputs.rows()),
                fmt::format("the model has {} inputs, one row each", model.B.cols()));
  return model.order() <= kMostInLongDouble ? run<long double>(model, h, inputs)
                                            : run<double>(model, h, inputs);
}

}  // namespace titop
