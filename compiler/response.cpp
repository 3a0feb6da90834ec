#include <fmt/format.h>

#include <titop/compiler/response.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/pole.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using solve::Dense;
using solve::lift;
using solve::lifted;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

template <class T>
solve::Response<T> response_in_double(const Block& block, const T& s, ParameterValues parameters) {
  Block::Response r = block.response(solve::Scalar<T>::round(s), parameters);
  if constexpr (std::is_same_v<T, std::complex<double>>)
    return {std::move(r.X), std::move(r.Y)};
  else
    return {lifted<T>(r.X), lifted<T>(r.Y)};
}

template <class T>
Error pole_of(const Block& block, const T& at_s) {
  return pole_at(solve::Scalar<T>::round(at_s), fmt::format("a {}", block.type()));
}

/// Y = rigid + W' diag(s^2 / d) W, d = s^2 + damping s + stiffness.
template <class T>
solve::Response<T> modal_response(const Block& block, const Modal& m, const T& s) {
  const auto n = m.W.rows();
  const Dense<T> W = lifted<T>(m.W);
  solve::Response<T> r{Dense<T>(2 * n, W.cols()), lifted<T>(m.rigid)};
  for (Index i = 0; i < n; ++i) {
    const T d = s * s + lift<T>(m.damping(i)) * s + lift<T>(m.stiffness(i));
    if (d == T(0)) throw pole_of(block, s);
    for (Index j = 0; j < W.cols(); ++j) {
      r.X(i, j) = W(i, j) / d;
      r.X(n + i, j) = s * r.X(i, j);
      for (Index k = 0; k < W.cols(); ++k) r.Y(k, j) += W(i, k) * s * r.X(n + i, j);
    }
  }
  return r;
}

template <class T>
solve::Response<T> general_response(const Block& block, const Dynamics& d, const T& s) {
  const Resolvent<T> resolvent(d, s);
  if (resolvent.singular()) throw pole_of(block, s);
  solve::Response<T> r{resolvent.times(lifted<T>(d.B)), lifted<T>(d.D)};
  for (Index i = 0; i < r.Y.rows(); ++i)
    for (Index j = 0; j < r.Y.cols(); ++j)
      for (Index k = 0; k < r.X.rows(); ++k) r.Y(i, j) += lift<T>(d.C(i, k)) * r.X(k, j);
  return r;
}

/// Columns right of k, or right-hand sides, `count` of them, of as many rows as lu, n x n: x -=
/// (column k of L) x(k), below row k.
template <class T>
void reduce(Index n, const T* lu, Index k, Index count, T* columns) {
  for (T* x = columns; x != columns + count * n; x += n)
    if (const T by = x[k]; by != T(0))
      solve::subtract(n - k - 1, by, lu + k * n + k + 1, x + k + 1);
}

/// Rows a and b of n x columns numbers, column-major, change places.
template <class T>
void swap_rows(Index n, Index columns, T* x, Index a, Index b) {
  for (T* const end = x + columns * n; x != end; x += n) std::swap(x[a], x[b]);
}

}  // namespace

template <class T>
Resolvent<T>::Resolvent(const Dynamics& dynamics, const T& s)
    : modal_(dynamics.modal.get()), s_(s), n_(dynamics.A.rows()) {
  if (modal_) return;
  lu_.reserve(at(n_ * n_));
  for (const double& a : dynamics.A.reshaped()) lu_.push_back(-lift<T>(a));
  row_.reserve(at(n_));
  T* const lu = lu_.data();
  for (Index i = 0; i < n_; ++i) lu[i + i * n_] += s;
  for (Index k = 0; k < n_; ++k) {
    T* const column = lu + k * n_;
    Index best = k;
    for (Index i = k + 1; i < n_; ++i)
      if (solve::size_of(column[i]) > solve::size_of(column[best])) best = i;
    row_.push_back(best);
    if (best != k) swap_rows(n_, n_, lu, k, best);
    for (Index i = k + 1; i < n_; ++i) column[i] /= column[k];
    reduce(n_, lu, k, n_ - k - 1, column + n_);
  }
}

template <class T>
bool Resolvent<T>::singular() const {
  for (Index k = 0; k < n_ && !modal_; ++k)
    if (lu_[at(k + k * n_)] == T(0)) return true;
  return false;
}

template <class T>
Dense<T> Resolvent<T>::times(Dense<T> r) const {
  apply(r.cols(), r.data());
  return r;
}

template <class T>
void Resolvent<T>::apply(Index columns, T* r) const {
  if (modal_) return apply_modes(columns, r);
  const T* const lu = lu_.data();
  for (Index k = 0; k < n_; ++k) {
    if (row_[at(k)] != k) swap_rows(n_, columns, r, k, row_[at(k)]);
    reduce(n_, lu, k, columns, r);
  }
  for (T* x = r; x != r + columns * n_; x += n_)
    for (Index k = n_; k-- > 0;) {
      x[k] /= lu[k + k * n_];
      solve::subtract(k, x[k], lu + k * n_, x);
    }
}

template <class T>
void Resolvent<T>::apply_modes(Index columns, T* r) const {
  const Index modes = modal_->stiffness.size();
  for (Index i = 0; i < modes; ++i) {
    const T c = lift<T>(modal_->damping(i)), d = s_ * s_ + c * s_ + lift<T>(modal_->stiffness(i));
    for (T* x = r; x != r + columns * n_; x += n_) {
      const T eta = ((s_ + c) * x[i] + x[modes + i]) / d;
      x[modes + i] = s_ * eta - x[i];
      x[i] = eta;
    }
  }
}

template <class T>
solve::Response<T> response(const Block& block, const Dynamics& d, const T& s,
                            ParameterValues parameters) {
  if (solve::Scalar<T>::epsilon() > 1e-16) return response_in_double(block, s, parameters);
  return d.modal ? modal_response(block, *d.modal, s) : general_response(block, d, s);
}

#define TITOP_INSTANTIATE(T)   \
  template class Resolvent<T>; \
  template solve::Response<T> response(const Block&, const Dynamics&, const T&, ParameterValues);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
