#pragma once

#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/state_space.hpp>

/// Comparison of models entry by entry.
namespace blocks_test {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

/// Largest difference over the largest entry of `exact`; over 1 if that is all zero.
template <class A, class B>
double off(const A& a, const B& exact) {
  if (a.rows() != exact.rows() || a.cols() != exact.cols()) return 1e300;
  if (exact.size() == 0) return 0;
  const double size = exact.cwiseAbs().maxCoeff();
  return (a - exact).cwiseAbs().maxCoeff() / (size > 0 ? size : 1);
}

/// The worst of the four matrices.
inline double off(const titop::StateSpace& m, const MatrixXd& A, const MatrixXd& B,
                  const MatrixXd& C, const MatrixXd& D) {
  return std::max({off(m.A, A), off(m.B, B), off(m.C, C), off(m.D, D)});
}
inline double off(const titop::StateSpace& m, const titop::StateSpace& exact) {
  return off(m, exact.A, exact.B, exact.C, exact.D);
}

inline MatrixXd matrix(int rows, int cols, std::initializer_list<double> entries) {
  MatrixXd m(rows, cols);
  auto e = entries.begin();
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < cols; ++j) m(i, j) = *e++;
  return m;
}

/// Without the outputs that are no channel (a stretch, an angle).
inline titop::StateSpace channels_only(titop::StateSpace m, int outputs) {
  m.C = m.C.topRows(outputs).eval();
  m.D = m.D.topRows(outputs).eval();
  m.outputs.resize(static_cast<std::size_t>(outputs));
  return m;
}

}  // namespace blocks_test
