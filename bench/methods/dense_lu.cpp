#include "dense_lu.hpp"

#include <Eigen/LU>

namespace titop_bench {

using Eigen::MatrixXd;

void dense_lu(const Network& net, titop::StateSpace& model) {
  const Eigen::Index n = net.A.rows(), ny = net.C.rows(), nw = net.E.cols();
  MatrixXd loop = Sparse(-net.D * net.K);
  loop.diagonal().array() += 1;
  MatrixXd y(ny, n + nw);  // of x and w
  y.leftCols(n) = net.C;
  y.rightCols(nw) = Sparse(net.D * net.E);
  y = loop.partialPivLu().solve(y).eval();
  MatrixXd u = net.K * y;
  u.rightCols(nw) += net.E;
  model.A = net.B * u.leftCols(n);
  model.A += net.A;
  model.B = net.B * u.rightCols(nw);
  model.C = net.F * y.leftCols(n);
  model.D = net.F * y.rightCols(nw);
  model.D += net.G;
}

}  // namespace titop_bench
