#include <titop/compiler/response.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>

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

/// Y = rigid + W' diag(s^2 / d) W, d = s^2 + damping s + stiffness.
template <class T>
solve::Response<T> modal_response(const Modal& m, const T& s) {
  const auto n = m.W.rows();
  const Dense<T> W = lifted<T>(m.W);
  solve::Response<T> r{Dense<T>(2 * n, W.cols()), lifted<T>(m.rigid)};
  for (Index i = 0; i < n; ++i) {
    const T d = s * s + lift<T>(m.damping(i)) * s + lift<T>(m.stiffness(i));
    for (Index j = 0; j < W.cols(); ++j) {
      r.X(i, j) = W(i, j) / d;
      r.X(n + i, j) = s * r.X(i, j);
      for (Index k = 0; k < W.cols(); ++k) r.Y(k, j) += W(i, k) * s * r.X(n + i, j);
    }
  }
  return r;
}

template <class T>
solve::Response<T> general_response(const Dynamics& d, const T& s) {
  solve::Response<T> r{Resolvent<T>(d, s).times(lifted<T>(d.B)), lifted<T>(d.D)};
  for (Index i = 0; i < r.Y.rows(); ++i)
    for (Index j = 0; j < r.Y.cols(); ++j)
      for (Index k = 0; k < r.X.rows(); ++k) r.Y(i, j) += lift<T>(d.C(i, k)) * r.X(k, j);
  return r;
}

/// Columns right of k, or right-hand sides, `count` of them, of as many rows as lu: x -= (column k
/// of L) x(k), below row k.
template <class T>
void reduce(const Dense<T>& lu, Index k, Index count, T* columns) {
  const Index n = lu.rows();
  for (T* x = columns; x != columns + count * n; x += n)
    if (const T by = x[k]; by != T(0))
      solve::subtract(n - k - 1, by, lu.data() + k * n + k + 1, x + k + 1);
}

}  // namespace

template <class T>
Resolvent<T>::Resolvent(const Dynamics& dynamics, const T& s)
    : modal_(dynamics.modal.get()), s_(s) {
  if (modal_) return;
  lu_ = -lifted<T>(dynamics.A);
  const Index n = lu_.rows();
  row_.reserve(at(n));
  for (Index i = 0; i < n; ++i) lu_(i, i) += s;
  for (Index k = 0; k < n; ++k) {
    Index best = k;
    for (Index i = k + 1; i < n; ++i)
      if (solve::size_of(lu_(i, k)) > solve::size_of(lu_(best, k))) best = i;
    row_.push_back(best);
    if (best != k) lu_.row(k).swap(lu_.row(best));
    for (Index i = k + 1; i < n; ++i) lu_(i, k) /= lu_(k, k);
    reduce<T>(lu_, k, n - k - 1, lu_.data() + (k + 1) * n);
  }
}

template <class T>
Dense<T> Resolvent<T>::times(Dense<T> x) const {
  if (modal_) {
    const auto modes = modal_->stiffness.size();
    for (Index i = 0; i < modes; ++i) {
      const T c = lift<T>(modal_->damping(i)), d = s_ * s_ + c * s_ + lift<T>(modal_->stiffness(i));
      for (Index j = 0; j < x.cols(); ++j) {
        const T eta = ((s_ + c) * x(i, j) + x(modes + i, j)) / d;
        x(modes + i, j) = s_ * eta - x(i, j);
        x(i, j) = eta;
      }
    }
    return x;
  }
  const Index n = lu_.rows();
  for (Index k = 0; k < n; ++k) {
    if (row_[at(k)] != k) x.row(k).swap(x.row(row_[at(k)]));
    reduce<T>(lu_, k, x.cols(), x.data());
  }
  for (Index k = n - 1; k >= 0; --k)
    for (Index j = 0; j < x.cols(); ++j) {
      x(k, j) /= lu_(k, k);
      solve::subtract(k, x(k, j), lu_.data() + k * n, &x(0, j));
    }
  return x;
}

template <class T>
solve::Response<T> response(const Block& block, const Dynamics& d, const T& s,
                            ParameterValues parameters) {
  if (solve::Scalar<T>::epsilon() > 1e-16) return response_in_double(block, s, parameters);
  return d.modal ? modal_response(*d.modal, s) : general_response(d, s);
}

#define TITOP_INSTANTIATE(T)   \
  template class Resolvent<T>; \
  template solve::Response<T> response(const Block&, const Dynamics&, const T&, ParameterValues);
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::detail
