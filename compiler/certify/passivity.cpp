#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <titop/compiler/certify/passivity.hpp>

namespace titop::full {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Per channel: how a wrench there follows from an input, or how an output follows from its motion.
using Weights = std::map<int, MatrixXd>;

void add(Weights& w, int channel, const MatrixXd& m) {
  const auto [place, fresh] = w.try_emplace(channel, m);
  if (!fresh) place->second += m;
}

/// Whether a channel's force is what its block does to the outside: at a parent point and about the
/// axis of a joint. At a child point, of a bushing too, it is what is done to the block.
bool is_outward(const Graph& g, const Channel& c) {
  const auto& specs = g.nodes[at(c.node)].block->interface().channels;
  return c.takes == Takes::accel && specs[at(c.spec)].name != "child";
}

/// What each input does as a force on bodies: along a child's own wrench, against a parent's. Empty
/// for inputs that (also) do something else.
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
      const double sign = is_outward(g, g.channels[at(target.channel)]) ? -1 : 1;
      add(result[t.signal], target.channel,
          sign * (e.part.whole() ? c : MatrixXd(e.part.rows.transpose() * c)));
    }
  for (const auto& [signal, yes] : other) result.erase(signal);
  return result;
}

/// What an output sees of accelerations; empty if it sees anything else.
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
    if (!(off.cwiseAbs().maxCoeff() <= 1e-14 * f.cwiseAbs().maxCoeff())) return false;
  }
  return true;
}

/// First column (or row) of each input (or output) in the declared order.
template <class List>
std::vector<int> first_of(const List& list) {
  std::vector<int> size(list.size()), first(list.size()), result;
  for (const auto& item : list) size[at(item.declared)] = item.size;
  int total = 0;
  for (std::size_t i = 0; i < list.size(); ++i) first[i] = total, total += size[i];
  for (const auto& item : list) result.push_back(first[at(item.declared)]);
  return result;
}

/// Bodies and joints only: no one-way port is driven, no gain stands between motions and forces.
bool is_structure(const Graph& g) {
  for (const Equation& e : g.equations) {
    if (g.signals[at(e.target)].channel < 0) return false;
    for (const Term& t : e.terms)
      for (const Factor& f : t.factors)
        if (g.signals[at(t.signal)].role != Signal::Role::external &&
            (std::holds_alternative<Value>(f) || std::holds_alternative<Matrix>(f)))
          return false;
  }
  return true;
}

/// Smallest eigenvalue of H + H' with its diagonal scaled to 1.
double least(const MatrixXcd& H) {
  if (!H.allFinite()) return -1;
  std::vector<Index> moving;
  for (Index i = 0; i < H.rows(); ++i) {
    if (H(i, i) == 0.0) continue;  // held
    if (!(H(i, i).real() > 0)) return H(i, i).real() / std::abs(H(i, i));
    moving.push_back(i);
  }
  if (moving.empty()) return 1;
  MatrixXcd both = (H + H.adjoint())(moving, moving) / 2;
  const Eigen::VectorXd scale = both.diagonal().real().cwiseSqrt().cwiseInverse();
  both = scale.asDiagonal() * both * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<MatrixXcd>(both, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

}  // namespace

FullCertificate::Passivity check_passivity(const Graph& g, const std::vector<double>& values,
                                           const std::vector<std::complex<double>>& points,
                                           const std::vector<MatrixXcd>& transfers) {
  FullCertificate::Passivity p;
  p.structure = is_structure(g);
  const std::vector<int> columns = first_of(g.inputs), rows = first_of(g.outputs);
  const std::map<int, Weights> force = forces(g, values);
  std::vector<int> in, out;
  for (std::size_t i = 0; i < g.inputs.size(); ++i) {
    const auto f = force.find(g.inputs[i].signal);
    if (f == force.end()) continue;
    for (std::size_t o = 0; o < g.outputs.size(); ++o) {
      if (!dual(f->second, motions(g, g.outputs[o], values))) continue;
      for (int k = 0; k < g.inputs[i].size; ++k) in.push_back(columns[i] + k);
      for (int k = 0; k < g.inputs[i].size; ++k) out.push_back(rows[o] + k);
      ++p.pairs;
      break;
    }
  }
  if (p.pairs == 0) {
    p.why_not = "no output is the acceleration where an input acts as a force";
    return p;
  }
  p.done = true;
  p.least = 1;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double now = least(transfers[k](out, in) / points[k]);
    if (now < p.least) p.least = now, p.where = points[k];
  }
  return p;
}

}  // namespace titop::full
