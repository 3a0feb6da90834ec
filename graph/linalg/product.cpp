#include <titop/graph/linalg/product.hpp>
#include <type_traits>

// This file alone is compiled without graph/linalg/eigen.hpp, by which Eigen's products would call
// the functions below.
namespace titop::linalg {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
template <class T>
using Vector = Eigen::Matrix<T, Dynamic, 1>;
template <class T, int order>
using Matrix = Eigen::Map<const Eigen::Matrix<T, Dynamic, Dynamic, order>, 0, Eigen::OuterStride<>>;

template <class Left, class Right, class To>
void write_product(Write write, const Left& left, const Right& right, To& to) {
  switch (write) {
    case Write::set: to.noalias() = left * right; break;
    case Write::add: to.noalias() += left * right; break;
    case Write::subtract: to.noalias() -= left * right; break;
  }
}

/// Calls `with` with x, or with its conjugate.
template <class X, class With>
void maybe_conjugated(bool conjugated, const X& x, const With& with) {
  if constexpr (Eigen::NumTraits<typename X::Scalar>::IsComplex) {
    if (conjugated) return with(x.conjugate());
  }
  with(x);
}

/// Calls `with` with the expression of Eigen that reads m.
template <class T, class With>
void as_expression(const ReadMatrix<T>& m, const With& with) {
  const Eigen::OuterStride<> stride(m.stride);
  if (m.row_major)
    maybe_conjugated(m.conjugated, Matrix<T, Eigen::RowMajor>(m.data, m.rows, m.cols, stride),
                     with);
  else
    maybe_conjugated(m.conjugated, Matrix<T, Eigen::ColMajor>(m.data, m.rows, m.cols, stride),
                     with);
}

template <class T>
Eigen::Map<Vector<T>, 0, Eigen::InnerStride<>> strided(T* data, Index size, Index step) {
  return {data, size, Eigen::InnerStride<>(step)};
}

}  // namespace

template <class A, class B>
void multiply(Write write, const ReadMatrix<A>& a, const ReadMatrix<B>& b,
              const WrittenMatrix<ProductScalar<A, B>>& c) {
  Eigen::Map<Eigen::Matrix<ProductScalar<A, B>, Dynamic, Dynamic>, 0, Eigen::OuterStride<>> to(
      c.data, c.rows, c.cols, Eigen::OuterStride<>(c.stride));
  as_expression(a, [&](const auto& left) {
    as_expression(b, [&](const auto& right) { write_product(write, left, right, to); });
  });
}

template <class A, class B>
void multiply(Write write, const ReadMatrix<A>& a, const ReadVector<B>& x,
              const WrittenVector<ProductScalar<A, B>>& y) {
  using T = ProductScalar<A, B>;
  if (x.step != 1) {
    const Vector<B> dense = Eigen::Map<const Vector<B>, 0, Eigen::InnerStride<>>(
        x.data, x.size, Eigen::InnerStride<>(x.step));
    return multiply(write, a, ReadVector<B>{dense.data(), x.size, 1, x.conjugated}, y);
  }
  if (y.step != 1) {
    auto to = strided(y.data, y.size, y.step);
    Vector<T> dense = write == Write::set ? Vector<T>(y.size) : Vector<T>(to);
    multiply(write, a, x, WrittenVector<T>{dense.data(), y.size, 1});
    to = dense;
    return;
  }
  Eigen::Map<Vector<T>> to(y.data, y.size);
  as_expression(a, [&](const auto& left) {
    maybe_conjugated(x.conjugated, Eigen::Map<const Vector<B>>(x.data, x.size),
                     [&](const auto& right) { write_product(write, left, right, to); });
  });
}

#define TITOP_INSTANTIATE(A, B)                                             \
  template void multiply(Write, const ReadMatrix<A>&, const ReadMatrix<B>&, \
                         const WrittenMatrix<ProductScalar<A, B>>&);        \
  template void multiply(Write, const ReadMatrix<A>&, const ReadVector<B>&, \
                         const WrittenVector<ProductScalar<A, B>>&);
TITOP_FOR_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::linalg
