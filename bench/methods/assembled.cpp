#include "methods/assembled.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

#include "methods/blocks_at_s.hpp"

namespace titop_bench {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

namespace {

/// f(row, column, value) of all entries.
template <class F>
void each(const Sparse& m, const F& f) {
  for (int j = 0; j < m.outerSize(); ++j)
    for (Sparse::InnerIterator k(m, j); k; ++k) f(k.row(), k.col(), k.value());
}

/// First unknown of each body, then of each joint; the last: their number.
std::vector<Index> places(const Assembly& a) {
  std::vector<Index> first{0};
  for (const auto* sizes : {&a.bodies, &a.joints})
    for (const int size : *sizes) first.push_back(first.back() + size);
  return first;
}

template <class T>
Table<T> equations(const Assembly& a, const T& s) {
  const Index n = a.M.rows(), m = a.G.rows();
  Table<T> all(n + m, n + m);
  const T once = number<T>(1) / s, twice = once / s;
  each(a.M, [&](Index i, Index j, double v) { all(i, j) += number<T>(v); });
  each(a.D, [&](Index i, Index j, double v) { all(i, j) += once * number<T>(v); });
  each(a.K, [&](Index i, Index j, double v) { all(i, j) += twice * number<T>(v); });
  each(a.G, [&](Index i, Index j, double v) { all(n + i, j) = all(j, n + i) = number<T>(v); });
  return all;
}

template <class T>
Table<T> load(const Assembly& a) {
  Table<T> u(a.M.rows() + a.G.rows(), a.B.cols());
  each(a.B, [&](Index i, Index j, double v) { u(i, j) = number<T>(v); });
  return u;
}

/// C a.
template <class T>
MatrixXcd outputs(const Assembly& a, const Table<T>& accel) {
  Table<T> z(a.C.rows(), accel.cols());
  each(a.C, [&](Index i, Index j, double v) { z.subtract(number<T>(-v), accel, j, i); });
  return z.to_double();
}

template <class T>
MatrixXcd dense(const Assembly& a, Complex s) {
  Table<T> u = load<T>(a);
  solve(equations(a, number<T>(s.real(), s.imag())), u);
  return outputs(a, u);
}

template <class T>
MatrixXcd block_by_block(const Assembly& a, Complex s) {
  Table<T> u = load<T>(a);
  solve_by_blocks(equations(a, number<T>(s.real(), s.imag())), u, places(a));
  return outputs(a, u);
}

/// Once round a ring; columns: external inputs, then force and motion at the cut, which is the last
/// joint.
template <class T>
class Round {
 public:
  Round(const Assembly& a, const T& s)
      : a_(a),
        first_(places(a)),
        all_(equations(a, s)),
        w_(load<T>(a)),
        force_(guess(0)),
        motion_(guess(joint_)),
        accel_(a.M.rows(), columns()) {}

  MatrixXcd transfer() {
    for (Index i = 0; i < bodies_; ++i) pass(i);
    return outputs(a_, closed());
  }

 private:
  Index columns() const { return inputs_ + 2 * joint_; }
  Table<T> guess(Index from) const {
    Table<T> g(joint_, columns());
    for (Index k = 0; k < joint_; ++k) g(k, inputs_ + from + k) = number<T>(1);
    return g;
  }

  /// [Z, G_out'; G_in, 0] [a; force after] = [B w - G_in' force before; motion before].
  void pass(Index i) {
    const Index begin = first_[at(i)], size = a_.bodies[at(i)];
    const Index before = first_[at(bodies_ + (i + bodies_ - 1) % bodies_)];
    const Table<T> in = part(all_, before, begin, joint_, size);
    const Table<T> out = part(all_, first_[at(bodies_ + i)], begin, joint_, size);
    Table<T> M(size + joint_, size + joint_), v(size + joint_, columns());
    for (Index r = 0; r < size; ++r) {
      for (Index k = 0; k < size; ++k) M(r, k) = all_(begin + r, begin + k);
      for (Index k = 0; k < inputs_; ++k) v(r, k) = w_(begin + r, k);
      for (Index k = 0; k < joint_; ++k) {
        M(r, size + k) = out(k, r), M(size + k, r) = in(k, r);
        if (in(k, r) != number<T>(0)) v.subtract(in(k, r), force_, k, r);
      }
    }
    for (Index k = 0; k < joint_; ++k) v.subtract(number<T>(-1), motion_, k, size + k);
    solve(std::move(M), v);
    for (Index r = 0; r < size; ++r) accel_.subtract(number<T>(-1), v, r, begin + r);
    force_ = part(v, size, 0, joint_, v.cols());
    motion_ = Table<T>(joint_, v.cols());
    for (Index k = 0; k < joint_; ++k)
      for (Index r = 0; r < size; ++r) motion_.subtract(out(k, r), v, r, k);
  }

  /// With the torn variables equal to their computed values: (round - 1) guess = -(round of w).
  Table<T> closed() const {
    Table<T> M(2 * joint_, 2 * joint_), g(2 * joint_, inputs_);
    for (Index r = 0; r < 2 * joint_; ++r) {
      const Table<T>& back = r < joint_ ? force_ : motion_;
      for (Index k = 0; k < 2 * joint_; ++k) M(r, k) = back(r % joint_, inputs_ + k);
      M(r, r) -= number<T>(1);
      for (Index k = 0; k < inputs_; ++k) g(r, k) = -back(r % joint_, k);
    }
    solve(std::move(M), g);
    Table<T> accel = part(accel_, 0, 0, accel_.rows(), inputs_);
    for (Index r = 0; r < accel.rows(); ++r)
      for (Index k = 0; k < 2 * joint_; ++k) accel.subtract(T(-accel_(r, inputs_ + k)), g, k, r);
    return accel;
  }

  const Assembly& a_;
  Index bodies_ = static_cast<Index>(a_.bodies.size()), inputs_ = a_.B.cols();
  Index joint_ = a_.joints[0];
  std::vector<Index> first_;
  Table<T> all_, w_, force_, motion_;
  Table<T> accel_;
};

template <class T>
MatrixXcd tearing(const Assembly& a, Complex s) {
  return Round<T>(a, number<T>(s.real(), s.imag())).transfer();
}

}  // namespace

MatrixXcd dense_at_s(const Assembly& assembly, Complex s, Digits digits) {
  TITOP_BENCH_IN(dense, assembly, s, digits);
}

MatrixXcd refined_at_s(const Assembly& a, Complex s) {
  Table<Complex> u = load<Complex>(a);
  solve_refined(equations(a, s), u);
  return outputs(a, u);
}

MatrixXcd block_by_block_at_s(const Assembly& assembly, Complex s, Digits digits) {
  TITOP_BENCH_IN(block_by_block, assembly, s, digits);
}

MatrixXcd tearing_at_s(const Assembly& assembly, Complex s, Digits digits) {
  if (!is_ring(assembly)) throw std::logic_error("tearing: not a ring");
  TITOP_BENCH_IN(tearing, assembly, s, digits);
}

bool is_ring(const Assembly& a) {
  const std::vector<Index> first = places(a);
  const std::size_t bodies = a.bodies.size();
  if (bodies < 3 || a.joints.size() != bodies) return false;
  const auto body_of = [&](Index column) {
    return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), column) -
                                    first.begin() - 1);
  };
  bool ring = true;
  each(a.G, [&](Index row, Index column, double) {
    const std::size_t joint = body_of(a.M.rows() + row) - bodies, body = body_of(column);
    ring = ring && (body == joint || body == (joint + 1) % bodies);
  });
  return ring;
}

void dense_lu(const Assembly& a, titop::StateSpace& model) {
  const Index n = a.M.rows(), m = a.G.rows(), nw = a.B.cols();
  MatrixXd all = MatrixXd::Zero(n + m, n + m), right = MatrixXd::Zero(n + m, 2 * n + nw);
  all.topLeftCorner(n, n) = a.M;
  all.bottomLeftCorner(m, n) = a.G;
  all.topRightCorner(n, m) = MatrixXd(a.G).transpose();
  right.topLeftCorner(n, n) = -MatrixXd(a.K);
  right.block(0, n, n, n) = -MatrixXd(a.D);
  right.topRightCorner(n, nw) = a.B;
  const MatrixXd accel = all.partialPivLu().solve(right).topRows(n);
  const MatrixXd z = a.C * accel;
  model.A = MatrixXd::Zero(2 * n, 2 * n), model.B = MatrixXd::Zero(2 * n, nw);
  model.A.topRightCorner(n, n).setIdentity();
  model.A.bottomRows(n) = accel.leftCols(2 * n);
  model.B.bottomRows(n) = accel.rightCols(nw);
  model.C = z.leftCols(2 * n), model.D = z.rightCols(nw);
}

template <class Real>
SparseAssembly<Real>::SparseAssembly(const Assembly& a)
    : load_(Dense::Zero(a.M.rows() + a.G.rows(), a.B.cols())), read_(a.C.cast<Number>()) {
  const Index n = a.M.rows(), size = n + a.G.rows();
  load_.topRows(n) = MatrixXd(a.B).cast<Number>();
  std::vector<Eigen::Triplet<Number>> constant, damping, stiffness;
  const auto add = [&](double c, double d, double k, Index i, Index j) {
    const auto row = static_cast<int>(i), col = static_cast<int>(j);
    const auto value = [](double v) { return Number(static_cast<Real>(v)); };
    constant.emplace_back(row, col, value(c)), damping.emplace_back(row, col, value(d));
    stiffness.emplace_back(row, col, value(k));
  };
  each(a.M, [&](Index i, Index j, double v) { add(v, 0, 0, i, j); });
  each(a.D, [&](Index i, Index j, double v) { add(0, v, 0, i, j); });
  each(a.K, [&](Index i, Index j, double v) { add(0, 0, v, i, j); });
  each(a.G, [&](Index i, Index j, double v) { add(v, 0, 0, n + i, j), add(v, 0, 0, j, n + i); });
  for (Matrix* m : {&constant_, &damping_, &stiffness_}) m->resize(size, size);
  constant_.setFromTriplets(constant.begin(), constant.end());
  damping_.setFromTriplets(damping.begin(), damping.end());
  stiffness_.setFromTriplets(stiffness.begin(), stiffness.end());
  lu_.analyzePattern(constant_);
}

template <class Real>
MatrixXcd SparseAssembly<Real>::transfer(Complex at, bool refine) {
  const Number s(at);
  Matrix at_s = constant_;
  at_s.coeffs() += (damping_.coeffs() + stiffness_.coeffs() / s) / s;
  lu_.factorize(at_s);
  if (lu_.info() != Eigen::Success)
    throw std::runtime_error("sparse LU: " + lu_.lastErrorMessage());
  Dense v = lu_.solve(load_);
  if (refine) v += lu_.solve(Dense(load_ - at_s * v));
  return Dense(read_ * v.topRows(read_.cols())).template cast<Complex>();
}

template class SparseAssembly<float>;
template class SparseAssembly<double>;
template class SparseAssembly<long double>;

}  // namespace titop_bench
