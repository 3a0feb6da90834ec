#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <titop/graph/linalg/eigen_products.hpp>

// Eigen's decompositions of matrices of any size, compiled once for all files that include this in
// place of <Eigen/SVD> and so on: a file that compiles its own takes up to a minute. So are
// products of matrices of doubles (graph/linalg/eigen_products.hpp), and `solve` of LU and of the
// orthogonal decomposition if both sides are plain matrices: evaluate expressions.
/// @cond
namespace Eigen {

extern template class LLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class PartialPivLU<MatrixXcd>;
extern template class FullPivLU<MatrixXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class CompleteOrthogonalDecomposition<MatrixXd>;
extern template class CompleteOrthogonalDecomposition<MatrixXcd>;
extern template class JacobiSVD<MatrixXd>;
extern template class JacobiSVD<MatrixXcd>;
extern template class BDCSVD<MatrixXd>;
extern template class EigenSolver<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;

// Templates within them that a plain matrix needs.
extern template void PartialPivLU<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void PartialPivLU<MatrixXcd>::_solve_impl(const MatrixXcd&, MatrixXcd&) const;
extern template void FullPivLU<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                            MatrixXd&) const;
extern template void CompleteOrthogonalDecomposition<MatrixXcd>::_solve_impl(const MatrixXcd&,
                                                                             MatrixXcd&) const;

extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                      bool);
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
extern template MatrixBase<MatrixXd>::EigenvaluesReturnType MatrixBase<MatrixXd>::eigenvalues()
    const;

}  // namespace Eigen
/// @endcond
