#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>
#include <span>
#include <titop/compiler/certificate/doubt.hpp>
#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/certificate/surroundings.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using linalg::at;
using solve::RowMatrix;

/// Relative error of some entries of one unit, from their errors and the size around each of them
/// (see Surroundings).
template <class Around>
double lost(std::span<const double> value, std::span<const double> off, Around around) {
  double largest = 0, change = 0;
  for (const double v : value) largest = std::max(largest, std::abs(v));
  for (const double v : off) change = std::abs(v) <= change ? change : std::abs(v);  // NaN too
  if (change <= kWarn * largest || change <= kUnderflow) return 0;
  for (std::size_t i = 0; i < value.size(); ++i)  // 0 up to rounding?
    if (!(std::max(std::abs(value[i]), std::abs(off[i])) <= kLeftOfZero * around(i)))
      return change < largest ? change / largest : 1;
  return 0;
}

/// The largest of all entries of a signal or an output, of which `unit` neighbours share one.
template <class Around>
double most_lost(std::span<const double> value, std::span<const double> off, std::size_t unit,
                 Around around) {
  double worst = 0;
  for (std::size_t first = 0; first < value.size(); first += unit)
    worst = std::max(
        worst, lost(value.subspan(first, unit), off.subspan(first, unit),
                    [&](std::size_t i) { return around(static_cast<Eigen::Index>(first + i)); }));
  return worst;
}

/// Digits may be lost of an input of a block with states.
bool moves_in_doubt(const Factored& d, const Signals& signals, const Instant& change) {
  const Graph& g = d.graph();
  Surroundings around(d, signals.unknowns);
  boost::container::small_vector<double, 6> off;
  for (std::size_t i = 0; i < g.nodes.size(); ++i)
    for (int k = g.nodes[i].first_signal; d.layout().state_first[i] >= 0 && k < g.nodes[i].state;
         ++k) {
      const Signal& in = g.signals[at(k)];
      if (in.role != Signal::Role::input || !in.active) continue;
      const std::span value(signals.values.data() + signals.first[at(k)], at(in.size));
      off.assign(value.size(), 0);
      change.add_value(k, off.data());
      if (value.size() == 1 && std::abs(off[0]) <= kWarn * std::abs(value[0])) continue;  // as most
      if (most_lost(value, {off.data(), off.size()}, at(entries_per_unit(in)),
                    [&](Eigen::Index entry) { return around.size(k, entry); }) > 0)
        return true;
    }
  return false;
}

/// Size around a row of output o: of the signals in its sum.
double size_around_output(const Factored& d, Surroundings& around, std::size_t o,
                          Eigen::Index row) {
  const std::vector<Term>& terms = d.graph().outputs[o].terms;
  double sum = 0;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const RowMatrix<double>& c =
        *d.numbers.coefficients[at(d.skeleton->joint.output_coefficient[o]) + k];
    for (Eigen::Index j = 0; j < c.cols(); ++j)
      if (c(row, j) != 0) sum += std::abs(c(row, j)) * around.size(terms[k].signal, j);
  }
  return sum;
}

}  // namespace

double lost_of_outputs(const Factored& d, const RowMatrix<double>& unknowns,
                       const RowMatrix<double>& y, const RowMatrix<double>& off) {
  Surroundings around(d, unknowns);
  double worst = 0;
  for (std::size_t o = 0; o < d.graph().outputs.size(); ++o) {
    const int first = d.layout().output_first[o];
    const std::size_t size = at(d.graph().outputs[o].size);
    worst = std::max(
        worst, most_lost({y.data() + first, size}, {off.data() + first, size}, size == 6 ? 3 : 1,
                         [&](Eigen::Index row) { return size_around_output(d, around, o, row); }));
  }
  return worst;
}

bool digits_in_doubt(const Factored& d, const Instant& now, const Signals& signals) {
  const Instant change = now.doubt();
  return moves_in_doubt(d, signals, change) ||
         lost_of_outputs(d, now.unknowns(), now.outputs(), change.outputs()) > 0;
}

}  // namespace titop::detail
