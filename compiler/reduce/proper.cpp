#include <fmt/format.h>

#include <titop/compiler/evaluate.hpp>
#include <titop/compiler/reduce/proper.hpp>
#include <titop/compiler/solve/blame.hpp>
#include <titop/compiler/some_names.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using solve::RowMatrix;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

constexpr double kSeen = 1e-9;  ///< of what makes the output up: less is rounding

/// What x = T xi + sum of R_j u^(j) gives: y = ... + P_j u^(j).
struct Expansion {
  std::vector<MatrixXd> R;       ///< blocks' states x inputs
  std::vector<MatrixXd> shifts;  ///< of the kept states alone
  std::vector<MatrixXd> P;       ///< outputs x inputs
};

/// With xi' = A xi + E_0 u the kept states are xi + E_1 u + E_2 u' + ..., from the highest on down:
/// E_j is the rate that E_(j+1), what follows from it, and u^(j) itself make.
Expansion expand(const SystemData& d, const Derivatives& v) {
  const Index n = d.layout().order();
  const auto inputs = static_cast<Index>(d.layout().inputs.size());
  const std::size_t most = std::max(v.by_input.size(), v.forcing.size() + 1);
  Expansion e{std::vector<MatrixXd>(most), std::vector<MatrixXd>(most),
              std::vector<MatrixXd>(most)};
  MatrixXd shift = MatrixXd::Zero(d.states.order(), inputs);
  for (std::size_t j = most; j-- > 0;) {
    e.shifts[j] = shift;
    e.R[j] = d.states.expanded(shift);
    if (j < v.by_input.size()) e.R[j] += v.by_input[j];
    RowMatrix<double> known = RowMatrix<double>::Zero(n + inputs, inputs);
    known.topRows(n) = e.R[j];
    if (j == 0) known.bottomRows(inputs).setIdentity();
    const Rates r =
        rates(d, known, j > 0 && j <= v.forcing.size() ? v.forcing[j - 1] : RowMatrix<double>());
    shift = d.states.kept_rows(MatrixXd(r.xdot));
    e.P[j] = r.y;
  }
  return e;
}

/// Sum of the magnitudes that make every output up at s, outputs x inputs; 0 where double does not
/// tell.
MatrixXd magnitudes(const SystemData& d, std::complex<double> s) {
  using T = std::complex<double>;
  const Graph& g = d.graph();
  const auto inputs = static_cast<Index>(d.layout().inputs.size());
  MatrixXd size = MatrixXd::Zero(static_cast<Index>(d.layout().outputs.size()), inputs);
  std::unique_ptr<const Evaluation<T>> point;
  try {
    point = std::make_unique<const Evaluation<T>>(d, s, RowMatrix<T>::Identity(inputs, inputs));
  } catch (const Error&) {
    return size;
  }
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    for (std::size_t t = 0; t < g.outputs[o].terms.size(); ++t)
      size.middleRows(d.layout().output_first[o], g.outputs[o].size) +=
          d.numbers.coefficients[at(d.skeleton->joint.output_coefficient[o]) + t]->cwiseAbs() *
          point->value(g.outputs[o].terms[t].signal).cwiseAbs();
  return size;
}

const Hidden* first_with(const Derivatives& v, Index input) {
  for (const Hidden& c : v.constraints)
    for (const auto& h : c.h)
      if (h(input) != 0) return &c;
  return nullptr;
}

Mistake improper(const Skeleton& k, const SystemData& d, const Hidden* c, Index output, Index input,
                 std::size_t derivatives) {
  Mistake m = c ? solve::massless(k.stage, c->rows) : Mistake{Code::improper, {}, {}, {}};
  m.message = fmt::format("from {} to {} the transfer would need {} derivative{} of {}",
                          d.layout().inputs[at(input)], d.layout().outputs[at(output)], derivatives,
                          derivatives == 1 ? "" : "s", d.layout().inputs[at(input)]);
  return m;
}

void refuse_derivatives(const Skeleton& k, const SystemData& d, const Derivatives& v,
                        const Expansion& e) {
  bool any = false;
  for (std::size_t j = 1; j < e.P.size(); ++j) any = any || !e.P[j].isZero(0);
  if (!any) return;
  const std::complex<double> s = pick_s(d);
  const MatrixXd size = magnitudes(d, s);
  const auto derivatives = [&](Index i, Index j) {
    for (std::size_t n = e.P.size(); n-- > 1;)
      if (std::abs(e.P[n](i, j)) * std::pow(std::abs(s), n) > kSeen * size(i, j)) return n;
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

void make_proper(Skeleton& k, SystemData& d, const Derivatives& v) {
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
    k.stage.notes.push_back(
        {Note::Kind::info, "reduce",
         fmt::format("states less a multiple of the inputs that act where nothing has mass: {}",
                     some_names(names))});
  d.states.set_inputs(std::move(e.R[0]), std::move(e.shifts));
}

}  // namespace titop::detail
