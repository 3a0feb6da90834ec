#pragma once

#include <titop/graph/linalg/product.hpp>
#include <type_traits>

// Eigen 3.4 evaluates a product of dense expressions by generic_product_impl. The specialisations
// below hand operands and result of matrices of any size to titop::linalg::multiply in place of
// instantiating kernels for each pair of types. Products whose sizes are small and known to the
// compiler, and scalars other than double and std::complex<double>, stay Eigen's. The members that
// are compiled here have names of their own: a file that includes Eigen alone can be linked to
// this.
/// @cond
namespace titop::linalg {

template <class T>
constexpr bool is_double = std::is_same_v<T, double> || std::is_same_v<T, std::complex<double>>;
template <class Left, class Right>
concept DoubleOperands = is_double<typename Left::Scalar> && is_double<typename Right::Scalar>;

/// An operand without scalar factor and conjugation: a reference if it lies in memory, else a copy.
template <class X>
using InMemory = typename Eigen::internal::add_const_on_value_type<
    typename Eigen::internal::blas_traits<X>::DirectLinearAccessType>::type;

template <class X>
constexpr bool is_row_major = bool(X::Flags & Eigen::RowMajorBit);

template <class X>
auto read_matrix(const X& x, bool conjugated) {
  return ReadMatrix<typename X::Scalar>{x.data(),        x.rows(),        x.cols(),
                                        x.outerStride(), is_row_major<X>, conjugated};
}

template <class X>
auto read_vector(const X& x, bool conjugated) {
  return ReadVector<typename X::Scalar>{x.data(), x.size(), x.innerStride(), conjugated};
}

template <class To, class Scalar>
constexpr bool is_written_in_place =
    bool(Eigen::internal::traits<To>::Flags & Eigen::DirectAccessBit) &&
    std::is_same_v<typename To::Scalar, Scalar>;

template <class To, class Value>
void write_value(Write write, To& to, const Value& value) {
  switch (write) {
    case Write::set: to = value; break;
    case Write::add: to += value; break;
    case Write::subtract: to -= value; break;
  }
}

/// How Eigen is to evaluate Left * Right, by Derived::in_place where the result lies in memory.
template <class Left, class Right, class Derived>
struct ProductOfDoubles {
  using Scalar = ProductScalar<typename Left::Scalar, typename Right::Scalar>;
  using OfLeft = Eigen::internal::blas_traits<Left>;
  using OfRight = Eigen::internal::blas_traits<Right>;

  template <class To>
  static void evalTo(To& to, const Left& left, const Right& right) {
    write(Write::set, to, left, right);
  }
  template <class To>
  static void addTo(To& to, const Left& left, const Right& right) {
    write(Write::add, to, left, right);
  }
  template <class To>
  static void subTo(To& to, const Left& left, const Right& right) {
    write(Write::subtract, to, left, right);
  }
  template <class To>
  static void scaleAndAddTo(To& to, const Left& left, const Right& right, const Scalar& factor) {
    write_scaled(Write::add, to, left, right, factor);
  }

 private:
  template <class To>
  static void write(Write write, To& to, const Left& left, const Right& right) {
    if constexpr (OfLeft::HasScalarFactor || OfRight::HasScalarFactor ||
                  !Derived::template in_place<To>)
      write_scaled(write, to, left, right, Scalar(1));
    else
      multiply(write, to, left, right);
  }

  template <class To>
  static void multiply(Write write, To& to, const Left& left, const Right& right) {
    InMemory<Left> l = OfLeft::extract(left);
    InMemory<Right> r = OfRight::extract(right);
    Derived::run(write, l, r, to);
  }

  template <class To>
  static void write_scaled(Write write, To& to, const Left& left, const Right& right,
                           const Scalar& factor) {
    constexpr int rows = To::RowsAtCompileTime, cols = To::ColsAtCompileTime;
    Eigen::Matrix<Scalar, rows, cols, rows == 1 && cols != 1 ? Eigen::RowMajor : Eigen::ColMajor>
        product(to.rows(), to.cols());
    multiply(Write::set, product, left, right);
    write_value(write, to, Eigen::internal::combine_scalar_factors(factor, left, right) * product);
  }
};

template <class Left, class Right>
struct MatrixProduct : ProductOfDoubles<Left, Right, MatrixProduct<Left, Right>> {
  using Base = ProductOfDoubles<Left, Right, MatrixProduct<Left, Right>>;
  template <class To>
  static constexpr bool in_place = is_written_in_place<To, typename Base::Scalar> &&
                                   Eigen::internal::inner_stride_at_compile_time<To>::ret == 1;

  template <class L, class R, class To>
  static void run(Write write, const L& left, const R& right, To& to) {
    const auto l = read_matrix(left, Base::OfLeft::NeedToConjugate);
    const auto r = read_matrix(right, Base::OfRight::NeedToConjugate);
    const Eigen::Index stride = to.outerStride();
    if constexpr (is_row_major<To>)
      linalg::multiply(
          write, r.transposed(), l.transposed(),
          WrittenMatrix<typename Base::Scalar>{to.data(), to.cols(), to.rows(), stride});
    else
      linalg::multiply(
          write, l, r,
          WrittenMatrix<typename Base::Scalar>{to.data(), to.rows(), to.cols(), stride});
  }
};

/// One operand is a vector to the compiler.
template <class Left, class Right>
struct VectorProduct : ProductOfDoubles<Left, Right, VectorProduct<Left, Right>> {
  using Base = ProductOfDoubles<Left, Right, VectorProduct<Left, Right>>;
  template <class To>
  static constexpr bool in_place = is_written_in_place<To, typename Base::Scalar>;

  template <class L, class R, class To>
  static void run(Write write, const L& left, const R& right, To& to) {
    const WrittenVector<typename Base::Scalar> y{to.data(), to.size(), to.innerStride()};
    constexpr bool conjugate_left = Base::OfLeft::NeedToConjugate;
    constexpr bool conjugate_right = Base::OfRight::NeedToConjugate;
    if constexpr (Left::IsVectorAtCompileTime)
      linalg::multiply(write, read_matrix(right, conjugate_right).transposed(),
                       read_vector(left, conjugate_left), y);
    else
      linalg::multiply(write, read_matrix(left, conjugate_left),
                       read_vector(right, conjugate_right), y);
  }
};

}  // namespace titop::linalg

namespace Eigen::internal {

template <class Left, class Right>
  requires titop::linalg::DoubleOperands<Left, Right>
struct generic_product_impl<Left, Right, DenseShape, DenseShape, GemmProduct>
    : titop::linalg::MatrixProduct<Left, Right> {};

template <class Left, class Right>
  requires titop::linalg::DoubleOperands<Left, Right>
struct generic_product_impl<Left, Right, DenseShape, DenseShape, GemvProduct>
    : titop::linalg::VectorProduct<Left, Right> {};

}  // namespace Eigen::internal
/// @endcond
