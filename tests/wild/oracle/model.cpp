#include "wild/oracle/model.hpp"

#include <Eigen/LU>

#include "wild/oracle/digits.hpp"

namespace wild {

namespace {

template <class Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

template <class Scalar, class Real>
Matrix<Scalar> in(const Eigen::MatrixBase<Real>& m) {
  return m.unaryExpr([](const auto& x) { return Scalar(x); });
}

Complex rounded(const WideComplex& z) { return Complex(z); }
Complex rounded(const FiftyComplex& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}

template <class Scalar>
Eigen::MatrixXcd rounded(const Matrix<Scalar>& m) {
  return m.unaryExpr([](const Scalar& z) { return rounded(z); });
}

template <class Scalar>
ModelTransfer transfer_in(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                          const MatrixXd& D, const std::vector<Complex>& s, double relative) {
  ModelTransfer result;
  for (const Complex& point : s) {
    Matrix<Scalar> P = in<Scalar>(-A);
    P.diagonal().array() += Scalar(point.real(), point.imag());
    Matrix<Scalar> x(A.rows(), B.cols()), left(C.rows(), A.rows());
    if (A.rows() > 0) {
      x = P.partialPivLu().solve(in<Scalar>(B));
      P.transposeInPlace();
      left = Matrix<Scalar>(P.partialPivLu().solve(in<Scalar>(C.transpose()))).transpose();
    }
    result.H.push_back(rounded(Matrix<Scalar>(in<Scalar>(C) * x + in<Scalar>(D))));
    const MatrixXd size = rounded(x).cwiseAbs(), weight = rounded(left).cwiseAbs();
    result.rounding.push_back(relative * (weight * (A.cwiseAbs() * size + B.cwiseAbs()) +
                                          C.cwiseAbs() * size + D.cwiseAbs()));
  }
  return result;
}

}  // namespace

ModelTransfer model_transfer(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C,
                             const MatrixXd& D, const std::vector<Complex>& s, double relative,
                             Digits digits) {
  return digits == Digits::wide ? transfer_in<WideComplex>(A, B, C, D, s, relative)
                                : transfer_in<FiftyComplex>(A, B, C, D, s, relative);
}

}  // namespace wild
