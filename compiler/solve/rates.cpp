#include <limits>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/scalar.hpp>
#include <titop/graph/linalg/index.hpp>

/// xdot and y of given states and inputs: in double, or with unknowns refined in double-double.
namespace titop::detail {
namespace {

using linalg::at;
using solve::RowMatrix;
using Twofold = std::complex<solve::DoubleDouble>;

/// Pivots smaller than this of their terms lose three digits: entries of A, B, C, D, each by
/// itself, are then off by 1e-13 or more, and a response in which they cancel as the pivot did, by
/// as many digits again. Above it this is below 1e-9 of any response.
constexpr double kLossy = 0x1p-10;

/// Steps until the unknowns have 1e-16, at three digits of the factors each.
constexpr int kMostSteps = 8;

RowMatrix<double> rounded(const RowMatrix<Twofold>& m) {
  return m.unaryExpr([](const Twofold& x) { return solve::Scalar<Twofold>::round(x).real(); });
}

/// All signals at one instant in double-double, with factors in double.
class FinerInstant {
 public:
  FinerInstant(const Factored& d, const RowMatrix<double>& known, const RowMatrix<double>& more)
      : d_(d), known_(solve::lifted<Twofold>(known)), rows_(rows_of(d)) {
    RowMatrix<Twofold> rhs = rows_.rhs(known_, d.layout().known_first);
    if (more.size() > 0) rhs += solve::lifted<Twofold>(more);
    unknowns_ = RowMatrix<Twofold>::Zero(rhs.rows(), rhs.cols());
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0; rhs.size() > 0 && step < kMostSteps; ++step) {
      const RowMatrix<double> change = d.factors->solve(rounded(rows_.residual(rhs, unknowns_)));
      unknowns_ += solve::lifted<Twofold>(change);
      const double now = change.cwiseAbs().maxCoeff();
      if (!(2 * now <= before)) break;  // no digit is left, or nothing
      before = now;
    }
  }

  RateColumns rates() const {
    RateColumns result{RowMatrix<double>::Zero(d_.layout().order(), known_.cols()),
                       RowMatrix<double>::Zero(std::ssize(d_.layout().outputs), known_.cols())};
    for (const int i : d_.layout().state_nodes) add_rates(i, result.xdot);
    for (std::size_t o = 0; o < d_.graph().outputs.size(); ++o) add_output(o, result.y);
    return result;
  }

 private:
  solve::JointRows<Twofold> rows_of(const Factored& d) {
    direct_.reserve(d.numbers.blocks.size()), output_.reserve(d.numbers.blocks.size());
    solve::Matrices<Twofold> m;
    for (const auto& block : d.numbers.blocks) {
      m.direct.push_back(&direct_.emplace_back(solve::lifted<Twofold>(block->D)));
      m.output.push_back(&output_.emplace_back(solve::lifted<Twofold>(block->C)));
    }
    return {d.skeleton->stage.graph, d.skeleton->joint, d.numbers.coefficients, std::move(m)};
  }

  RowMatrix<Twofold> value(int signal) const {
    RowMatrix<Twofold> result =
        RowMatrix<Twofold>::Zero(d_.graph().signals[at(signal)].size, known_.cols());
    rows_.add_value(signal, unknowns_, known_, d_.layout().known_first, result.data());
    return result;
  }

  void add_rates(int i, RowMatrix<double>& xdot) const {
    const Node& node = d_.graph().nodes[at(i)];
    const Dynamics& m = *d_.numbers.blocks[at(i)];
    const Eigen::Index first = d_.layout().state_first[at(i)], n = m.A.rows();
    RowMatrix<Twofold> sum = solve::lifted<Twofold>(m.A).lazyProduct(known_.middleRows(first, n));
    for (int s = node.first_signal; s < node.state; ++s)
      if (const Signal& in = d_.graph().signals[at(s)]; in.role == Signal::Role::input && in.active)
        sum += solve::lifted<Twofold>(m.B.middleCols(in.first, in.size)).lazyProduct(value(s));
    xdot.middleRows(first, n) = rounded(sum);
  }

  void add_output(std::size_t o, RowMatrix<double>& y) const {
    const Output& output = d_.graph().outputs[o];
    RowMatrix<Twofold> sum = RowMatrix<Twofold>::Zero(output.size, known_.cols());
    for (std::size_t k = 0; k < output.terms.size(); ++k) {
      const auto& by = *d_.numbers.coefficients[at(d_.skeleton->joint.output_coefficient[o]) + k];
      sum += solve::lifted<Twofold>(by).lazyProduct(value(output.terms[k].signal));
    }
    y.middleRows(d_.layout().output_first[o], output.size) = rounded(sum);
  }

  const Factored& d_;
  std::vector<solve::Dense<Twofold>> direct_, output_;
  RowMatrix<Twofold> known_, unknowns_;
  solve::JointRows<Twofold> rows_;
};

}  // namespace

RateColumns rates(const Factored& d, const RowMatrix<double>& known,
                  const RowMatrix<double>& more) {
  if (d.factors->health().weakest < kLossy) return FinerInstant(d, known, more).rates();
  const Instant now(d, known, more, solve::Refinement::settled);
  return {now.xdot(), now.outputs()};
}

}  // namespace titop::detail
