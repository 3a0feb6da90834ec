#include <titop/compiler/index_reduction/hidden.hpp>
#include <titop/compiler/loops/lines.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using linalg::at;
using solve::CancellingSum;

/// Sums of many numbers, entry by entry.
struct KeptRow {
  std::vector<CancellingSum> entries;

  explicit KeptRow(Index n) : entries(at(n)) {}
  void add(double factor, const RowVectorXd& row) {
    for (Index i = 0; i < row.size(); ++i)
      entries[at(i)].add(factor * row(i), std::abs(factor * row(i)));
  }
  RowVectorXd cleaned() const {
    RowVectorXd row(static_cast<Index>(entries.size()));
    for (Index i = 0; i < row.size(); ++i) row(i) = entries[at(i)].cleaned();
    return row;
  }
};

KeptRow& grown(std::vector<KeptRow>& list, std::size_t j, Index n) {
  while (list.size() <= j) list.emplace_back(n);
  return list[j];
}

}  // namespace

Followers::Followers(const Skeleton& k, const Factored& d)
    : layout_(d.layout()), inputs_(static_cast<Index>(d.layout().inputs.size())) {
  const Index n = layout_.order();
  is_rate_.assign(at(n), 0);
  node_.assign(at(n), -1);
  first_.assign(at(n), -1);
  before_.assign(at(n), 0);
  weight_ = Eigen::VectorXd::Zero(n);
  const loops::StateRates coordinates(k.stage.graph, k.stage.values);
  for (const int node : layout_.state_nodes) {
    const int first = layout_.state_first[at(node)];
    const Index count = d.numbers.blocks[at(node)]->A.rows();
    for (int i = 0; i < count; ++i) {
      node_[at(first + i)] = node, first_[at(first + i)] = first;
      const int rate = coordinates.rate_of(node, i);
      if (rate < 0) continue;
      is_rate_[at(first + rate)] = 1;
      weight_(first + i) = weight_(first + rate) = coordinates.weight(node, i);
    }
  }
  for (const Dependent& b : k.stage.before)
    if (layout_.state_first[at(b.node)] >= 0)
      before_[at(layout_.state_first[at(b.node)] + b.state)] = 1;
  for (const Dependent& dep : k.stage.dependents) {
    std::map<int, double> of;
    for (const Dependent::Share& s : dep.of) {
      const int state = layout_.state_first[at(s.node)] + s.state;
      if (const auto found = of_state_.find(state); found == of_state_.end())
        of[state] += s.factor;
      else
        for (const auto& [independent, factor] : found->second.of)
          of[independent] += s.factor * factor;
    }
    const int own = layout_.state_first[at(dep.node)] + dep.state;
    for (const auto& [independent, factor] : of) read_by_[independent].insert(own);
    of_state_[own].of = std::move(of);
  }
}

/// Writes a constraint in independent states.
void Followers::substitute(Hidden& c) const {
  std::map<int, CancellingSum> g;
  std::vector<KeptRow> h;
  for (std::size_t j = 0; j < c.h.size(); ++j) grown(h, j, inputs_).add(1, c.h[j]);
  for (const auto& [i, share] : c.g) {
    const auto found = of_state_.find(i);
    if (found == of_state_.end()) {
      g[i].add(share, std::abs(share));
      continue;
    }
    for (const auto& [of, factor] : found->second.of)
      g[of].add(share * factor, std::abs(share * factor));
    for (std::size_t j = 0; j < found->second.by.size(); ++j)
      grown(h, j, inputs_).add(share, found->second.by[j]);
  }
  c.g.clear();
  for (const auto& [i, sum] : g)
    if (const double value = sum.cleaned(); value != 0) c.g.emplace_back(i, value);
  c.h.clear();
  for (const KeptRow& row : h) c.h.push_back(row.cleaned());
}

int Followers::choose(const Hidden& c) const {
  // Rates first, then coordinates that store energy, then the others.
  const auto tier = [&](int i) { return is_rate_[at(i)] ? 0 : weight_(i) > 0 ? 1 : 2; };
  int best_tier = 3;
  for (const auto& [i, share] : c.g) best_tier = std::min(best_tier, tier(i));
  double largest = 0, largest_before = 0;
  int best = -1, best_before = -1;
  for (const auto& [i, share] : c.g) {
    if (tier(i) != best_tier) continue;
    const double size = std::abs(share) * (weight_(i) > 0 ? weight_(i) : 1);
    if (size > linalg::kTie * largest) largest = size, best = i;
    if (before_[at(i)] && size > linalg::kTie * largest_before)
      largest_before = size, best_before = i;
  }
  return largest_before >= loops::kThreeDigits * largest ? best_before : best;
}

void Followers::follow(int state, const Hidden& c) {
  const auto own =
      std::find_if(c.g.begin(), c.g.end(), [&](const auto& entry) { return entry.first == state; });
  Follower f;
  for (const auto& [i, share] : c.g)
    if (i != state) f.of[i] = -share / own->second, read_by_[i].insert(state);
  for (const RowVectorXd& h : c.h) f.by.push_back(h / -own->second);
  if (const auto readers = read_by_.extract(state))
    for (const int other : readers.mapped()) follow_through(other, state, f);
  of_state_[state] = std::move(f);
  added_.push_back(state);
}

/// Substitutes this dependent state in another one that depends on it.
void Followers::follow_through(int other, int state, const Follower& f) {
  Follower& old = of_state_[other];
  const double factor = old.of.extract(state).mapped();
  for (const auto& [of, share] : f.of) {
    CancellingSum sum{old.of[of], std::abs(old.of[of])};
    sum.add(factor * share, std::abs(factor * share));
    read_by_[of].insert(other);
    if ((old.of[of] = sum.cleaned()) == 0) old.of.erase(of), read_by_[of].erase(other);
  }
  std::vector<KeptRow> by;
  for (std::size_t j = 0; j < old.by.size(); ++j) grown(by, j, inputs_).add(1, old.by[j]);
  for (std::size_t j = 0; j < f.by.size(); ++j) grown(by, j, inputs_).add(factor, f.by[j]);
  old.by.clear();
  for (const KeptRow& row : by) old.by.push_back(row.cleaned());
}

std::vector<Hidden> Followers::add(std::vector<Hidden> constraints) {
  std::vector<Hidden> rest;
  for (Hidden& c : constraints) {
    substitute(c);
    if (const int state = choose(c); state >= 0)
      follow(state, c);
    else
      rest.push_back(std::move(c));
  }
  return rest;
}

std::vector<Dependent> Followers::dependents() const {
  std::vector<Dependent> result;
  for (const auto& [state, f] : of_state_) {
    Dependent d{node_[at(state)], state - first_[at(state)], {}};
    for (const auto& [of, factor] : f.of)
      d.of.push_back({node_[at(of)], of - first_[at(of)], factor});
    result.push_back(std::move(d));
  }
  std::sort(result.begin(), result.end(), [](const Dependent& a, const Dependent& b) {
    return std::pair(a.node, a.state) < std::pair(b.node, b.state);
  });
  return result;
}

std::vector<MatrixXd> Followers::by_input() const {
  std::vector<MatrixXd> result;
  for (const auto& [state, f] : of_state_)
    for (std::size_t j = 0; j < f.by.size(); ++j) {
      while (result.size() <= j) result.push_back(MatrixXd::Zero(layout_.order(), inputs_));
      result[j].row(state) = f.by[j];
    }
  return result;
}

}  // namespace titop::detail
