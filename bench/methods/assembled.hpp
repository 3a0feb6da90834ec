#pragma once

#include <Eigen/SparseLU>
#include <complex>
#include <titop/graph/state_space.hpp>

#include "methods/at_s.hpp"
#include "support/assembly.hpp"

/// The methods of at_s.hpp, dense_lu.hpp and sparse_lu.hpp on a structure with constraints, whose
/// forces are unknowns: the usual manual form of closed chains.
namespace titop_bench {

/// All of it as one dense matrix at s, partial pivoting. O((coordinates + constraints)^3).
Eigen::MatrixXcd dense_at_s(const Assembly& assembly, std::complex<double> s,
                            Digits digits = Digits::standard);

/// In double with one step of iterative refinement, its residual in double.
Eigen::MatrixXcd refined_at_s(const Assembly& assembly, std::complex<double> s);

/// The same, eliminated body by body, each by the inverse of its own dynamic mass, then joint by
/// joint in the remaining flexibilities (substructuring by Lagrange multipliers).
Eigen::MatrixXcd block_by_block_at_s(const Assembly& assembly, std::complex<double> s,
                                     Digits digits = Digits::standard);

/// Tearing: a ring is cut at its last joint, whose motion and force (12 numbers) are torn
/// variables; all others follow body after body, and closing the ring determines the torn ones.
/// Throws logic_error if joint i does not join bodies i and i + 1. O(bodies).
Eigen::MatrixXcd tearing_at_s(const Assembly& assembly, std::complex<double> s,
                              Digits digits = Digits::standard);

/// True if tearing_at_s applies.
bool is_ring(const Assembly& assembly);

/// The dense model of positions and velocities of all coordinates, free or not: constraints on
/// accelerations, [M, G'; G, 0] by Eigen's PartialPivLU.
void dense_lu(const Assembly& assembly, titop::StateSpace& model);

/// Factored anew at each s by Eigen's SparseLU, on an order of elimination that is found once; in
/// float, double or long double, and optionally with one step of refinement, its residual in Real.
template <class Real = double>
class SparseAssembly {
 public:
  explicit SparseAssembly(const Assembly& assembly);
  Eigen::MatrixXcd transfer(std::complex<double> s, bool refine = false);

 private:
  using Number = std::complex<Real>;
  using Matrix = Eigen::SparseMatrix<Number>;
  using Dense = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix constant_, damping_, stiffness_;  ///< factors of 1, 1/s and 1/s^2, of one pattern
  Dense load_;
  Matrix read_;
  Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> lu_;
};

}  // namespace titop_bench
