#include <limits>
#include <titop/compiler/instant.hpp>
#include <titop/compiler/minimize/sampled.hpp>

/// Entries of a dense model that are nothing but rounding.
namespace titop::detail {

namespace {

using Eigen::MatrixXd;
using solve::RowMatrix;

/// All states and inputs at 1, one after the other.
Instant one_by_one(const SystemData& d, const StateSpace& m) {
  const Eigen::Index n = m.A.rows(), all = n + m.B.cols();
  const RowMatrix<double> one = RowMatrix<double>::Identity(all, all), u = one.bottomRows(all - n);
  const RowMatrix<double> x = d.states.expanded(RowMatrix<double>(one.topRows(n)), u);
  RowMatrix<double> known(x.rows() + u.rows(), all);
  known << x, u;
  return Instant(d, std::move(known));
}

/// What rounding does to xdot, of all blocks' states, and to y.
StateSpace rounding(const SystemData& d, const StateSpace& m, const Instant& now) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  // Rounding is as large as its samples are, but for luck: of four, none is small.
  constexpr int kSamples = 4;
  RowMatrix<double> of_x = kEpsilon * now.xdot_terms(), of_y = kEpsilon * now.outputs_terms();
  for (int i = 0; i < kSamples; ++i) {
    const Instant off = now.doubt(i);
    of_x = of_x.cwiseMax(off.xdot().cwiseAbs());
    of_y = of_y.cwiseMax(off.outputs().cwiseAbs());
  }
  of_x = d.states.kept_rows(of_x);
  const Eigen::Index n = m.A.cols(), inputs = m.B.cols();
  return {of_x.leftCols(n), of_x.rightCols(inputs),
          of_y.leftCols(n), of_y.rightCols(inputs),
          m.states,         m.inputs,
          m.outputs};
}

/// Where the model, which was written in another order, differs from the factors, it is rounding.
void add_written(MatrixXd& of, const MatrixXd& now, const MatrixXd& written) {
  of = of.cwiseMax((now - written).cwiseAbs());
}

}  // namespace

StateSpace rounding_of(const SystemData& d, const StateSpace& dense) {
  return rounding(d, dense, one_by_one(d, dense));
}

Rounded without_rounding(const SystemData& d, StateSpace m) {
  const Instant now = one_by_one(d, m);
  StateSpace r = rounding(d, m, now);
  const RowMatrix<double> xdot = d.states.kept_rows(now.xdot()), y = now.outputs();
  const Eigen::Index n = m.A.cols(), inputs = m.B.cols();
  add_written(r.A, xdot.leftCols(n), m.A);
  add_written(r.B, xdot.rightCols(inputs), m.B);
  add_written(r.C, y.leftCols(n), m.C);
  add_written(r.D, y.rightCols(inputs), m.D);
  m.A = modes::cleared(m.A, r.A);
  m.B = modes::cleared(m.B, r.B);
  m.C = modes::cleared(m.C, r.C);
  m.D = modes::cleared(m.D, r.D);
  return {std::move(m), std::move(r)};
}

}  // namespace titop::detail
