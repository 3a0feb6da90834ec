#include <cmath>
#include <optional>
#include <titop/compiler/solve/pieces.hpp>

namespace titop::solve {
namespace {

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

}  // namespace

/// |left| |right| of a piece whose variable is a single number, and left * right; nothing if
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
/// variable that the rows are sums of: left a view, right a coefficient, or nullptr for 1. If
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
            p, m_, coefficients_, [&](const auto& left) { take(row, p.sign, &left, right, v); },
            [&] { take(row, p.sign, static_cast<const View<double>*>(nullptr), right, v); });
      } else if (written_out(p) && p.of != Piece::Left::state) {
        by_inputs(p, [&](const Dense<T>& m, const SignalTerm& meaning) {
          const int v = joint_.variable_of[at(meaning.signal)];
          const auto left = view(m, 0, static_cast<int>(m.rows()), 0, static_cast<int>(m.cols()));
          if (v >= 0) take(row, 1.0, &left, coefficient(meaning.coefficient), v);
        });
      }
    }
  }
}

/// As magnitudes of the residual, |left| |right| |x|.
template <class T>
RowMatrix<double> JointRows<T>::rhs_terms(const RowMatrix<T>& known,
                                          std::span<const int> first) const {
  const Plan& plan = *joint_.plan;
  const std::ptrdiff_t m = known.cols();
  const RowMatrix<double> x =
      known.unaryExpr([](const T& entry) -> double { return size_of(entry); });
  RowMatrix<double> result = RowMatrix<double>::Zero(plan.unknowns, m);
  std::vector<double> room;
  for (int r = 0; r < static_cast<int>(joint_.rows.size()); ++r) {
    double* const to = result.data() + plan.row_first[at(r)] * m;
    const auto add = [&](const auto* left, const RowMatrix<double>* right, int signal, int size) {
      add_sizes_of_products(left, right, x.data() + first[at(signal)] * m, size * m, m, to, room);
    };
    for (const Piece& p : joint_.row(r)) {
      if (p.entry >= 0) continue;
      const RowMatrix<double>* right = p.right < 0 ? nullptr : coefficients_[at(p.right)].get();
      const int size = right ? static_cast<int>(right->rows()) : p.size;
      if (!written_out(p))
        with_left(
            p, m_, coefficients_, [&](const auto& left) { add(&left, right, p.signal, size); },
            [&] { add(static_cast<const View<double>*>(nullptr), right, p.signal, size); });
      else if (p.of != Piece::Left::state)
        by_inputs(p, [&](const Dense<T>& by_u, const SignalTerm& meaning) {
          if (joint_.variable_of[at(meaning.signal)] >= 0) return;
          const auto left =
              view(by_u, 0, static_cast<int>(by_u.rows()), 0, static_cast<int>(by_u.cols()));
          add(&left,
              meaning.coefficient < 0 ? nullptr : coefficients_[at(meaning.coefficient)].get(),
              meaning.signal, static_cast<int>(by_u.cols()));
        });
    }
  }
  return result;
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
  auto result = unwritten<T>(rhs.rows(), m);
  result = rhs;
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

namespace {

/// to -= sign * right' * left' * x, x with m columns; left or right nullptr: 1. left' * x has
/// `size` numbers, for which there is `room`.
template <class T, class Left>
void subtract_transposed_products(double sign, const Left* left, const RowMatrix<double>* right,
                                  const T* x, std::ptrdiff_t size, std::ptrdiff_t m, T* to,
                                  std::vector<T>& room) {
  if (left && right) {
    room.assign(static_cast<std::size_t>(size), T(0));
    subtract_product(-1, transposed(*left), x, m, room.data());
    x = room.data();
  }
  if (right) return subtract_product(sign, transposed(view(*right)), x, m, to);
  if (left) return subtract_product(sign, transposed(*left), x, m, to);
  for (std::ptrdiff_t i = 0; i < size; ++i) to[i] -= times(x[i], sign);
}

/// to += |right|' |left|' x, likewise.
template <class Left>
void add_sizes_of_transposed_products(const Left* left, const RowMatrix<double>* right,
                                      const double* x, std::ptrdiff_t size, std::ptrdiff_t m,
                                      double* to, std::vector<double>& room) {
  if (left && right) {
    room.assign(static_cast<std::size_t>(size), 0);
    add_sizes(transposed(*left), x, m, room.data());
    x = room.data();
  }
  if (right) return add_sizes(transposed(view(*right)), x, m, to);
  if (left) return add_sizes(transposed(*left), x, m, to);
  for (std::ptrdiff_t i = 0; i < size; ++i) to[i] += x[i];
}

}  // namespace

template <class T>
RowMatrix<T> JointRows<T>::transposed_residual(const RowMatrix<T>& rhs,
                                               const RowMatrix<T>& solutions,
                                               RowMatrix<double>* magnitudes) const {
  const Plan& plan = *joint_.plan;
  const std::ptrdiff_t m = rhs.cols();
  const auto sizes = [](const RowMatrix<T>& x) -> RowMatrix<double> {
    return x.unaryExpr([](const T& entry) { return size_of(entry); });
  };
  RowMatrix<T> result = rhs;
  RowMatrix<double> x_sizes;
  if (magnitudes) *magnitudes = sizes(rhs), x_sizes = sizes(solutions);
  std::vector<T> room;
  std::vector<double> room_of_sizes;
  const auto product = [&](int row, double sign, const auto* left, const RowMatrix<double>* right,
                           int v) {
    const std::ptrdiff_t from = row * m, to = plan.first[at(v)] * m;
    const std::ptrdiff_t size = (right ? right->rows() : plan.structure.variable_size[at(v)]) * m;
    subtract_transposed_products(sign, left, right, solutions.data() + from, size, m,
                                 result.data() + to, room);
    if (magnitudes)
      add_sizes_of_transposed_products(left, right, x_sizes.data() + from, size, m,
                                       magnitudes->data() + to, room_of_sizes);
  };
  by_products(product, [&](int row, double sign, double size, const T& c, int v) {
    if (c == T(0)) return;
    const std::ptrdiff_t from = row * m, to = plan.first[at(v)] * m;
    const T by = times(c, sign);
    subtract_rows(1, &by, solutions.data() + from, m, result.data() + to);
    if (magnitudes) solve::add(m, size, x_sizes.data() + from, magnitudes->data() + to);
  });
  return result;
}

#define TITOP_INSTANTIATE(T)                                                                    \
  template RowMatrix<double> JointRows<T>::rhs_terms(const RowMatrix<T>&, std::span<const int>) \
      const;                                                                                    \
  template RowMatrix<T> JointRows<T>::residual(const RowMatrix<T>&, const RowMatrix<T>&,        \
                                               RowMatrix<double>*) const;                       \
  template RowMatrix<T> JointRows<T>::transposed_residual(                                      \
      const RowMatrix<T>&, const RowMatrix<T>&, RowMatrix<double>*) const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
