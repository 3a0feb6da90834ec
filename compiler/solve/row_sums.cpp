#include <titop/compiler/solve/lanes.hpp>
#include <titop/compiler/solve/row_sums.hpp>

namespace titop::solve {
namespace {

/// Neighbours change places: real and imaginary parts.
template <class L>
[[gnu::always_inline]] inline void swap_pairs(L& to, const L& x) {
  if constexpr (kLanes<L> == 2)
    to = __builtin_shufflevector(x, x, 1, 0);
  else if constexpr (kLanes<L> == 4)
    to = __builtin_shufflevector(x, x, 1, 0, 3, 2);
  else
    to = __builtin_shufflevector(x, x, 1, 0, 3, 2, 5, 4, 7, 6);
}

/// y -= a x, as plain loops have it: y.re -= a.re x.re - a.im x.im, and so on.
template <class L>
[[gnu::always_inline]] inline void take(L& y, double a, const L& x) {
  y -= a * x;
}
template <class L>
[[gnu::always_inline]] inline void take(L& y, const std::complex<double>& a, const L& x) {
  L crossed{}, im{};
  swap_pairs(crossed, x);
  for (int i = 0; i < kLanes<L>; i += 2) im[i] = -a.imag(), im[i + 1] = a.imag();
  y -= a.real() * x + im * crossed;
}

/// Numbers of T by the doubles that they are made of.
template <class T>
struct RowProduct {
  std::ptrdiff_t count;
  const T* l;
  const double* x;
  std::ptrdiff_t m;  ///< doubles per row
  double* y;
};

/// C registers of columns from j on.
template <class L, int C, class T>
[[gnu::always_inline]] inline void columns(const RowProduct<T> s, std::ptrdiff_t j) {
  L y[std::size_t{C}];
  for (int c = 0; c < C; ++c) load(y[c], s.y + j + c * kLanes<L>);
  for (std::ptrdiff_t k = 0; k < s.count; ++k) {
    const T l = s.l[k];
    if (l == T(0)) continue;
    const double* const x = s.x + k * s.m + j;
    for (int c = 0; c < C; ++c) {
      L v;
      load(v, x + c * kLanes<L>);
      take(y[c], l, v);
    }
  }
  for (int c = 0; c < C; ++c) store(s.y + j + c * kLanes<L>, y[c]);
}

/// `Rest`: for the columns left at the end, if L is longer; an odd double comes last.
template <class L, class Rest, class T>
[[gnu::always_inline]] inline void all_columns(const RowProduct<T> s) {
  std::ptrdiff_t j = 0;
  // Six complex columns, or twelve, are the usual case: a wrench, and with it its rounding.
  for (; j + 6 * kLanes<L> <= s.m; j += 6 * kLanes<L>) columns<L, 6>(s, j);
  for (; j + 3 * kLanes<L> <= s.m; j += 3 * kLanes<L>) columns<L, 3>(s, j);
  for (; j + 2 * kLanes<L> <= s.m; j += 2 * kLanes<L>) columns<L, 2>(s, j);
  for (; j + kLanes<L> <= s.m; j += kLanes<L>) columns<L, 1>(s, j);
  for (; j + kLanes<Rest> <= s.m; j += kLanes<Rest>) columns<Rest, 1>(s, j);
  for (; j + 2 <= s.m; j += 2) columns<Lanes<2>, 1>(s, j);
  if constexpr (sizeof(T) == sizeof(double))
    if (j < s.m)
      for (std::ptrdiff_t k = 0; k < s.count; ++k)
        if (s.l[k] != 0) s.y[j] -= s.l[k] * s.x[k * s.m + j];
}

template <class T>
void sum_2(const RowProduct<T>& s) {
  all_columns<Lanes<2>, Lanes<2>>(s);
}
#if defined(__x86_64__)
template <class T>
[[gnu::target("avx2")]] void sum_4(const RowProduct<T>& s) {
  all_columns<Lanes<4>, Lanes<4>>(s);
}
template <class T>
[[gnu::target("avx512f")]] void sum_8(const RowProduct<T>& s) {
  all_columns<Lanes<8>, Lanes<4>>(s);
}
#endif

template <class T>
void subtract(const RowProduct<T>& s, [[maybe_unused]] int at_most) {
#if defined(__x86_64__)
  static const int widest = lanes_here(8);
  const int lanes = at_most < widest ? at_most : widest;
  if (lanes >= 8) return sum_8(s);
  if (lanes >= 4) return sum_4(s);
#endif
  sum_2(s);
}

}  // namespace

void subtract_sum(std::ptrdiff_t count, const double* l, const double* x, std::ptrdiff_t m,
                  double* y, int lanes) {
  subtract(RowProduct<double>{count, l, x, m, y}, lanes);
}

void subtract_sum(std::ptrdiff_t count, const std::complex<double>* l,
                  const std::complex<double>* x, std::ptrdiff_t m, std::complex<double>* y,
                  int lanes) {
  subtract(RowProduct<std::complex<double>>{count, l, reinterpret_cast<const double*>(x), 2 * m,
                                            reinterpret_cast<double*>(y)},
           lanes);
}

}  // namespace titop::solve
