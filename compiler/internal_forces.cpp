#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/system_data.hpp>

/// Closed chains that hold more than once: which internal forces the motion does not determine.
namespace titop::detail {
namespace {

using solve::RowMatrix;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr double kMoves = 1e-7;  ///< of the largest internal force; rounding gives 1e-12

/// All signals for a unit wrench in every released direction, one column each.
class SelfStress {
 public:
  SelfStress(const Skeleton& k, const SystemData& d)
      : g_(k.stage.graph), first_(k.layout.known_first) {
    std::vector<int> begin;
    Eigen::Index columns = 0;
    for (int r = 0; r < static_cast<int>(k.joint.rows.size()); ++r) {
      const int e = k.stage.rows[at(k.joint.rows[at(r)])].equation;
      if (e < 0 || k.stage.origins[at(e)].of != Origin::Of::released) continue;
      begin.push_back(r);
      columns += k.joint.plan->structure.row_size[at(r)];
    }
    RowMatrix<double> rhs = RowMatrix<double>::Zero(k.joint.plan->unknowns, columns);
    Eigen::Index column = 0;
    for (const int r : begin)
      for (int i = 0; i < k.joint.plan->structure.row_size[at(r)]; ++i)
        rhs(k.joint.plan->row_first[at(r)] + i, column++) = 1;
    known_ = RowMatrix<double>::Zero(
        k.layout.order() + static_cast<Eigen::Index>(k.layout.inputs.size()), columns);
    unknowns_ = d.factors->solve(rhs);
    rows_ = std::make_unique<const solve::JointRows<double>>(real_rows(k, d.numbers));
    for (int s = 0; s < static_cast<int>(g_.signals.size()); ++s)
      if (columns > 0 && g_.signals[at(s)].quantity == Quantity::force && g_.signals[at(s)].active)
        largest_ = std::max(largest_, value(s).cwiseAbs().maxCoeff());
  }

  bool empty() const { return known_.cols() == 0; }

  RowMatrix<double> value(int signal) const {
    RowMatrix<double> v = RowMatrix<double>::Zero(g_.signals[at(signal)].size, known_.cols());
    if (g_.signals[at(signal)].role != Signal::Role::state)
      rows_->add_value(signal, unknowns_, known_, first_, v);
    return v;
  }

  /// Accelerations and states follow the motion, which is determined: what they show is rounding.
  bool moves(const RowMatrix<double>& v, int signal) const {
    const Quantity q = g_.signals[at(signal)].quantity;
    return (q == Quantity::force || q == Quantity::plain) && v.size() > 0 &&
           v.cwiseAbs().maxCoeff() > kMoves * largest_;
  }

 private:
  const Graph& g_;
  const std::vector<int>& first_;
  std::unique_ptr<const solve::JointRows<double>> rows_;
  RowMatrix<double> known_, unknowns_;
  double largest_ = 0;
};

struct Judge {
  const Skeleton& k;
  const SystemData& d;
  const SelfStress& stress;
  std::vector<Mistake> mistakes = {};
  std::vector<Note> notes = {};

  void found(const std::string& reader, int signal, const std::source_location& where) {
    const Graph& g = k.stage.graph;
    std::string joints;
    for (const Released& r : k.stage.released) {
      const std::string name = channel_name(g, r.channel);
      if (joints.find(name) == std::string::npos) joints += (joints.empty() ? "" : ", ") + name;
    }
    notes.push_back(
        {Note::Kind::warning, "solve",
         fmt::format("{} reads {}, an internal force that motion does not determine: the "
                     "smallest wrench at {} is taken",
                     reader, name_of(g, signal), joints)});
    mistakes.push_back(
        {Code::kinematic_loop,
         fmt::format("{} reads {}, an internal force that is not determined", reader,
                     name_of(g, signal)),
         {"written at " + to_string(where),
          fmt::format("the chain is held more than once; released: {}", joints)},
         "make a body of the chain flexible, let the joint leave free what the others hold already "
         "(.linear, .angular, .along(r)), or take the minimal-norm ones: "
         "Options{.internal_forces = InternalForces::minimal_norm}"});
  }

  void outputs() {
    const Graph& g = k.stage.graph;
    for (std::size_t o = 0; o < g.outputs.size(); ++o)
      for (std::size_t t = 0; t < g.outputs[o].terms.size(); ++t) {
        const int signal = g.outputs[o].terms[t].signal;
        const auto& c = *d.numbers.coefficients[at(k.joint.output_coefficient[o]) + t];
        if (!stress.moves(c * stress.value(signal), signal)) continue;
        found("output " + g.outputs[o].name, signal, g.outputs[o].where);
        break;
      }
  }

  void controllers() {
    const Graph& g = k.stage.graph;
    for (int s = 0; s < static_cast<int>(g.signals.size()); ++s) {
      const Signal& in = g.signals[at(s)];
      if (in.role != Signal::Role::input || in.channel >= 0 || !in.active ||
          g.nodes[at(in.node)].lowered || !stress.moves(stress.value(s), s))
        continue;
      found(name_of(g, s), s, g.nodes[at(in.node)].where);
    }
  }
};

}  // namespace

void judge_internal_forces(Skeleton& k, const SystemData& d) {
  if (k.stage.released.empty()) return;
  const SelfStress stress(k, d);
  if (stress.empty()) return;
  Judge judge{k, d, stress};
  judge.outputs();
  judge.controllers();
  if (!judge.mistakes.empty() && k.options.internal_forces == InternalForces::refuse)
    throw Error(std::move(judge.mistakes));
  k.stage.notes.insert(k.stage.notes.end(), judge.notes.begin(), judge.notes.end());
}

}  // namespace titop::detail
