#include <titop/compiler/solve/holds.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/kernels.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::detail {
namespace {

using solve::Refinement;
using solve::RowMatrix;

}  // namespace

solve::JointRows<double> real_rows(const Skeleton& k, const solve::Numbers& numbers) {
  solve::Matrices<double> m;
  m.direct.reserve(numbers.blocks.size());
  m.output.reserve(numbers.blocks.size());
  for (const auto& block : numbers.blocks) {
    m.direct.push_back(&block->D);
    m.output.push_back(&block->C);
  }
  return {k.stage.graph, k.joint, numbers.coefficients, std::move(m)};
}

Instant::Instant(const Factored& data, RowMatrix<double> known, const RowMatrix<double>& more,
                 Refinement refinement)
    : now_{data, real_rows(*data.skeleton, data.numbers), std::move(known)}, rhs_(now_.rhs()) {
  if (more.size() > 0) rhs_ += more;
  now_.unknowns = refinement == Refinement::none
                      ? data.factors->solve(rhs_)
                      : solve::settled(now_.rows, *data.factors, rhs_, to_rounding_);
}

bool Instant::holds() const {
  return to_rounding_ || detail::holds(now_, rhs_, solve::Scalar<double>::epsilon());
}

RowMatrix<double> Instant::values(std::span<const int> first) const {
  return now_.rows.values(now_.unknowns, now_.known, now_.data.layout().known_first, first);
}

namespace {

RowMatrix<double> zeros_of_xdot(const InstantIn<double>& now) {
  return RowMatrix<double>::Zero(now.data.layout().order(), now.known.cols());
}

RowMatrix<double> zeros_of_outputs(const InstantIn<double>& now) {
  return RowMatrix<double>::Zero(std::ssize(now.data.layout().outputs), now.known.cols());
}

/// Adds the magnitudes of products' terms.
auto magnitudes_to(RowMatrix<double>& to) {
  return [&to](Eigen::Index first, const auto& m, const double* x) {
    const Eigen::Map<const RowMatrix<double>> value(x, m.cols(), to.cols());
    to.middleRows(first, m.rows()).noalias() += m.cwiseAbs() * value.cwiseAbs();
  };
}

}  // namespace

RowMatrix<double> Instant::xdot() const {
  RowMatrix<double> result = zeros_of_xdot(now_);
  now_.products_of_xdot([&](Eigen::Index first, const auto& m, const double* x) {
    solve::add_dense_product(m.rows(), m.cols(), m.data(), x, result.cols(),
                             result.data() + first * result.cols());
  });
  return result;
}

RowMatrix<double> Instant::xdot_terms() const {
  RowMatrix<double> result = zeros_of_xdot(now_);
  now_.products_of_xdot(magnitudes_to(result));
  return result;
}

RowMatrix<double> Instant::outputs() const {
  RowMatrix<double> y = zeros_of_outputs(now_);
  now_.products_of_outputs([&](Eigen::Index first, const auto& m, const double* x) {
    y.middleRows(first, m.rows()).noalias() +=
        m * Eigen::Map<const RowMatrix<double>>(x, m.cols(), y.cols());
  });
  return y;
}

RowMatrix<double> Instant::outputs_terms() const {
  RowMatrix<double> y = zeros_of_outputs(now_);
  now_.products_of_outputs(magnitudes_to(y));
  return y;
}

Instant Instant::doubt(int sample) const {
  RowMatrix<double> magnitudes, left = now_.rows.residual(rhs_, now_.unknowns, &magnitudes);
  return off_by(std::move(left), std::move(magnitudes), sample);
}

Instant Instant::doubt_of_vectors(int sample) const {
  RowMatrix<double> lengths = now_.unknowns.cwiseAbs(), magnitudes;
  const solve::Plan& plan = *now_.data.skeleton->joint.plan;
  for (std::size_t v = 0; v < plan.first.size(); ++v)
    for (int i = 0, n = plan.structure.variable_unit[v]; i < plan.structure.variable_size[v];
         i += n) {
      auto part = lengths.middleRows(plan.first[v] + i, n);
      part.rowwise() = part.colwise().maxCoeff().eval();
    }
  now_.rows.residual(rhs_, lengths, &magnitudes);
  return off_by(now_.rows.residual(rhs_, now_.unknowns, nullptr), std::move(magnitudes), sample);
}

Instant Instant::rounding() const {
  RowMatrix<double> magnitudes, off = now_.rows.residual(rhs_, now_.unknowns, &magnitudes);
  off.setZero();
  return off_by(std::move(off), std::move(magnitudes), 0);
}

Instant Instant::off_by(RowMatrix<double> off, RowMatrix<double> magnitudes, int sample) const {
  // Terms of known signals that cancel in the right-hand sides, as momenta of wheels that sum to 0.
  magnitudes += (now_.rows.rhs_terms(now_.known, now_.data.layout().known_first) - rhs_.cwiseAbs())
                    .cwiseMax(0);
  SteadyRandom random(sample);
  for (Eigen::Index i = 0; i < off.rows(); ++i)  // one number for all columns, in whatever order
    off.row(i) += random.unit() * solve::Scalar<double>::epsilon() * magnitudes.row(i);
  Instant result(*this);
  result.now_.known.setZero();
  result.now_.unknowns = now_.data.factors->solve(off);
  result.rhs_ = std::move(off), result.to_rounding_ = false;
  return result;
}

}  // namespace titop::detail
