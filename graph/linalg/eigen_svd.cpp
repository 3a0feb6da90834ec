#include <titop/graph/linalg/eigen.hpp>

// In a file of their own: half a minute to compile.
namespace Eigen {

template class JacobiSVD<MatrixXd>;
template class JacobiSVD<MatrixXcd>;
template class BDCSVD<MatrixXd>;

}  // namespace Eigen
