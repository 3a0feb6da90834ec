#pragma once

#include <titop/graph/linalg/index.hpp>
#include <vector>

#include "methods/at_s.hpp"
#include "methods/elimination.hpp"

/// Common to the methods of at_s.hpp. For their own files only.
namespace titop_bench {

using titop::linalg::at;

/// First state, input and output of a block.
struct Places {
  std::vector<Eigen::Index> x, u, y;
  explicit Places(const Network& net) {
    Eigen::Index nx = 0, nu = 0, ny = 0;
    for (const auto& [states, inputs, outputs] : net.blocks) {
      x.push_back(nx), u.push_back(nu), y.push_back(ny);
      nx += states, nu += inputs, ny += outputs;
    }
    x.push_back(nx), u.push_back(nu), y.push_back(ny);
  }
  Eigen::Index blocks() const { return static_cast<Eigen::Index>(x.size()) - 1; }
  Eigen::Index inputs(Eigen::Index i) const { return u[at(i) + 1] - u[at(i)]; }
  Eigen::Index outputs(Eigen::Index i) const { return y[at(i) + 1] - y[at(i)]; }
};

/// H(s) of block i: D + C (s - A)^-1 B.
template <class T>
Table<T> response(const Network& net, const Places& p, Eigen::Index i, const T& s) {
  const Eigen::Index x = p.x[at(i)], n = p.x[at(i) + 1] - x, u = p.u[at(i)], y = p.y[at(i)];
  Table<T> Y(Eigen::MatrixXd(net.D.block(y, u, p.outputs(i), p.inputs(i))));
  if (n == 0) return Y;
  Table<T> M(Eigen::MatrixXd(-net.A.block(x, x, n, n))),
      X(Eigen::MatrixXd(net.B.block(x, u, n, p.inputs(i))));
  for (Eigen::Index k = 0; k < n; ++k) M(k, k) += s;
  solve(std::move(M), X);
  const Table<T> C(Eigen::MatrixXd(net.C.block(y, x, p.outputs(i), n)));
  const Table<T> CX = product(C, X);
  for (Eigen::Index r = 0; r < Y.rows(); ++r) Y.subtract(number<T>(-1), CX, r, r);
  return Y;
}

/// f<T> in the number of these digits.
#define TITOP_BENCH_IN(f, network, s, digits)                               \
  switch (digits) {                                                         \
    case Digits::single: return f<std::complex<float>>(network, s);         \
    case Digits::standard: return f<std::complex<double>>(network, s);      \
    case Digits::extended: return f<std::complex<long double>>(network, s); \
    case Digits::fifty: return f<Digits50>(network, s);                     \
  }                                                                         \
  return {}

}  // namespace titop_bench
