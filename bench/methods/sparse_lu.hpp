#pragma once

#include <Eigen/SparseLU>
#include <complex>
#include <memory>
#include <titop/graph/state_space.hpp>

#include "support/network.hpp"

/// The network in a general sparse solver: Eigen's SparseLU with COLAMD.
namespace titop_bench {

/// [I -D; -K I] [y; u] = [C x; E w] in one factorization.
class SparseLu {
 public:
  /// The order of elimination. `network` must outlive this.
  explicit SparseLu(const Network& network);
  void factorize();

  /// The dense model, from as many right-hand sides as it has columns.
  void write(titop::StateSpace& model);
  /// [xdot; z] of x and w.
  Eigen::VectorXd apply(const Eigen::VectorXd& x, const Eigen::VectorXd& w);

 private:
  void assemble();

  const Network& net_;
  Sparse loop_;
  Eigen::SparseLU<Sparse, Eigen::COLAMDOrdering<int>> lu_;
};

/// [s - A, 0, -B; -C, I, -D; 0, -K, I] [x; y; u] = [0; 0; E w], factored anew at each s on an order
/// of elimination that is found once; in float, double or long double, and optionally with one step
/// of refinement, its residual in Real.
template <class Real = double>
class SparsePencil {
 public:
  explicit SparsePencil(const Network& network);
  Eigen::MatrixXcd transfer(std::complex<double> s, bool refine = false);

 private:
  using Number = std::complex<Real>;
  using Matrix = Eigen::SparseMatrix<Number>;
  using Dense = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  const Network& net_;
  Matrix pencil_;
  Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> lu_;
};

}  // namespace titop_bench
