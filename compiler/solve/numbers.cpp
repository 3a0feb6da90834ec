#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/numbers.hpp>
#include <titop/compiler/solve/scalar.hpp>

namespace titop::solve {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// A rectangle of a matrix of scalars T, in either order of storage.
template <class T>
struct View {
  const T* data;
  std::ptrdiff_t rows, cols, down, right;
  const T& operator()(std::ptrdiff_t i, std::ptrdiff_t j) const {
    return data[i * down + j * right];
  }
};

View<double> view(const RowMatrix<double>& m) {
  return {m.data(), m.rows(), m.cols(), m.cols(), 1};
}
template <class T>
View<T> view(const Dense<T>& m, int row, int rows, int col, int cols) {
  return {m.data() + row + col * m.rows(), rows, cols, 1, m.rows()};
}

/// to += sign * L
template <class T, class L>
void add_matrix(double sign, const View<L>& l, T* to, std::ptrdiff_t stride) {
  for (std::ptrdiff_t i = 0; i < l.rows; ++i)
    for (std::ptrdiff_t j = 0; j < l.cols; ++j) to[i * stride + j] += times(lift<T>(l(i, j)), sign);
}

/// to += sign * L * R, R row-major with N columns: a row's sums stay in registers.
template <int N, class T, class L>
void add_product_of(double sign, const View<L>& l, const double* r, T* to, std::ptrdiff_t stride) {
  for (std::ptrdiff_t i = 0; i < l.rows; ++i, to += stride) {
    std::array<T, std::size_t{N}> sum;
    std::copy_n(to, N, sum.begin());
    for (std::ptrdiff_t k = 0; k < l.cols; ++k)
      if (const T a = times(lift<T>(l(i, k)), sign); a != T(0))
        add_times(N, a, r + k * N, sum.data());
    std::copy_n(sum.begin(), N, to);
  }
}

template <class T, class L>
void add_product(double sign, const View<L>& l, const RowMatrix<double>& r, T* to,
                 std::ptrdiff_t stride) {
  if (r.cols() == 6) return add_product_of<6>(sign, l, r.data(), to, stride);
  if (r.cols() == 1) return add_product_of<1>(sign, l, r.data(), to, stride);
  for (std::ptrdiff_t i = 0; i < l.rows; ++i)
    for (std::ptrdiff_t k = 0; k < l.cols; ++k)
      if (const T a = times(lift<T>(l(i, k)), sign); a != T(0))
        add_times(r.cols(), a, r.data() + k * r.cols(), to + i * stride);
}

/// to -= sign * L * x, x with m columns
template <class T, class L>
void subtract_product(double sign, const View<L>& l, const T* x, std::ptrdiff_t m, T* to) {
  if constexpr (std::is_same_v<T, L>)
    if (m == 1 && l.down == 1) {  // by columns, which stand in a row
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
  for (std::ptrdiff_t i = 0; i < l.rows; ++i)
    for (std::ptrdiff_t k = 0; k < l.cols; ++k) {
      const T a = times(lift<T>(l(i, k)), sign);
      if (a != T(0)) subtract(m, a, x + k * m, to + i * m);
    }
}

/// to += |L| x, x with m columns, none of them negative
template <class L>
void add_sizes(const View<L>& l, const double* x, std::ptrdiff_t m, double* to) {
  if (m == 1 && l.down == 1) {
    for (std::ptrdiff_t k = 0; k < l.cols; ++k)
      for (std::ptrdiff_t i = 0; i < l.rows; ++i) to[i] += size_of(l.data[i + k * l.right]) * x[k];
    return;
  }
  for (std::ptrdiff_t i = 0; i < l.rows; ++i)
    for (std::ptrdiff_t k = 0; k < l.cols; ++k)
      if (const double a = size_of(l(i, k)); a != 0) add(m, a, x + k * m, to + i * m);
}

/// to -= sign * left * right * x, x with m columns; left or right nullptr: 1. right * x has `size`
/// numbers, for which there is `room`.
template <class T, class Left>
void subtract_products(double sign, const Left* left, const RowMatrix<double>* right, const T* x,
                       std::ptrdiff_t size, std::ptrdiff_t m, T* to, std::vector<T>& room) {
  if (right) {
    room.assign(static_cast<std::size_t>(size), T(0));
    subtract_product(-1, view(*right), x, m, room.data());
    x = room.data();
  }
  if (left) return subtract_product(sign, *left, x, m, to);
  for (std::ptrdiff_t i = 0; i < size; ++i) to[i] -= times(x[i], sign);
}

/// to += |left| |right| x, likewise.
template <class Left>
void add_sizes_of_products(const Left* left, const RowMatrix<double>* right, const double* x,
                           std::ptrdiff_t size, std::ptrdiff_t m, double* to,
                           std::vector<double>& room) {
  if (right) {
    room.assign(static_cast<std::size_t>(size), 0);
    add_sizes(view(*right), x, m, room.data());
    x = room.data();
  }
  if (left) return add_sizes(*left, x, m, to);
  for (std::ptrdiff_t i = 0; i < size; ++i) to[i] += x[i];
}

/// Calls take(view) with the piece's left matrix; `identity` where it is none.
template <class T, class Take, class Identity>
void with_left(const Piece& p, const Matrices<T>& m, const std::vector<Coefficient>& c,
               Eigen::Index states, Take take, Identity identity) {
  switch (p.of) {
    case Piece::Left::one: identity(); break;
    case Piece::Left::direct:
      take(view(*m.direct[at(p.left)], p.row, p.rows, p.col, p.cols));
      break;
    case Piece::Left::state:
      take(view(*m.output[at(p.left)], p.row, p.rows, 0, static_cast<int>(states)));
      break;
    case Piece::Left::coefficient: take(view(*c[at(p.left)])); break;
  }
}

/// sign * left * right as a matrix.
template <class T>
Dense<T> dense(const Piece& p, const Matrices<T>& m, const std::vector<Coefficient>& c, int size) {
  const auto right = [&] {
    return p.right < 0 ? Dense<T>(Dense<T>::Identity(size, size))
                       : Dense<T>(lifted<T>(*c[at(p.right)]));
  };
  Dense<T> result;
  with_left(
      p, m, c, size,
      [&](const auto& left) {
        Dense<T> l(left.rows, left.cols);
        for (Eigen::Index i = 0; i < l.rows(); ++i)
          for (Eigen::Index k = 0; k < l.cols(); ++k) l(i, k) = lift<T>(left(i, k));
        result = lift<T>(p.sign) * l.lazyProduct(right());
      },
      [&] { result = lift<T>(p.sign) * right(); });
  return result;
}

}  // namespace

template <class T>
void JointRows<T>::add(int r, T* to, std::ptrdiff_t stride, const int* column) const {
  for (const Piece& p : joint_.row(r)) {
    if (p.entry < 0) {
      if (written_out(p) && p.of != Piece::Left::state) add_state(p, r, to, stride, column);
      continue;
    }
    T* const place = to + column[p.entry];
    const RowMatrix<double>* right = p.right < 0 ? nullptr : coefficients_[at(p.right)].get();
    with_left(
        p, m_, coefficients_, 0,
        [&](const auto& left) {
          if (right)
            add_product(p.sign, left, *right, place, stride);
          else
            add_matrix(p.sign, left, place, stride);
        },
        [&] {
          if (right) return add_matrix(p.sign, view(*right), place, stride);
          const int size = p.signal < 0 ? p.rows : graph_.signals[at(p.signal)].size;
          for (int i = 0; i < size; ++i) place[i * stride + i] += lift<T>(p.sign);
        });
  }
}

/// sign * left * right * x with x = X u, u of the state's node.
template <class T>
void JointRows<T>::add_state(const Piece& p, int r, T* to, std::ptrdiff_t stride,
                             const int* column) const {
  const auto variables = joint_.plan->structure.row(r);
  by_inputs(p, [&](const Dense<T>& m, const Meaning& meaning) {
    const int v = joint_.variable_of[at(meaning.signal)];
    if (v < 0) return;
    const auto entry = std::lower_bound(variables.begin(), variables.end(), v) - variables.begin();
    const View<T> left = view(m, 0, static_cast<int>(m.rows()), 0, static_cast<int>(m.cols()));
    if (meaning.coefficient < 0)
      add_matrix(1, left, to + column[entry], stride);
    else
      add_product(1, left, *coefficients_[at(meaning.coefficient)], to + column[entry], stride);
  });
}

/// Calls visit(matrix, meaning) for all that the inputs of a known state's node stand for.
template <class T>
template <class Visit>
void JointRows<T>::by_inputs(const Piece& p, Visit visit) const {
  const Signal& x = graph_.signals[at(p.signal)];
  const Dense<T> m = dense(p, m_, coefficients_, x.size);
  for (int i = graph_.nodes[at(x.node)].first_signal; i < p.signal; ++i) {
    const Signal& u = graph_.signals[at(i)];
    if (u.role != Signal::Role::input || !u.active) continue;
    const Dense<T> by_u = m.lazyProduct(m_.states[at(x.node)]->middleCols(u.first, u.size));
    for (const Meaning& meaning : joint_.meaning(i)) visit(by_u, meaning);
  }
}

template <class T>
RowMatrix<T> JointRows<T>::rhs(const RowMatrix<T>& known, std::span<const int> first) const {
  const Plan& plan = *joint_.plan;
  RowMatrix<T> result = RowMatrix<T>::Zero(plan.unknowns, known.cols());
  for (int r = 0; r < static_cast<int>(joint_.rows.size()); ++r)
    for (const Piece& p : joint_.row(r))
      if (p.entry < 0)
        subtract_known(p, known, first, result.data() + plan.row_first[at(r)] * known.cols());
  return result;
}

template <class T>
void JointRows<T>::subtract_known(const Piece& p, const RowMatrix<T>& known,
                                  std::span<const int> first, T* to) const {
  const std::ptrdiff_t m = known.cols();
  const auto value = [&](int signal) { return known.data() + first[at(signal)] * m; };
  if (written_out(p) && p.of == Piece::Left::state) return;  // part of Y(s)
  if (written_out(p)) {
    by_inputs(p, [&](const Dense<T>& by_u, const Meaning& meaning) {
      if (joint_.variable_of[at(meaning.signal)] >= 0) return;
      const Dense<T> c =
          meaning.coefficient < 0
              ? by_u
              : Dense<T>(by_u.lazyProduct(lifted<T>(*coefficients_[at(meaning.coefficient)])));
      const View<T> left = view(c, 0, static_cast<int>(c.rows()), 0, static_cast<int>(c.cols()));
      subtract_product(1, left, value(meaning.signal), m, to);
    });
    return;
  }
  if (p.right < 0 && p.of == Piece::Left::state) {
    const int states = graph_.signals[at(p.signal)].size;
    const View<T> C = view(*m_.output[at(p.left)], p.row, p.rows, 0, states);
    if (m != 1 || p.rows > 1) return subtract_product(p.sign, C, value(p.signal), m, to);
    const T* const x = value(p.signal);
    T sum = to[0];
    for (int k = 0; k < states; ++k)
      if (x[k] != T(0)) sum -= times(x[k], p.sign) * C(0, k);
    to[0] = sum;
    return;
  }
  const Dense<T> c = dense(p, m_, coefficients_, graph_.signals[at(p.signal)].size);
  const View<T> left = view(c, 0, static_cast<int>(c.rows()), 0, static_cast<int>(c.cols()));
  subtract_product(1, left, value(p.signal), m, to);
}

template <class T>
void JointRows<T>::add_value(int signal, const RowMatrix<T>& unknowns, const RowMatrix<T>& known,
                             std::span<const int> first, T* to) const {
  const std::ptrdiff_t m = known.cols(), size = graph_.signals[at(signal)].size * m;
  for (const Meaning& meaning : joint_.meaning(signal)) {
    const int v = joint_.variable_of[at(meaning.signal)];
    const T* value = v >= 0 ? unknowns.data() + joint_.plan->first[at(v)] * m
                            : known.data() + first[at(meaning.signal)] * m;
    if (meaning.coefficient >= 0) {
      const RowMatrix<double>& c = *coefficients_[at(meaning.coefficient)];
      if (m != 1 || c.size() > 1)
        subtract_product(-1, view(c), value, m, to);
      else if (c(0, 0) != 0)
        to[0] += times(value[0], c(0, 0));
    } else if (size == 1) {  // as most signals of scalar diagrams
      to[0] += value[0];
    } else {
      for (std::ptrdiff_t i = 0; i < size; ++i) to[i] += value[i];
    }
  }
}

template <class T>
RowMatrix<T> JointRows<T>::values(const RowMatrix<T>& unknowns, const RowMatrix<T>& known,
                                  std::span<const int> first, std::span<const int> place) const {
  RowMatrix<T> result = RowMatrix<T>::Zero(place.back(), known.cols());
  for (int i = 0; i < static_cast<int>(graph_.signals.size()); ++i)
    add_value(i, unknowns, known, first, result.data() + place[at(i)] * known.cols());
  return result;
}

template <class T>
RowMatrix<T> JointRows<T>::rhs_of_states(const RowMatrix<T>& states, std::span<const int> first,
                                         const std::vector<const Eigen::MatrixXd*>& output) const {
  const Plan& plan = *joint_.plan;
  const std::ptrdiff_t m = states.cols();
  RowMatrix<T> result = RowMatrix<T>::Zero(plan.unknowns, m);
  for (int r = 0; r < static_cast<int>(joint_.rows.size()); ++r)
    for (const Piece& p : joint_.row(r)) {
      if (p.entry >= 0 || graph_.signals[at(p.signal)].role != Signal::Role::state) continue;
      const int size = graph_.signals[at(p.signal)].size;
      const T* x = states.data() + first[at(p.signal)] * m;
      T* to = result.data() + plan.row_first[at(r)] * m;
      if (p.of == Piece::Left::state) {
        subtract_product(p.sign, view(*output[at(p.left)], p.row, p.rows, 0, size), x, m, to);
        continue;
      }
      const Dense<T> c = dense(p, m_, coefficients_, size);
      subtract_product(1, view(c, 0, static_cast<int>(c.rows()), 0, size), x, m, to);
    }
  return result;
}

/// |left| |right| of a piece whose variable is a single number, and left * right; nothing where
/// these are not single numbers.
template <class T>
std::optional<std::pair<double, T>> JointRows<T>::number(const Piece& p) const {
  T c(1);
  if (p.of == Piece::Left::direct && p.rows == 1 && p.cols == 1)
    c = (*m_.direct[at(p.left)])(p.row, p.col);
  else if (p.of == Piece::Left::coefficient && coefficients_[at(p.left)]->size() == 1)
    c = lift<T>(*coefficients_[at(p.left)]->data());
  else if (p.of != Piece::Left::one)
    return {};
  if (p.right < 0) return std::pair(size_of(c), c);
  const RowMatrix<double>& right = *coefficients_[at(p.right)];
  if (right.size() != 1) return {};
  return std::pair(size_of(c) * std::abs(*right.data()), times(c, *right.data()));
}

/// Calls take(scalar row, sign, left, right, variable) for all products sign * left * right *
/// variable that the rows are sums of: left a view, right a coefficient, or nullptr for 1. Where
/// these are single numbers, of which scalar diagrams are made, calls take_number(scalar row, sign,
/// |left| |right|, left * right, variable) instead.
template <class T>
template <class Take, class TakeNumber>
void JointRows<T>::by_products(Take take, TakeNumber take_number) const {
  const Plan& plan = *joint_.plan;
  const auto coefficient = [&](int i) { return i < 0 ? nullptr : coefficients_[at(i)].get(); };
  for (int r = 0; r < static_cast<int>(joint_.rows.size()); ++r) {
    const int row = plan.row_first[at(r)];
    for (const Piece& p : joint_.row(r)) {
      if (p.entry >= 0) {
        const int v = plan.structure.row(r)[at(p.entry)];
        if (plan.structure.variable_size[at(v)] == 1)
          if (const auto c = number(p)) {
            take_number(row, p.sign, c->first, c->second, v);
            continue;
          }
        const RowMatrix<double>* right = coefficient(p.right);
        with_left(
            p, m_, coefficients_, 0, [&](const auto& left) { take(row, p.sign, &left, right, v); },
            [&] { take(row, p.sign, static_cast<const View<double>*>(nullptr), right, v); });
      } else if (written_out(p) && p.of != Piece::Left::state) {
        by_inputs(p, [&](const Dense<T>& m, const Meaning& meaning) {
          const int v = joint_.variable_of[at(meaning.signal)];
          const auto left = view(m, 0, static_cast<int>(m.rows()), 0, static_cast<int>(m.cols()));
          if (v >= 0) take(row, 1.0, &left, coefficient(meaning.coefficient), v);
        });
      }
    }
  }
}

/// Magnitudes are |left| |right| |x|, not |left * right| |x|: the product rounds as well.
template <class T>
RowMatrix<T> JointRows<T>::residual(const RowMatrix<T>& rhs, const RowMatrix<T>& unknowns,
                                    RowMatrix<double>* magnitudes) const {
  const Plan& plan = *joint_.plan;
  const std::ptrdiff_t m = rhs.cols();
  const auto sizes = [](const RowMatrix<T>& x) -> RowMatrix<double> {
    return x.unaryExpr([](const T& entry) { return size_of(entry); });
  };
  RowMatrix<T> result = rhs;
  RowMatrix<double> x_sizes;
  if (magnitudes) *magnitudes = sizes(rhs), x_sizes = sizes(unknowns);
  std::vector<T> room;
  std::vector<double> room_of_sizes;
  const auto product = [&](int row, double sign, const auto* left, const RowMatrix<double>* right,
                           int v) {
    const std::ptrdiff_t from = plan.first[at(v)] * m, to = row * m;
    const std::ptrdiff_t size = (right ? right->rows() : plan.structure.variable_size[at(v)]) * m;
    subtract_products(sign, left, right, unknowns.data() + from, size, m, result.data() + to, room);
    if (magnitudes)
      add_sizes_of_products(left, right, x_sizes.data() + from, size, m, magnitudes->data() + to,
                            room_of_sizes);
  };
  by_products(product, [&](int row, double sign, double size, const T& c, int v) {
    if (c == T(0)) return;
    const std::ptrdiff_t from = plan.first[at(v)] * m, to = row * m;
    const T by = times(c, sign);
    subtract_rows(1, &by, unknowns.data() + from, m, result.data() + to);
    if (magnitudes) solve::add(m, size, x_sizes.data() + from, magnitudes->data() + to);
  });
  return result;
}

template class JointRows<double>;
#define TITOP_INSTANTIATE(T) template class JointRows<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
