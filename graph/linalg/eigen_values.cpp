#include <titop/graph/linalg/eigen.hpp>

// In a file of their own, as singular values are: each takes half a minute to compile.
namespace Eigen {

template class EigenSolver<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
template MatrixBase<MatrixXd>::EigenvaluesReturnType MatrixBase<MatrixXd>::eigenvalues() const;

}  // namespace Eigen
