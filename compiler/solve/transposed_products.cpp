#include <titop/compiler/solve/pieces.hpp>

/// Products with the transposed matrices of right-hand sides and values.
namespace titop::solve {

template <class T>
void JointRows<T>::add_transposed_rhs(const RowMatrix<T>& solutions, std::span<const int> first,
                                      RowMatrix<T>& known) const {
  const Plan& plan = *joint_.plan;
  const std::ptrdiff_t m = solutions.cols();
  for (int r = 0; r < static_cast<int>(joint_.rows.size()); ++r) {
    const T* const weights = solutions.data() + plan.row_first[at(r)] * m;
    const auto subtract_from = [&](const Dense<T>& c, int signal) {
      const View<T> by = view(c, 0, static_cast<int>(c.rows()), 0, static_cast<int>(c.cols()));
      subtract_product(1, transposed(by), weights, m, known.data() + first[at(signal)] * m);
    };
    for (const Piece& p : joint_.row(r)) {
      if (p.entry >= 0) continue;
      if (!written_out(p)) {
        subtract_from(dense(p, m_, coefficients_), p.signal);
      } else if (p.of != Piece::Left::state) {  // that is part of Y(s)
        by_inputs(p, [&](const Dense<T>& by_u, const SignalTerm& meaning) {
          if (joint_.variable_of[at(meaning.signal)] >= 0) return;
          const int c = meaning.coefficient;
          subtract_from(c < 0 ? by_u : Dense<T>(by_u.lazyProduct(lifted<T>(*coefficients_[at(c)]))),
                        meaning.signal);
        });
      }
    }
  }
}

template <class T>
void JointRows<T>::add_transposed_value(int signal, const T* weights, std::span<const int> first,
                                        RowMatrix<T>& unknowns, RowMatrix<T>& known) const {
  const std::ptrdiff_t m = known.cols(), size = graph_.signals[at(signal)].size * m;
  for (const SignalTerm& meaning : joint_.meaning(signal)) {
    const int v = joint_.variable_of[at(meaning.signal)];
    T* const to = v >= 0 ? unknowns.data() + joint_.plan->first[at(v)] * m
                         : known.data() + first[at(meaning.signal)] * m;
    if (meaning.coefficient >= 0)
      subtract_product(-1, transposed(view(*coefficients_[at(meaning.coefficient)])), weights, m,
                       to);
    else
      for (std::ptrdiff_t i = 0; i < size; ++i) to[i] += weights[i];
  }
}

#define TITOP_INSTANTIATE(T)                                                                \
  template void JointRows<T>::add_transposed_rhs(const RowMatrix<T>&, std::span<const int>, \
                                                 RowMatrix<T>&) const;                      \
  template void JointRows<T>::add_transposed_value(int, const T*, std::span<const int>,     \
                                                   RowMatrix<T>&, RowMatrix<T>&) const;
TITOP_INSTANTIATE(double)
TITOP_COMPLEX_SCALARS(TITOP_INSTANTIATE)
#undef TITOP_INSTANTIATE

}  // namespace titop::solve
