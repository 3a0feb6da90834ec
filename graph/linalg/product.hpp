#pragma once

#include <Eigen/Core>
#include <complex>

/// Products of real and complex matrices of any size, compiled once: Eigen's own kernels behind
/// functions that take pointers. A file that compiles `C * X` by itself spends 0.1 s on each pair
/// of types, which was a third of the time to build the library.
namespace titop::linalg {

/// A dense matrix that is read: entry (i, j) is at data[i + j stride], or at data[j + i stride] if
/// it is row-major, conjugated if `conjugated`.
template <class T>
struct ReadMatrix {
  const T* data;
  Eigen::Index rows, cols, stride;
  bool row_major, conjugated;

  ReadMatrix transposed() const { return {data, cols, rows, stride, !row_major, conjugated}; }
};

/// A dense matrix that is written; in another order than column-major it is handed in transposed.
template <class T>
struct WrittenMatrix {
  T* data;
  Eigen::Index rows, cols, stride;
};

/// Entry i is at data[i step].
template <class T>
struct ReadVector {
  const T* data;
  Eigen::Index size, step;
  bool conjugated;
};

template <class T>
struct WrittenVector {
  T* data;
  Eigen::Index size, step;
};

enum class Write { set, add, subtract };

/// The scalar of the product of A and B.
template <class A, class B>
using ProductScalar = typename Eigen::ScalarBinaryOpTraits<A, B>::ReturnType;

/// c = a b, c += a b or c -= a b: as Eigen's `noalias()`, c shares no entry with a and b. A and B
/// are double or std::complex<double>. Cost rows x inner x cols.
template <class A, class B>
void multiply(Write write, const ReadMatrix<A>& a, const ReadMatrix<B>& b,
              const WrittenMatrix<ProductScalar<A, B>>& c);

/// y = a x, y += a x or y -= a x.
template <class A, class B>
void multiply(Write write, const ReadMatrix<A>& a, const ReadVector<B>& x,
              const WrittenVector<ProductScalar<A, B>>& y);

#define TITOP_FOR_SCALARS(DO)      \
  DO(double, double)               \
  DO(double, std::complex<double>) \
  DO(std::complex<double>, double) \
  DO(std::complex<double>, std::complex<double>)
#define TITOP_DECLARE(A, B)                                                        \
  extern template void multiply(Write, const ReadMatrix<A>&, const ReadMatrix<B>&, \
                                const WrittenMatrix<ProductScalar<A, B>>&);        \
  extern template void multiply(Write, const ReadMatrix<A>&, const ReadVector<B>&, \
                                const WrittenVector<ProductScalar<A, B>>&);
TITOP_FOR_SCALARS(TITOP_DECLARE)
#undef TITOP_DECLARE

}  // namespace titop::linalg
