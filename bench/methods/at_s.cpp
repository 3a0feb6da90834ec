#include "methods/blocks_at_s.hpp"

namespace titop_bench {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

/// z = F H u + G w of all u.
template <class T>
MatrixXcd outputs(const Network& net, const Places& p, const std::vector<Table<T>>& H,
                  const Table<T>& u) {
  Table<T> y(net.C.rows(), u.cols());
  for (Index i = 0; i < p.blocks(); ++i)
    for (Index r = 0; r < p.outputs(i); ++r)
      for (Index k = 0; k < p.inputs(i); ++k)
        if (H[at(i)](r, k) != number<T>(0))
          y.subtract(-H[at(i)](r, k), u, p.u[at(i)] + k, p.y[at(i)] + r);
  Table<T> z = product(Table<T>(MatrixXd(net.F)), y);
  const Table<T> G{MatrixXd(net.G)};
  for (Index r = 0; r < z.rows(); ++r) z.subtract(number<T>(-1), G, r, r);
  return z.to_double();
}

/// I - K H.
template <class T>
Table<T> loop(const Network& net, const Places& p, const std::vector<Table<T>>& H) {
  Table<T> M(net.K.rows(), net.K.rows());
  std::vector<Index> block_of(at(net.K.cols()));
  for (Index i = 0; i < p.blocks(); ++i)
    for (Index r = 0; r < p.outputs(i); ++r) block_of[at(p.y[at(i)] + r)] = i;
  for (int j = 0; j < net.K.outerSize(); ++j)
    for (Sparse::InnerIterator k(net.K, j); k; ++k) {
      const Index i = block_of[at(j)];
      for (Index c = 0; c < p.inputs(i); ++c)
        M(k.row(), p.u[at(i)] + c) -= number<T>(k.value()) * H[at(i)](j - p.y[at(i)], c);
    }
  for (Index i = 0; i < M.rows(); ++i) M(i, i) += number<T>(1);
  return M;
}

template <class T>
std::vector<Table<T>> responses(const Network& net, const Places& p, Complex s) {
  std::vector<Table<T>> H;
  for (Index i = 0; i < p.blocks(); ++i)
    H.push_back(response(net, p, i, number<T>(s.real(), s.imag())));
  return H;
}

template <class T>
MatrixXcd dense(const Network& net, Complex s) {
  const Places p(net);
  const auto H = responses<T>(net, p, s);
  Table<T> u{MatrixXd(net.E)};
  solve(loop(net, p, H), u);
  return outputs(net, p, H, u);
}

template <class T>
MatrixXcd block_by_block(const Network& net, Complex s) {
  const Places p(net);
  const auto H = responses<T>(net, p, s);
  Table<T> u{MatrixXd(net.E)};
  solve_by_blocks(loop(net, p, H), u, p.u);
  return outputs(net, p, H, u);
}

}  // namespace

MatrixXcd dense_at_s(const Network& network, Complex s, Digits digits) {
  TITOP_BENCH_IN(dense, network, s, digits);
}

MatrixXcd refined_at_s(const Network& net, Complex s) {
  const Places p(net);
  const auto H = responses<Complex>(net, p, s);
  Table<Complex> u{MatrixXd(net.E)};
  solve_refined(loop(net, p, H), u);
  return outputs(net, p, H, u);
}

MatrixXcd block_by_block_at_s(const Network& network, Complex s, Digits digits) {
  TITOP_BENCH_IN(block_by_block, network, s, digits);
}

}  // namespace titop_bench
