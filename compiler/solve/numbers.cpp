#include <algorithm>
#include <array>
#include <titop/compiler/solve/lanes.hpp>
#include <titop/compiler/solve/pieces.hpp>
#include <titop/graph/linalg/wide.hpp>

namespace titop::solve {
namespace {

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

/// The same of six columns, as most are, in wide vectors.
TITOP_WIDE void add_product_of_six(double sign, const View<double>& l, const double* r, double* to,
                                   std::ptrdiff_t stride) {
  for (std::ptrdiff_t i = 0; i < l.rows; ++i, to += stride) {
    Lanes<4> four, x;
    Lanes<2> two, z;
    load(four, to), load(two, to + 4);
    for (std::ptrdiff_t k = 0; k < l.cols; ++k) {
      const double a = l(i, k) * sign;
      load(x, r + k * 6), load(z, r + k * 6 + 4);
      four += a * x, two += a * z;
    }
    store(to, four), store(to + 4, two);
  }
}

template <class T, class L>
void add_product(double sign, const View<L>& l, const RowMatrix<double>& r, T* to,
                 std::ptrdiff_t stride) {
  if constexpr (std::is_same_v<T, double> && std::is_same_v<L, double>)
    if (r.cols() == 6) return add_product_of_six(sign, l, r.data(), to, stride);
  if (r.cols() == 6) return add_product_of<6>(sign, l, r.data(), to, stride);
  if (r.cols() == 1) return add_product_of<1>(sign, l, r.data(), to, stride);
  for (std::ptrdiff_t i = 0; i < l.rows; ++i)
    for (std::ptrdiff_t k = 0; k < l.cols; ++k)
      if (const T a = times(lift<T>(l(i, k)), sign); a != T(0))
        add_times(r.cols(), a, r.data() + k * r.cols(), to + i * stride);
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
        p, m_, coefficients_,
        [&](const auto& left) {
          if (right)
            add_product(p.sign, left, *right, place, stride);
          else
            add_matrix(p.sign, left, place, stride);
        },
        [&] {
          if (right) return add_matrix(p.sign, view(*right), place, stride);
          for (int i = 0; i < p.size; ++i) place[i * stride + i] += lift<T>(p.sign);
        });
  }
}

/// sign * left * right * x with x = X u, u of the state's node.
template <class T>
void JointRows<T>::add_state(const Piece& p, int r, T* to, std::ptrdiff_t stride,
                             const int* column) const {
  const auto variables = joint_.plan->structure.row(r);
  by_inputs(p, [&](const Dense<T>& m, const SignalTerm& meaning) {
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

template <class T>
RowMatrix<T> JointRows<T>::rhs(const RowMatrix<T>& known, std::span<const int> first) const {
  const Plan& plan = *joint_.plan;
  auto result = unwritten<T>(plan.unknowns, known.cols());
  result.setZero();
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
    by_inputs(p, [&](const Dense<T>& by_u, const SignalTerm& meaning) {
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
    const View<T> C = view(*m_.output[at(p.left)], p.row, p.rows, 0, p.size);
    if (m != 1 || p.rows > 1) return subtract_product(p.sign, C, value(p.signal), m, to);
    const T* const x = value(p.signal);
    T sum = to[0];
    for (int k = 0; k < p.size; ++k)
      if (x[k] != T(0)) sum -= times(x[k], p.sign) * C(0, k);
    to[0] = sum;
    return;
  }
  const Dense<T> c = dense(p, m_, coefficients_);
  const View<T> left = view(c, 0, static_cast<int>(c.rows()), 0, static_cast<int>(c.cols()));
  subtract_product(1, left, value(p.signal), m, to);
}

template <class T>
void JointRows<T>::add_value(int signal, const RowMatrix<T>& unknowns, const RowMatrix<T>& known,
                             std::span<const int> first, T* to) const {
  const std::ptrdiff_t m = known.cols(), size = graph_.signals[at(signal)].size * m;
  for (const SignalTerm& meaning : joint_.meaning(signal)) {
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
      const T* x = states.data() + first[at(p.signal)] * m;
      T* to = result.data() + plan.row_first[at(r)] * m;
      if (p.of == Piece::Left::state) {
        subtract_product(p.sign, view(*output[at(p.left)], p.row, p.rows, 0, p.size), x, m, to);
        continue;
      }
      const Dense<T> c = dense(p, m_, coefficients_);
      subtract_product(1, view(c, 0, static_cast<int>(c.rows()), 0, p.size), x, m, to);
    }
  return result;
}

template class JointRows<double>;
#define TITOP_INSTANTIATE(T) template class JointRows<T>;
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
