#pragma once

#include <algorithm>
#include <array>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/numbers.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

/// The matrices that pieces of rows are made of, and their products.
namespace titop::solve {

using linalg::at;

/// A rectangle of a matrix of scalars T, in either order of storage.
template <class T>
struct View {
  const T* data;
  std::ptrdiff_t rows, cols, down, right;
  const T& operator()(std::ptrdiff_t i, std::ptrdiff_t j) const {
    return data[i * down + j * right];
  }
};

template <class T>
View<T> transposed(const View<T>& v) {
  return {v.data, v.cols, v.rows, v.right, v.down};
}

inline View<double> view(const RowMatrix<double>& m) {
  return {m.data(), m.rows(), m.cols(), m.cols(), 1};
}
template <class T>
View<T> view(const Dense<T>& m, int row, int rows, int col, int cols) {
  return {m.data() + row + col * m.rows(), rows, cols, 1, m.rows()};
}

/// to -= sign * L * x, x with m columns
template <class T, class L>
void subtract_product(double sign, const View<L>& l, const T* x, std::ptrdiff_t m, T* to) {
  if constexpr (std::is_same_v<T, L>)
    if (m == 1 && l.down == 1) {  // by columns, which are contiguous
      for (std::ptrdiff_t k = 0; k < l.cols; ++k)
        if (const T a = times(x[k], sign); a != T(0)) subtract(l.rows, a, l.data + k * l.right, to);
      return;
    }
  if (m == 1) {  // summed in registers
    for (std::ptrdiff_t i = 0; i < l.rows; ++i) {
      T sum = to[i];
      for (std::ptrdiff_t k = 0; k < l.cols; ++k) {
        const T a = times(lift<T>(l(i, k)), sign);
        if (a != T(0)) subtract(1, a, x + k, &sum);
      }
      to[i] = sum;
    }
    return;
  }
  constexpr std::ptrdiff_t kTogether = 16;
  std::array<T, kTogether> a;
  for (std::ptrdiff_t i = 0; i < l.rows; ++i)
    for (std::ptrdiff_t k = 0; k < l.cols; k += kTogether) {
      const std::ptrdiff_t count = std::min(kTogether, l.cols - k);
      for (std::ptrdiff_t j = 0; j < count; ++j) a[at(j)] = times(lift<T>(l(i, k + j)), sign);
      subtract_rows(count, a.data(), x + k * m, m, to + i * m);
    }
}

/// Calls take(view) with the piece's left matrix; `identity` if it is none.
template <class T, class Take, class Identity>
void with_left(const Piece& p, const Matrices<T>& m, const std::vector<Coefficient>& c, Take take,
               Identity identity) {
  switch (p.of) {
    case Piece::Left::one: identity(); break;
    case Piece::Left::direct:
      take(view(*m.direct[at(p.left)], p.row, p.rows, p.col, p.cols));
      break;
    case Piece::Left::state: take(view(*m.output[at(p.left)], p.row, p.rows, 0, p.size)); break;
    case Piece::Left::coefficient: take(view(*c[at(p.left)])); break;
  }
}

/// sign * left * right as a matrix.
template <class T>
Dense<T> dense(const Piece& p, const Matrices<T>& m, const std::vector<Coefficient>& c) {
  const auto right = [&] {
    return p.right < 0 ? Dense<T>(Dense<T>::Identity(p.size, p.size))
                       : Dense<T>(lifted<T>(*c[at(p.right)]));
  };
  Dense<T> result;
  with_left(
      p, m, c,
      [&](const auto& left) {
        Dense<T> l(left.rows, left.cols);
        for (Eigen::Index i = 0; i < l.rows(); ++i)
          for (Eigen::Index k = 0; k < l.cols(); ++k) l(i, k) = lift<T>(left(i, k));
        result = lift<T>(p.sign) * l.lazyProduct(right());
      },
      [&] { result = lift<T>(p.sign) * right(); });
  return result;
}

/// Calls visit(matrix, meaning) for all meanings of the inputs of a known state's node.
template <class T>
template <class Visit>
void JointRows<T>::by_inputs(const Piece& p, Visit visit) const {
  const Signal& x = graph_.signals[at(p.signal)];
  const Dense<T> m = dense(p, m_, coefficients_);
  for (int i = graph_.nodes[at(x.node)].first_signal; i < p.signal; ++i) {
    const Signal& u = graph_.signals[at(i)];
    if (u.role != Signal::Role::input || !u.active) continue;
    const Dense<T> by_u = m.lazyProduct(m_.states[at(x.node)]->middleCols(u.first, u.size));
    for (const SignalTerm& meaning : joint_.meaning(i)) visit(by_u, meaning);
  }
}

}  // namespace titop::solve
