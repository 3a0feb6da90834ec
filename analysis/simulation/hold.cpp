#include <fmt/format.h>

#include <cmath>
#include <titop/analysis/simulation/hold.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/similarity_scaling.hpp>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

template <class T>
using DenseMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

constexpr Index kMostInLongDouble = 128;  ///< states: some tenths of a second

/// Diagonal d, powers of two, such that the first n rows and columns of d^-1 X d have equal norms;
/// the others (inputs) are scaled to the size of the rows that they drive.
Eigen::VectorXd scaling(const MatrixXd& X, Index n) {
  Eigen::VectorXd d = Eigen::VectorXd::Ones(X.rows());
  MatrixXd own = X.topLeftCorner(n, n);
  d.head(n) = linalg::similarity_scaling(own);
  const double size = own.cwiseAbs().colwise().sum().maxCoeff();
  for (Index j = n; j < X.cols(); ++j) {
    const double c = X.col(j).head(n).cwiseAbs().cwiseQuotient(d.head(n)).sum();
    if (c > 0 && size > 0) d(j) = std::exp2(std::round(std::log2(size / c)));
  }
  return d;
}

/// [exp(A h), integral B] as one n x (n + nu) matrix: the exponential of [[A, B], [0, 0]] h.
template <class T>
DenseMatrix<T> held_part(const MatrixXd& A, const MatrixXd& B, double h) {
  const Index n = A.rows(), m = B.cols();
  MatrixXd X = MatrixXd::Zero(n + m, n + m);
  X.topRows(n) << A, B;
  const Eigen::VectorXd d = scaling(X, n);
  const MatrixXd scaled = d.cwiseInverse().asDiagonal() * X * d.asDiagonal();  // exact
  const DenseMatrix<T> power = DenseMatrix<T>(scaled.cast<T>() * T(h)).exp();
  return d.cast<T>().head(n).asDiagonal() * power.topRows(n) *
         d.cwiseInverse().cast<T>().asDiagonal();
}

/// The same, of uncoupled parts one by one: fast ones cost the slow ones no digits.
DenseMatrix<long double> held(const MatrixXd& A, const MatrixXd& B, double h) {
  const Index n = A.rows(), m = B.cols();
  DenseMatrix<long double> all = DenseMatrix<long double>::Zero(n, n + m);
  for (const std::vector<int>& states : linalg::uncoupled_parts(A)) {
    const Index size = std::ssize(states);
    const MatrixXd own_A = A(states, states), own_B = B(states, Eigen::all);
    const DenseMatrix<long double> own =
        size <= kMostInLongDouble ? held_part<long double>(own_A, own_B, h)
                                  : held_part<double>(own_A, own_B, h).cast<long double>();
    all(states, states) = own.leftCols(size);
    all.rightCols(m)(states, Eigen::all) = own.rightCols(m);
  }
  return all;
}

template <class T>
MatrixXd run(const StateSpace& m, double h, const MatrixXd& inputs) {
  const Index n = m.A.rows();
  const DenseMatrix<T> step = held(m.A, m.B, h).cast<T>(), u = inputs.cast<T>();
  const DenseMatrix<T> C = m.C.cast<T>(), D = m.D.cast<T>();
  DenseMatrix<T> x = DenseMatrix<T>::Zero(n, 1), y(m.C.rows(), inputs.cols());
  for (Index k = 0; k < inputs.cols(); ++k) {
    y.col(k) = C * x + D * u.col(k);
    x = (step.leftCols(n) * x + step.rightCols(u.rows()) * u.col(k)).eval();
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
  const MatrixXd all = held(A, B, h).cast<double>();
  return {all.leftCols(n), all.rightCols(B.cols())};
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
