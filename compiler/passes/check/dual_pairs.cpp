#include <algorithm>
#include <map>
#include <titop/compiler/passes/check/dual_pairs.hpp>
#include <titop/graph/declared.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::passes {
namespace {

using Eigen::MatrixXd;

using linalg::at;

/// Per channel: how a wrench there follows from an input, or how an output follows from its motion.
using Weights = std::map<int, MatrixXd>;

void add(Weights& w, int channel, const MatrixXd& m) {
  const auto [place, fresh] = w.try_emplace(channel, m);
  if (!fresh) place->second += m;
}

/// Each input as forces on bodies: along a child's own wrench, against a parent's. Empty for inputs
/// that (also) have another effect.
std::map<int, Weights> forces(const Graph& g, ParameterValues values) {
  std::map<int, Weights> result;
  std::map<int, bool> other;
  for (const Equation& e : g.equations)
    for (const Term& t : e.terms) {
      if (g.signals[at(t.signal)].role != Signal::Role::external) continue;
      const Signal& target = g.signals[at(e.target)];
      if (target.channel < 0 || e.target != g.channels[at(target.channel)].force) {
        other[t.signal] = true;
        continue;
      }
      const MatrixXd c = coefficient(g, t, values);
      const double sign = is_outward(g, target.channel) ? -1 : 1;
      add(result[t.signal], target.channel,
          sign * (e.part.whole() ? c : MatrixXd(e.part.rows().transpose() * c)));
    }
  for (const auto& [signal, yes] : other) result.erase(signal);
  return result;
}

/// An output as a combination of accelerations; empty if it reads anything else.
Weights motions(const Graph& g, const Output& o, ParameterValues values) {
  Weights result;
  for (const Term& t : o.terms) {
    const Signal& s = g.signals[at(t.signal)];
    if (t.of == Term::Of::position || t.of == Term::Of::rate || t.of == Term::Of::reaction ||
        s.channel < 0 || g.channels[at(s.channel)].accel != t.signal)
      return {};
    add(result, s.channel, coefficient(g, t, values));
  }
  return result;
}

bool dual(const Weights& force, const Weights& motion) {
  if (force.size() != motion.size()) return false;
  for (const auto& [channel, f] : force) {
    const auto found = motion.find(channel);
    if (found == motion.end() || found->second.rows() != f.cols()) return false;
    const MatrixXd off = found->second - f.transpose();
    if (!(off.cwiseAbs().maxCoeff() <= linalg::kProductRounding * f.cwiseAbs().maxCoeff()))
      return false;
  }
  return true;
}

void add_pair(const Input& input, int column, int row, DualPairs& pairs) {
  ++pairs.count;
  for (int k = 0; k < input.size; ++k) {
    pairs.in.push_back(column + k);
    pairs.out.push_back(row + k);
  }
  const int each = input.size % 3 == 0 ? 3 : 1;
  pairs.sizes.insert(pairs.sizes.end(), at(input.size / each), each);
}

}  // namespace

DualPairs dual_pairs(const Graph& g, ParameterValues values) {
  DualPairs pairs;
  const std::vector<int> columns = detail::first_as_declared(g.inputs),
                         rows = detail::first_as_declared(g.outputs);
  const std::map<int, Weights> force = forces(g, values);
  for (std::size_t i = 0; i < g.inputs.size(); ++i) {
    const auto f = force.find(g.inputs[i].signal);
    if (f == force.end()) continue;
    for (std::size_t o = 0; o < g.outputs.size(); ++o)
      if (dual(f->second, motions(g, g.outputs[o], values))) {
        add_pair(g.inputs[i], columns[i], rows[o], pairs);
        break;
      }
  }
  return pairs;
}

}  // namespace titop::passes
