#include <fmt/format.h>

#include <optional>
#include <titop/compiler/index_reduction/proper.hpp>
#include <titop/compiler/solve/blame.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/solve/samples.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/some_names.hpp>
#include <titop/graph/support/steady_random.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;
using linalg::kEpsilon;
using solve::RowMatrix;

/// Coefficients with x = T xi + sum of R_j u^(j): y = ... + P_j u^(j).
struct Expansion {
  std::vector<MatrixXd> R;       ///< blocks' states x inputs
  std::vector<MatrixXd> shifts;  ///< of the kept states alone
  std::vector<MatrixXd> P;       ///< outputs x inputs
};

/// Every entry off by about one rounding of the largest of its block's states.
void shake(const Factored& d, SteadyRandom& random, MatrixXd& states) {
  for (const int i : d.layout().state_nodes) {
    auto own = states.middleRows(d.layout().state_first[at(i)], d.numbers.blocks[at(i)]->A.rows());
    const Eigen::RowVectorXd largest = own.cwiseAbs().colwise().maxCoeff();
    for (Index j = 0; j < own.cols(); ++j)
      for (Index k = 0; k < own.rows(); ++k) own(k, j) += kEpsilon * largest(j) * random.unit();
  }
}

/// Perturbs every entry by about one rounding of its terms.
void shake(SteadyRandom& random, const RowMatrix<double>& terms, RowMatrix<double>& sums) {
  for (Index i = 0; i < sums.size(); ++i)
    sums.data()[i] += kEpsilon * terms.data()[i] * random.unit();
}

/// Rates and outputs of these states and inputs; with a sample: perturbed by rounding, as in
/// another order of operations.
RateColumns rates_at(const Factored& d, RowMatrix<double> known, const RowMatrix<double>& forcing,
                     std::optional<int> sample, SteadyRandom& random) {
  const Instant now(d, std::move(known), forcing);
  RateColumns r{now.xdot(), now.outputs()};
  if (!sample) return r;
  const Instant off = now.doubt_of_vectors(*sample);
  r.xdot += off.xdot(), r.y += off.outputs();
  shake(random, now.xdot_terms(), r.xdot);
  shake(random, now.outputs_terms(), r.y);
  return r;
}

/// With xi' = A xi + E_0 u the kept states are xi + E_1 u + E_2 u' + ..., from the highest on down:
/// E_j is the rate due to E_(j+1), its dependent states, and u^(j). With a sample every number is
/// perturbed by about one rounding.
Expansion expand(const Factored& d, const InputDerivatives& v, std::optional<int> sample = {}) {
  const Index n = d.layout().order();
  const auto inputs = static_cast<Index>(d.layout().inputs.size());
  const std::size_t most = std::max(v.by_input.size(), v.forcing.size() + 1);
  Expansion e{std::vector<MatrixXd>(most), std::vector<MatrixXd>(most),
              std::vector<MatrixXd>(most)};
  SteadyRandom random(sample.value_or(0));
  MatrixXd shift = MatrixXd::Zero(d.states.order(), inputs);
  for (std::size_t j = most; j-- > 0;) {
    e.shifts[j] = shift;
    e.R[j] = d.states.expanded(shift);
    if (j < v.by_input.size()) e.R[j] += v.by_input[j];
    if (sample) shake(d, random, e.R[j]);
    RowMatrix<double> known = RowMatrix<double>::Zero(n + inputs, inputs);
    known.topRows(n) = e.R[j];
    if (j == 0) known.bottomRows(inputs).setIdentity();
    const RateColumns r = rates_at(
        d, std::move(known),
        j > 0 && j <= v.forcing.size() ? v.forcing[j - 1] : RowMatrix<double>(), sample, random);
    shift = d.states.kept_rows(MatrixXd(r.xdot));
    e.P[j] = r.y;
  }
  return e;
}

/// All P_j side by side.
MatrixXd all_outputs(const Expansion& e) {
  const Index inputs = e.P.front().cols();
  MatrixXd all(e.P.front().rows(), inputs * std::ssize(e.P));
  for (Index j = 0; j < std::ssize(e.P); ++j) all.middleCols(inputs * j, inputs) = e.P[at(j)];
  return all;
}

const Hidden* first_with(const InputDerivatives& v, Index input) {
  for (const Hidden& c : v.constraints)
    for (const auto& h : c.h)
      if (h(input) != 0) return &c;
  return nullptr;
}

Mistake improper(const Skeleton& k, const Factored& d, const Hidden* c, Index output, Index input,
                 std::size_t derivatives) {
  Mistake m = c ? solve::massless(k.stage, c->rows) : Mistake{Code::improper, {}, {}, {}};
  m.message = fmt::format("from {} to {} the transfer would need {} derivative{} of {}",
                          d.layout().inputs[at(input)], d.layout().outputs[at(output)], derivatives,
                          derivatives == 1 ? "" : "s", d.layout().inputs[at(input)]);
  return m;
}

void refuse_derivatives(const Skeleton& k, const Factored& d, const InputDerivatives& v,
                        const Expansion& e) {
  const MatrixXd all = all_outputs(e);
  const Index inputs = e.P.front().cols();
  if (all.rightCols(all.cols() - inputs).isZero(0)) return;
  const MatrixXd clear = cleared(all, largest_of_samples([&](int sample) {
                                   return MatrixXd(all_outputs(expand(d, v, sample)) - all);
                                 }));
  const auto derivatives = [&](Index i, Index j) {
    for (std::size_t n = e.P.size(); n-- > 1;)
      if (clear(i, inputs * static_cast<Index>(n) + j) != 0) return n;
    return std::size_t{0};
  };
  std::vector<Mistake> mistakes;  // the first scalar pair of each input and output
  const Graph& g = d.graph();
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (std::size_t u = 0; u < g.inputs.size(); ++u) {
      const Index i0 = d.layout().output_first[o], j0 = d.layout().input_first[u];
      std::optional<Mistake> first;
      for (Index i = i0; i < i0 + g.outputs[o].size && !first; ++i)
        for (Index j = j0; j < j0 + g.inputs[u].size && !first; ++j)
          if (const std::size_t n = derivatives(i, j); n > 0)
            first = improper(k, d, first_with(v, j), i, j, n);
      if (first) mistakes.push_back(std::move(*first));
    }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

}  // namespace

void make_proper(Skeleton& k, Factored& d, const InputDerivatives& v) {
  bool by_inputs = false;
  for (const MatrixXd& m : v.by_input) by_inputs = by_inputs || !m.isZero(0);
  for (const auto& m : v.forcing) by_inputs = by_inputs || !m.isZero(0);
  if (!by_inputs) return;
  Expansion e = expand(d, v);
  refuse_derivatives(k, d, v, e);
  std::vector<std::string> names;
  for (Index i = 0; i < e.shifts[0].rows(); ++i)
    if (!e.shifts[0].row(i).isZero(0)) names.push_back(d.state_names()[at(i)]);
  if (!names.empty())
    d.notes.push_back(
        {Note::Kind::info, "reduce",
         fmt::format(
             "states from which a multiple of the inputs at points without mass is subtracted: {}",
             some_names(names))});
  d.states.set_inputs(std::move(e.R[0]), std::move(e.shifts));
}

}  // namespace titop::detail
