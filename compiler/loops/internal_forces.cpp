#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/loops/internal_forces.hpp>
#include <titop/compiler/solve/factored.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/steady_random.hpp>

/// Over-constrained closed chains: internal forces that the motion does not determine.
namespace titop::detail {
namespace {

using linalg::at;
using solve::RowMatrix;

constexpr double kMoves = 1e-7;  ///< relative to cancelling terms; rounding gives 1e-12
constexpr double kZero = 1e-10;  ///< of the largest internal force: zero

/// Rounding moves light bodies a little, and through them a heavy one: its mass times that
/// acceleration may be large compared with the forces, in double. A step of refinement reduces it
/// by a factor of about rounding times the ratio of the masses: with this many steps ratios of 1e12
/// do no harm. True motion remains.
constexpr int kRefinements = 8;

/// More released directions than these are judged by as many sums of all of them.
constexpr std::size_t kSums = 32;

/// Right-hand sides: a unit wrench in each of these rows or, for many rows, sums of all with random
/// factors within +-1. A signal that depends on one wrench depends on every sum, except by
/// coincidence in all of them.
RowMatrix<double> wrenches(int unknowns, const std::vector<int>& rows) {
  const bool each = rows.size() <= kSums;
  RowMatrix<double> rhs =
      RowMatrix<double>::Zero(unknowns, static_cast<Eigen::Index>(std::min(rows.size(), kSums)));
  SteadyRandom random;
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (Eigen::Index j = 0; j < rhs.cols(); ++j)
      if (!each)
        rhs(rows[k], j) = random.next();
      else if (j == static_cast<Eigen::Index>(k))
        rhs(rows[k], j) = 1;
  return rhs;
}

/// One term of a sum.
struct ForceTerm {
  int signal = -1;
  Eigen::MatrixXd c;
};

/// All signals for unit wrenches in the released directions.
class SelfStress {
 public:
  SelfStress(const Skeleton& k, const Factored& d)
      : g_(k.stage.graph), first_(k.layout.known_first), factors_(*d.factors) {
    std::vector<int> released;  // scalar rows
    for (int r = 0; r < static_cast<int>(k.joint.rows.size()); ++r) {
      const int e = k.stage.rows[at(k.joint.rows[at(r)])].equation;
      if (e < 0 || k.stage.origins[at(e)].of != Origin::Of::released) continue;
      for (int i = 0; i < k.joint.plan->structure.row_size[at(r)]; ++i)
        released.push_back(k.joint.plan->row_first[at(r)] + i);
    }
    directions_ = released.size();
    rhs_ = wrenches(k.joint.plan->unknowns, released);
    const Eigen::Index columns = rhs_.cols();
    known_ = RowMatrix<double>::Zero(
        k.layout.order() + static_cast<Eigen::Index>(k.layout.inputs.size()), columns);
    unknowns_ = d.factors->solve(rhs_);
    rows_ = std::make_unique<const solve::JointRows<double>>(real_rows(k, d.numbers));
    for (int s = 0; s < static_cast<int>(g_.signals.size()); ++s)
      if (columns > 0 && g_.signals[at(s)].quantity == Quantity::force && g_.signals[at(s)].active)
        largest_ = std::max(largest_, value(s).cwiseAbs().maxCoeff());
  }

  bool empty() const { return directions_ == 0; }
  bool summed() const { return directions_ > kSums; }
  std::size_t directions() const { return directions_; }

  /// One step of iterative refinement.
  void refine() { unknowns_ += factors_.solve(rows_->residual(rhs_, unknowns_)); }

  RowMatrix<double> value(int signal) const {
    RowMatrix<double> v = RowMatrix<double>::Zero(g_.signals[at(signal)].size, known_.cols());
    if (g_.signals[at(signal)].role != Signal::Role::state)
      rows_->add_value(signal, unknowns_, known_, first_, v.data());
    return v;
  }

  /// The first signal by which a sum depends on internal forces, -1 if it does not: the sum must be
  /// above the rounding of its cancelling terms. Accelerations and states follow the motion and do
  /// not count.
  int shown_by(const std::vector<ForceTerm>& sum) const {
    if (sum.empty()) return -1;
    const Eigen::Index rows = sum.front().c.rows(), columns = known_.cols();
    // In a sum, the effect of one wrench is compared with that of all.
    const double moves = kMoves / std::sqrt(summed() ? static_cast<double>(directions_) : 1);
    RowMatrix<double> total = RowMatrix<double>::Zero(rows, columns), size = total;
    int first = -1;
    for (const ForceTerm& share : sum) {
      const Quantity q = g_.signals[at(share.signal)].quantity;
      if (q != Quantity::force && q != Quantity::plain) continue;
      const RowMatrix<double> v = value(share.signal);
      total += share.c * v;
      size += moves * (share.c.cwiseAbs() * v.cwiseAbs());
      size.colwise() += kZero * largest_ * share.c.cwiseAbs().rowwise().sum();
      if (first < 0 && v.size() > 0 && v.cwiseAbs().maxCoeff() > kZero * largest_)
        first = share.signal;
    }
    return (total.cwiseAbs().array() > size.array()).any() ? first : -1;
  }

 private:
  const Graph& g_;
  const std::vector<int>& first_;
  const solve::Factors<double>& factors_;
  std::unique_ptr<const solve::JointRows<double>> rows_;
  RowMatrix<double> rhs_, known_, unknowns_;
  double largest_ = 0;
  std::size_t directions_ = 0;
};

struct ForceJudge {
  const Skeleton& k;
  const Factored& d;
  const SelfStress& stress;
  std::vector<Mistake> mistakes = {};
  std::vector<Note> notes = {};

  void found(const std::string& reader, int signal, const SourceLine& where,
             const std::vector<std::string>& causes = {}) {
    const Graph& g = k.stage.graph;
    std::string joints;
    for (const Released& r : k.stage.released) {
      const std::string name = channel_name(g, r.channel);
      if (joints.find(name) == std::string::npos) joints += (joints.empty() ? "" : ", ") + name;
    }
    notes.push_back({Note::Kind::warning, "forces",
                     fmt::format("{} reads {}, an internal force that motion does not determine: "
                                 "the wrench of minimal norm at {} is used",
                                 reader, name_of(g, signal), joints)});
    std::vector<std::string> lines = {
        "written at " + to_string(where),
        fmt::format("the chain is over-constrained; released: {}", joints)};
    lines.insert(lines.end(), causes.begin(), causes.end());
    mistakes.push_back(
        {Code::kinematic_loop,
         fmt::format("{} reads {}, an internal force that is not determined", reader,
                     name_of(g, signal)),
         std::move(lines),
         "make a body of the chain flexible, free the directions of the joint that other joints "
         "constrain already (.linear, .angular, .along(r)), or use the minimal-norm ones: "
         "Options{.internal_forces = InternalForces::minimal_norm}"});
  }

  std::vector<ForceTerm> terms(const std::vector<Term>& list, int first) const {
    std::vector<ForceTerm> sum;
    for (std::size_t t = 0; t < list.size(); ++t)
      sum.push_back({list[t].signal, *d.numbers.coefficients[at(first) + t]});
    return sum;
  }

  bool finds() {
    outputs();
    controllers();
    bodies();
    return !mistakes.empty();
  }

  void outputs() {
    const Graph& g = k.stage.graph;
    for (std::size_t o = 0; o < g.outputs.size(); ++o)
      if (const int signal =
              stress.shown_by(terms(g.outputs[o].terms, k.joint.output_coefficient[o]));
          signal >= 0)
        found("output " + g.outputs[o].name, signal, g.outputs[o].where);
  }

  void controllers() {
    const Graph& g = k.stage.graph;
    for (std::size_t e = 0; e < g.equations.size(); ++e) {
      const Signal& in = g.signals[at(g.equations[e].target)];
      if (!g.equations[e].active || in.role != Signal::Role::input || in.channel >= 0 ||
          g.nodes[at(in.node)].lowered)
        continue;
      if (const int signal =
              stress.shown_by(terms(g.equations[e].terms, k.joint.equation_coefficient[e]));
          signal >= 0)
        found(name_of(g, g.equations[e].target), signal, g.equations[e].where);
    }
  }

  /// Self-stress is in equilibrium on every body; a body where it is not is moved by it.
  void bodies() {
    const Graph& g = k.stage.graph;
    for (const Row& row : k.stage.rows) {
      if (!row.active) continue;
      std::vector<ForceTerm> sum;
      if (row.node >= 0)
        sum = force_sum(row);
      else if (const Equation& e = g.equations[at(row.equation)]; e.of_block) {
        sum = terms(e.terms, k.joint.equation_coefficient[at(row.equation)]);
        const int n = g.signals[at(e.target)].size;
        sum.push_back({e.target, -Eigen::MatrixXd::Identity(n, n)});
      }
      if (sum.empty()) continue;
      const int y = row.node >= 0 ? row.output : g.equations[at(row.equation)].target;
      const Node& node = g.nodes[at(g.signals[at(y)].node)];
      if (node.block->interface().channels.empty()) continue;
      if (const int signal = stress.shown_by(sum); signal >= 0) {
        found("the motion of " + node.name, signal, node.where,
              {"either a force elsewhere is computed from it, or the chain's ends meet only "
               "nearly: check the lengths and rotations around it"});
        return;  // all bodies mounted on it move as well
      }
    }
  }

  /// Residual of a block's row in its channels' signals: D u - y.
  std::vector<ForceTerm> force_sum(const Row& row) const {
    const Graph& g = k.stage.graph;
    const Signal& y = g.signals[at(row.output)];
    std::vector<ForceTerm> sum{{row.output, -Eigen::MatrixXd::Identity(y.size, y.size)}};
    for (int i = g.nodes[at(row.node)].first_signal; i < end_signal(g, row.node); ++i)
      if (const Signal& u = g.signals[at(i)]; u.role == Signal::Role::input && u.active)
        sum.push_back(
            {i, d.numbers.blocks[at(row.node)]->direct(y.first, u.first, y.size, u.size)});
    return sum;
  }
};

}  // namespace

std::vector<Note> judge_internal_forces(const Factored& d) {
  const Skeleton& k = *d.skeleton;
  if (k.stage.released.empty()) return {};
  SelfStress stress(k, d);
  if (stress.empty()) return {};
  ForceJudge judge{k, d, stress};
  for (int i = 0; judge.finds() && i < kRefinements; ++i) {
    stress.refine();
    judge.mistakes.clear(), judge.notes.clear();
  }
  if (!judge.mistakes.empty() && k.options.internal_forces == InternalForces::refuse)
    throw Error(std::move(judge.mistakes));
  if (stress.summed())
    judge.notes.insert(judge.notes.begin(),
                       {Note::Kind::info, "forces",
                        fmt::format("readers of undetermined internal forces are found from {} "
                                    "random sums of the {} forces",
                                    kSums, stress.directions())});
  return std::move(judge.notes);
}

}  // namespace titop::detail
