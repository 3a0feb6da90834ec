#include "sparse_lu.hpp"

#include <algorithm>
#include <stdexcept>

namespace titop_bench {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

template <class T>
using RealOf = typename Eigen::NumTraits<T>::Real;
template <class T>
using Triplets = std::vector<Eigen::Triplet<T>>;

template <class T>
void add(Triplets<T>& list, const Sparse& m, double sign, Index row, Index col) {
  for (int j = 0; j < m.outerSize(); ++j)
    for (Sparse::InnerIterator it(m, j); it; ++it)
      list.emplace_back(static_cast<int>(row + it.row()), static_cast<int>(col + j),
                        T(static_cast<RealOf<T>>(sign * it.value())));
}

template <class T>
void add_identity(Triplets<T>& list, Index size, T value, Index at) {
  for (int i = 0; i < size; ++i)
    list.emplace_back(static_cast<int>(at) + i, static_cast<int>(at) + i, value);
}

template <class Solver>
void check(const Solver& lu) {
  if (lu.info() != Eigen::Success) throw std::runtime_error("sparse LU: " + lu.lastErrorMessage());
}

}  // namespace

SparseLu::SparseLu(const Network& network) : net_(network) {
  assemble();
  lu_.analyzePattern(loop_);
}

void SparseLu::assemble() {
  const Index ny = net_.C.rows(), nu = net_.B.cols();
  Triplets<double> list;
  add_identity(list, ny + nu, 1.0, 0);
  add(list, net_.D, -1, 0, ny);
  add(list, net_.K, -1, ny, 0);
  loop_.resize(ny + nu, ny + nu);
  loop_.setFromTriplets(list.begin(), list.end());
}

void SparseLu::factorize() {
  assemble();
  lu_.factorize(loop_);
  check(lu_);
}

void SparseLu::write(titop::StateSpace& model) {
  const Index n = net_.A.rows(), ny = net_.C.rows(), nu = net_.B.cols(), nw = net_.E.cols();
  model.A.resize(n, n), model.B.resize(n, nw);
  model.C.resize(net_.F.rows(), n), model.D.resize(net_.F.rows(), nw);
  constexpr Index kBlock = 64;  // columns at a time: the right-hand sides stay in the cache
  for (Index first = 0; first < n; first += kBlock) {
    const Index m = std::min(kBlock, n - first);
    MatrixXd rhs = MatrixXd::Zero(ny + nu, m);
    rhs.topRows(ny) = net_.C.middleCols(first, m);
    const MatrixXd v = lu_.solve(rhs);
    model.A.middleCols(first, m) = net_.B * v.bottomRows(nu);
    model.A.middleCols(first, m) += net_.A.middleCols(first, m);
    model.C.middleCols(first, m) = net_.F * v.topRows(ny);
  }
  MatrixXd rhs = MatrixXd::Zero(ny + nu, nw);
  rhs.bottomRows(nu) = net_.E;
  const MatrixXd v = lu_.solve(rhs);
  model.B = net_.B * v.bottomRows(nu);
  model.D = net_.F * v.topRows(ny);
  model.D += net_.G;
}

VectorXd SparseLu::apply(const VectorXd& x, const VectorXd& w) {
  const Index n = net_.A.rows(), ny = net_.C.rows(), nu = net_.B.cols(), nz = net_.F.rows();
  VectorXd rhs(ny + nu), result(n + nz);
  rhs << net_.C * x, net_.E * w;
  const VectorXd v = lu_.solve(rhs);
  result << net_.A * x + net_.B * v.tail(nu), net_.F * v.head(ny) + net_.G * w;
  return result;
}

template <class Real>
SparsePencil<Real>::SparsePencil(const Network& network) : net_(network) {
  const Index n = net_.A.rows(), ny = net_.C.rows(), nu = net_.B.cols();
  Triplets<Number> list;
  add_identity(list, n, Number(0), 0);  // the place of s
  add_identity(list, ny + nu, Number(1), n);
  add(list, net_.A, -1, 0, 0);
  add(list, net_.B, -1, 0, n + ny);
  add(list, net_.C, -1, n, 0);
  add(list, net_.D, -1, n, n + ny);
  add(list, net_.K, -1, n + ny, n);
  pencil_.resize(n + ny + nu, n + ny + nu);
  pencil_.setFromTriplets(list.begin(), list.end());
  lu_.analyzePattern(pencil_);
}

template <class Real>
MatrixXcd SparsePencil<Real>::transfer(std::complex<double> s, bool refine) {
  const Index n = net_.A.rows(), ny = net_.C.rows(), nu = net_.B.cols();
  Matrix at_s = pencil_;
  for (Index i = 0; i < n; ++i) at_s.coeffRef(i, i) += Number(s);
  lu_.factorize(at_s);
  check(lu_);
  Dense rhs = Dense::Zero(n + ny + nu, net_.E.cols());
  rhs.bottomRows(nu) = MatrixXd(net_.E).cast<Number>();
  Dense v = lu_.solve(rhs);
  if (refine) v += lu_.solve(Dense(rhs - at_s * v));
  const Matrix F = net_.F.cast<Number>();
  const Dense z = F * v.middleRows(n, ny) + MatrixXd(net_.G).cast<Number>();
  return z.template cast<std::complex<double>>();
}

template class SparsePencil<float>;
template class SparsePencil<double>;
template class SparsePencil<long double>;

}  // namespace titop_bench
