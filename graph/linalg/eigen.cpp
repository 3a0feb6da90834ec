#include <titop/graph/linalg/eigen.hpp>

namespace Eigen {

template class LLT<MatrixXd>;
template class PartialPivLU<MatrixXd>;
template class PartialPivLU<MatrixXcd>;
template class FullPivLU<MatrixXd>;
template class HouseholderQR<MatrixXd>;
template class ColPivHouseholderQR<MatrixXd>;
template class CompleteOrthogonalDecomposition<MatrixXd>;
template class CompleteOrthogonalDecomposition<MatrixXcd>;
template void PartialPivLU<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void PartialPivLU<MatrixXcd>::_solve_impl(const MatrixXcd&, MatrixXcd&) const;
template void FullPivLU<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                     MatrixXd&) const;
template void CompleteOrthogonalDecomposition<MatrixXcd>::_solve_impl(const MatrixXcd&,
                                                                      MatrixXcd&) const;

}  // namespace Eigen
