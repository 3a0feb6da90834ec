#include <limits>
#include <titop/compiler/instant.hpp>
#include <titop/compiler/minimize/sampled.hpp>

/// Entries of a dense model that are nothing but rounding.
namespace titop::detail {

Rounded without_rounding(const SystemData& d, StateSpace m) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  // Rounding is as large as its samples are, but for luck: of four, none is small.
  constexpr int kSamples = 4;
  using solve::RowMatrix;
  const Eigen::Index n = m.A.rows(), all = n + m.B.cols();
  const RowMatrix<double> one = RowMatrix<double>::Identity(all, all), u = one.bottomRows(all - n);
  const RowMatrix<double> x = d.states.expanded(RowMatrix<double>(one.topRows(n)), u);
  RowMatrix<double> known(x.rows() + u.rows(), all);
  known << x, u;
  const Instant now(d, std::move(known));
  RowMatrix<double> of_x = kEpsilon * now.xdot_terms(), of_y = kEpsilon * now.outputs_terms();
  for (int i = 0; i < kSamples; ++i) {
    const Instant off = now.doubt(i);
    of_x = of_x.cwiseMax(off.xdot().cwiseAbs());
    of_y = of_y.cwiseMax(off.outputs().cwiseAbs());
  }
  // The model was written in another order: where that makes a difference, it is rounding.
  RowMatrix<double> x_written(n, all), y_written(m.C.rows(), all);
  x_written << m.A, m.B;
  y_written << m.C, m.D;
  of_x = d.states.kept_rows(of_x).cwiseMax((d.states.kept_rows(now.xdot()) - x_written).cwiseAbs());
  of_y = of_y.cwiseMax((now.outputs() - y_written).cwiseAbs());
  StateSpace rounding{of_x.leftCols(n), of_x.rightCols(all - n),
                      of_y.leftCols(n), of_y.rightCols(all - n),
                      m.states,         m.inputs,
                      m.outputs};
  m.A = modes::cleared(m.A, rounding.A);
  m.B = modes::cleared(m.B, rounding.B);
  m.C = modes::cleared(m.C, rounding.C);
  m.D = modes::cleared(m.D, rounding.D);
  return {std::move(m), std::move(rounding)};
}

}  // namespace titop::detail
