#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <titop/compiler/index_reduction/new_rows.hpp>
#include <titop/compiler/index_reduction/proper.hpp>
#include <titop/compiler/index_reduction/reduce.hpp>
#include <titop/compiler/solve/blame.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using linalg::at;
using solve::JointSystem;
using solve::Piece;
using solve::RowMatrix;

class Reducer {
 public:
  /// `held`: row groups and rows in them where motions are held already.
  Reducer(Skeleton& k, Factored& d, double least, std::set<std::pair<int, int>>& held)
      : k_(k), d_(d), least_(least), followers_(k, d), held_(held) {}

  /// False if undetermined motions have been taken out of the system as written: begin again.
  bool run() {
    k_.before_reduce = k_.joint;
    factor();
    d_.scale_as_written = d_.factors->scale();
    if (held_.empty() && d_.factors->patches().empty()) throw Error(no_digit_left(d_));
    while (!d_.factors->patches().empty())
      if (!step()) return false;
    if (!constraints_.empty()) finish();
    return true;
  }

 private:
  bool step() {
    const std::vector<Hidden> found = constraints();
    if (found.empty()) throw Error(no_digit_left(d_));
    if (const std::vector<Hidden> rest = followers_.add(found); !rest.empty()) {
      hold_or_refuse(rest);
      return false;
    }
    constraints_.insert(constraints_.end(), found.begin(), found.end());
    NewRows rows(k_, d_);
    for (const Hidden& c : found) rows.derivative(c);
    JointSystem joint = rows.joint();
    move_forcing(joint, found);
    k_.joint = std::move(joint);
    factor();
    return true;
  }

  void factor() {
    d_.factors = std::make_unique<const solve::Factors<double>>(
        k_.joint.plan, real_rows(k_, d_.numbers), nullptr, solve::NoPivot::patch, least_);
    if (const solve::Health h = d_.factors->health(); h.singular)
      throw Error(solve::overflow(k_.stage, k_.joint, h));
  }

  /// Constraints that determine no state. Constraints without content leave a motion undetermined:
  /// it is set to 0 in the system as written if nothing depends on it.
  void hold_or_refuse(const std::vector<Hidden>& rest) {
    std::vector<int> rows;
    for (const Hidden& c : rest)
      if (says_nothing(c)) rows.push_back(c.row);
    if (rows.size() < rest.size()) refuse(rest, {});
    if (!constraints_.empty())
      refuse(rest, {},
             {"this follows only from a derivative of the equations, where undetermined motions "
              "are not identified; give one of these bodies a mass, or impose its motion"});
    const Undetermined motions = undetermined(k_, d_, rows);
    if (motions.held.empty()) refuse(rest, motions.lines);
    const RowGroups groups(*k_.joint.plan);
    for (const int row : rows)
      if (hides_states(groups.of(row).first))
        refuse(rest, motions.lines,
               {"it cannot be set to 0: a sum of many terms connects it with a block's states"});
    for (const int row : rows)  // held, and still undetermined: no digit remains
      if (!held_.insert(groups.of(row)).second)
        refuse(rest, motions.lines, {"set to 0 it is still undetermined"});
    for (const std::string& line : motions.lines)
      d_.notes.push_back(
          {Note::Kind::info, "reduce", line + ", and no output depends on it: set to 0"});
    leave_out(motions.states);
    NewRows held(k_, d_);
    for (const HeldDirection& h : motions.held) held.hold(h);
    k_.joint = held.joint();
  }

  /// At some s a held row's group is written anew with the block's C, and C X(s) must find the
  /// block's inputs in it: not possible if partial sums of a long row replace them.
  bool hides_states(int group) const {
    const auto pieces = k_.joint.row(group);
    const auto is_state = [](const Piece& p) { return p.of == Piece::Left::state; };
    const auto is_sum = [](const Piece& p) { return p.signal < 0; };
    return std::any_of(pieces.begin(), pieces.end(), is_state) &&
           std::any_of(pieces.begin(), pieces.end(), is_sum);
  }

  /// Sets states that are not read to 0.
  void leave_out(const StateMarks& states) {
    std::vector<Dependent>& all = k_.stage.dependents;
    std::set<std::pair<int, int>> left;
    for (const Dependent& d : all) left.emplace(d.node, d.state);
    std::vector<std::string> names;
    for (const int node : d_.layout().state_nodes)
      for (int i = 0; i < d_.numbers.blocks[at(node)]->A.rows(); ++i) {
        const int state = d_.layout().state_first[at(node)] + i;
        if (!states[at(state)] || left.contains({node, i})) continue;
        names.push_back(d_.layout().states[at(state)]);
        all.push_back({node, i, {}});
      }
    if (names.empty()) return;
    for (Dependent& other : all)  // their terms in these states
      std::erase_if(other.of, [&](const Dependent::Share& s) {
        return states[at(d_.layout().state_first[at(s.node)] + s.state)] != 0;
      });
    d_.states = StateMap(all, d_.layout());
    d_.notes.push_back({Note::Kind::info, "reduce",
                        fmt::format("states that only integrate these motions are removed: {}",
                                    some_names(names))});
  }

  static bool says_nothing(const Hidden& c) {
    for (const RowVectorXd& h : c.h)
      if (!h.isZero(0)) return false;
    return true;
  }

  /// One mistake for each set of rows; `free`: the motions that rows without content leave
  /// undetermined; `why`: further lines.
  [[noreturn]] void refuse(const std::vector<Hidden>& rest, const std::vector<std::string>& free,
                           const std::vector<std::string>& why = {}) const {
    std::map<std::vector<int>, std::set<int>> inputs_of;
    for (const Hidden& c : rest) {
      std::set<int>& inputs = inputs_of[c.rows];
      const std::vector<int>& first = d_.layout().input_first;
      for (int i = 0; i < static_cast<int>(first.size()); ++i)
        for (const RowVectorXd& h : c.h)
          if (!h.segment(first[at(i)], k_.stage.graph.inputs[at(i)].size).isZero(0))
            inputs.insert(i);
    }
    std::vector<Mistake> mistakes;
    for (const auto& [rows, inputs] : inputs_of) {
      mistakes.push_back(
          solve::blame(k_.stage, d_.numbers.blocks, rows, {inputs.begin(), inputs.end()}));
      Mistake& m = mistakes.back();
      m.details.insert(m.details.end(), free.begin(), free.end());
      m.details.insert(m.details.end(), why.begin(), why.end());
      if (!free.empty())
        m.hint += why.empty() ? "; or impose that motion, or remove the outputs that depend on it"
                              : "; or impose that motion";
    }
    throw Error(std::move(mistakes));
  }

  std::vector<Hidden> constraints() const {
    const solve::NullRows null = solve::null_rows(*d_.factors);
    const RowGroups groups(*k_.joint.plan);
    std::vector<Hidden> result;
    for (std::size_t i = 0; i < null.y.size(); ++i) {
      result.push_back(constraint(null.y[i], groups));
      result.back().row = null.own[i];
    }
    return result;
  }

  /// y times the known sides of all rows.
  Hidden constraint(const solve::SparseRow& y, const RowGroups& groups) const {
    const auto states = static_cast<int>(d_.layout().order());
    std::map<int, RowVectorXd> of_group;
    for (const auto& [row, value] : y) {
      const auto [r, place] = groups.of(row);
      RowVectorXd& own = of_group[r];
      if (own.size() == 0) own.setZero(k_.joint.plan->structure.row_size[at(r)]);
      own(place) = value;
    }
    Hidden c{{}, {RowVectorXd::Zero(std::ssize(d_.layout().inputs))}};
    std::map<int, solve::CancellingSum> sum;  // by place in [x; u]
    for (const auto& [r, own] : of_group) {
      c.rows.push_back(k_.joint.rows[at(r)]);
      for (const Piece& p : k_.joint.row(r)) {
        if (p.entry >= 0) continue;
        const MatrixXd m = solve::matrix_of(p, d_.numbers);
        const RowVectorXd value = own * m, size = own.cwiseAbs() * m.cwiseAbs();
        const int first = d_.layout().known_first[at(p.signal)];
        for (int i = 0; i < value.size(); ++i) sum[first + i].add(value(i), size(i));
      }
    }
    for (const auto& [i, known] : sum)
      if (const double value = known.cleaned(); i >= states)
        c.h[0](i - states) = value;
      else if (value != 0)
        c.g.emplace_back(i, value);
    for (const RowMatrix<double>& f : forcing_) c.h.push_back(by_forcing(y, f));
    return c;
  }

  /// -y f
  static RowVectorXd by_forcing(const solve::SparseRow& y, const RowMatrix<double>& f) {
    RowVectorXd factors(std::ssize(y));
    MatrixXd rows(std::ssize(y), f.cols());
    for (std::size_t i = 0; i < y.size(); ++i) {
      factors(static_cast<Index>(i)) = -y[i].second;
      rows.row(static_cast<Index>(i)) = f.row(y[i].first);
    }
    return solve::product(factors, rows);
  }

  /// Right-hand sides by u', u'' ...: those of the old rows, in the new order, and the new ones.
  void move_forcing(const JointSystem& joint, const std::vector<Hidden>& found) {
    const auto inputs = static_cast<Index>(d_.layout().inputs.size());
    std::vector<RowMatrix<double>> moved(forcing_.size(),
                                         RowMatrix<double>::Zero(joint.plan->unknowns, inputs));
    const RowGroups groups(*k_.joint.plan);
    const auto place = [&](int row) {
      const auto [r, offset] = groups.of(row);
      return joint.plan->row_first[at(r)] + offset;
    };
    for (std::size_t j = 0; j < forcing_.size(); ++j)
      for (int row = 0; row < joint.plan->unknowns; ++row)
        if (!forcing_[j].row(row).isZero(0)) moved[j].row(place(row)) = forcing_[j].row(row);
    for (const Hidden& c : found)
      for (auto& m : moved) m.row(place(c.row)).setZero();
    for (const Hidden& c : found)
      for (std::size_t j = 0; j < c.h.size(); ++j) {
        if (c.h[j].isZero(0)) continue;
        while (moved.size() <= j)
          moved.push_back(RowMatrix<double>::Zero(joint.plan->unknowns, inputs));
        moved[j].row(place(c.row)) = -c.h[j];
      }
    forcing_ = std::move(moved);
  }

  void finish() {
    k_.stage.dependents = followers_.dependents();
    d_.states = StateMap(k_.stage.dependents, d_.layout());
    std::vector<std::string> names;
    for (const int state : followers_.added()) names.push_back(d_.layout().states[at(state)]);
    d_.notes.push_back(
        {Note::Kind::info, "reduce",
         fmt::format("{} states are determined by the others at points without mass: {}",
                     names.size(), some_names(names))});
    make_proper(k_, d_, {followers_.by_input(), forcing_, constraints_});
  }

  Skeleton& k_;
  Factored& d_;
  double least_;
  Followers followers_;
  std::set<std::pair<int, int>>& held_;
  std::vector<RowMatrix<double>> forcing_;  ///< [j]: rows x inputs, of u^(j + 1)
  std::vector<Hidden> constraints_;
};

void reduce_with(double least, Skeleton& k, Factored& d) {
  std::set<std::pair<int, int>> held;
  while (!Reducer(k, d, least, held).run()) {
  }
  d.weak_pivots = judge_weak_pivots(d, *d.margins);
}

/// All that the reduction changes, as it was before.
class AsWritten {
 public:
  AsWritten(const Skeleton& k, const Factored& d)
      : joint_(k.joint),
        dependents_(k.stage.dependents),
        notes_(d.notes.size()),
        coefficients_(d.numbers.coefficients.size()),
        states_(d.states) {}

  void restore(Skeleton& k, Factored& d) && {
    k.joint = std::move(joint_);
    k.stage.dependents = std::move(dependents_);
    d.notes.resize(notes_);
    d.numbers.coefficients.resize(coefficients_);
    d.states = std::move(states_);
  }

 private:
  JointSystem joint_;
  std::vector<Dependent> dependents_;
  std::size_t notes_, coefficients_;  ///< appended to
  StateMap states_;
};

}  // namespace

void reduce(Skeleton& k, Factored& d) {
  if (const double least = d.weak_pivots ? d.weak_pivots->least : 0; least > 0)
    return reduce_with(least, k, d);
  AsWritten before(k, d);
  reduce_with(0, k, d);
  if (const double least = d.weak_pivots->least; least > 0) {
    std::move(before).restore(k, d);
    reduce_with(least, k, d);
  }
}

}  // namespace titop::detail
