#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <titop/compiler/reduce/hidden.hpp>
#include <titop/compiler/reduce/proper.hpp>
#include <titop/compiler/reduce/reduce.hpp>
#include <titop/compiler/solve/blame.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using solve::Joint;
using solve::Piece;
using solve::RowMatrix;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Row group and place in it of every scalar row.
std::pair<int, int> group_of(const Joint& joint, int scalar_row) {
  const auto& first = joint.plan->row_first;
  int r = 0;
  for (int i = 0; i < static_cast<int>(first.size()); ++i)
    if (first[at(i)] <= scalar_row && first[at(i)] >= first[at(r)]) r = i;
  return {r, scalar_row - first[at(r)]};
}

/// Derivatives of constraints in place of some rows of a joint system.
class Substitution {
 public:
  Substitution(const Skeleton& k, SystemData& d) : k_(k), d_(d), old_(k.joint) {}

  /// g x' = -h u' - ..., x' = A x + B u block by block, in place of this scalar row.
  void replace(const Hidden& c) { by_group_[group_of(old_, c.row).first].push_back(&c); }

  Joint joint() {
    Joint j = old_;
    j.pieces.clear();
    j.piece_begin = {0};
    solve::Structure structure;
    structure.variable_size = old_.plan->structure.variable_size;
    for (int r = 0; r < static_cast<int>(old_.rows.size()); ++r) {
      std::vector<Piece> pieces(old_.row(r).begin(), old_.row(r).end());
      const auto before = old_.plan->structure.row(r);
      std::vector<int> over(before.begin(), before.end());
      for (Piece& p : pieces)
        if (p.entry >= 0) p.entry = over[at(p.entry)];
      if (const auto found = by_group_.find(r); found != by_group_.end())
        rewrite(r, found->second, pieces, over);
      std::sort(over.begin(), over.end());
      over.erase(std::unique(over.begin(), over.end()), over.end());
      for (Piece& p : pieces)
        if (p.entry >= 0)
          p.entry =
              static_cast<int>(std::lower_bound(over.begin(), over.end(), p.entry) - over.begin());
      structure.add_row(old_.plan->structure.row_size[at(r)], over);
      j.pieces.insert(j.pieces.end(), pieces.begin(), pieces.end());
      j.piece_begin.push_back(static_cast<int>(j.pieces.size()));
    }
    j.plan = std::make_shared<const solve::Plan>(solve::plan(std::move(structure)));
    return j;
  }

 private:
  void rewrite(int r, const std::vector<const Hidden*>& constraints, std::vector<Piece>& pieces,
               std::vector<int>& over) {
    const int size = old_.plan->structure.row_size[at(r)];
    MatrixXd mask = MatrixXd::Identity(size, size);
    for (const Hidden* c : constraints) mask.row(group_of(old_, c->row).second).setZero();
    std::vector<Piece> result;
    for (const Piece& p : pieces)
      put(result, p, mask * solve::matrix_of(p, k_.stage.graph, d_.numbers));
    for (const Hidden* c : constraints)
      differentiate(*c, VectorXd::Unit(size, group_of(old_, c->row).second), result, over);
    pieces = std::move(result);
  }

  using VectorXd = Eigen::VectorXd;

  /// The piece with this matrix, unless that is 0.
  void put(std::vector<Piece>& to, Piece p, const MatrixXd& matrix) {
    if (matrix.isZero(0)) return;
    p.of = Piece::Left::coefficient;
    p.left = static_cast<int>(d_.numbers.coefficients.size());
    p.right = -1;
    p.sign = 1;
    d_.numbers.coefficients.push_back(std::make_shared<const RowMatrix<double>>(matrix));
    to.push_back(p);
  }

  void differentiate(const Hidden& c, const VectorXd& place, std::vector<Piece>& to,
                     std::vector<int>& over) {
    const Graph& g = k_.stage.graph;
    for (const int i : d_.layout().state_nodes) {
      const Dynamics& m = *d_.numbers.blocks[at(i)];
      const RowVectorXd own = c.g.segment(d_.layout().state_first[at(i)], m.A.rows());
      if (own.isZero(0)) continue;
      const Node& node = g.nodes[at(i)];
      put(to, {.rows = static_cast<int>(place.size()), .signal = node.state},
          place * product(own, m.A));
      for (int s = node.first_signal; s < node.state; ++s)
        if (const Signal& u = g.signals[at(s)]; u.role == Signal::Role::input && u.active)
          add(to, over, place * product(own, m.B.middleCols(u.first, u.size)), s);
    }
  }

  static RowVectorXd product(const RowVectorXd& a, const MatrixXd& M) {
    RowVectorXd result = a * M;
    const RowVectorXd size = a.cwiseAbs() * M.cwiseAbs();
    return (result.array().abs() <= solve::kCancelled * size.array()).select(0, result);
  }

  /// matrix * signal, in what the signal stands for.
  void add(std::vector<Piece>& to, std::vector<int>& over, const MatrixXd& matrix, int signal) {
    for (const solve::Meaning& m : old_.meaning(signal)) {
      const int v = old_.variable_of[at(m.signal)];
      if (v >= 0) over.push_back(v);
      put(to, {.rows = static_cast<int>(matrix.rows()), .entry = v, .signal = m.signal},
          m.coefficient < 0 ? matrix
                            : MatrixXd(matrix * *d_.numbers.coefficients[at(m.coefficient)]));
    }
  }

  const Skeleton& k_;
  SystemData& d_;
  const Joint& old_;
  std::map<int, std::vector<const Hidden*>> by_group_;
};

class Reducer {
 public:
  Reducer(Skeleton& k, SystemData& d) : k_(k), d_(d), followers_(k, d) {}

  void run() {
    k_.before_reduce = k_.joint;
    factor();
    d_.scale_as_written = d_.factors->scale();
    while (!d_.factors->patches().empty()) step();
    finish();
  }

 private:
  void step() {
    const std::vector<Hidden> found = constraints();
    if (const std::vector<Hidden> rest = followers_.add(found); !rest.empty()) refuse(rest);
    constraints_.insert(constraints_.end(), found.begin(), found.end());
    Substitution substitution(k_, d_);
    for (const Hidden& c : found) substitution.replace(c);
    Joint joint = substitution.joint();
    move_forcing(joint, found);
    k_.joint = std::move(joint);
    factor();
  }

  void factor() {
    d_.factors = std::make_unique<const solve::Factors<double>>(
        k_.joint.plan, real_rows(k_, d_.numbers), nullptr, solve::NoPivot::patch);
    if (const solve::Health h = d_.factors->health(); h.singular)
      throw Error(solve::overflow(k_.stage, k_.joint, h));
  }

  /// Constraints that determine no state: one mistake for each set of rows.
  void refuse(const std::vector<Hidden>& rest) const {
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
    for (const auto& [rows, inputs] : inputs_of)
      mistakes.push_back(
          solve::blame(k_.stage, d_.numbers.blocks, rows, {inputs.begin(), inputs.end()}));
    throw Error(std::move(mistakes));
  }

  std::vector<Hidden> constraints() const {
    const solve::NullRows null = solve::null_rows(*d_.factors);
    std::vector<Hidden> result;
    for (Index i = 0; i < null.y.rows(); ++i) {
      Hidden c = constraint(null.y.row(i));
      c.row = null.own[at(i)];
      result.push_back(std::move(c));
    }
    return result;
  }

  /// y times the known sides of all rows.
  Hidden constraint(const RowVectorXd& y) const {
    const Index states = d_.layout().order();
    const auto inputs = static_cast<Index>(d_.layout().inputs.size());
    std::vector<solve::Kept> sum(at(states + inputs));
    std::vector<int> rows;
    for (int r = 0; r < static_cast<int>(k_.joint.rows.size()); ++r) {
      const RowVectorXd own =
          y.segment(k_.joint.plan->row_first[at(r)], k_.joint.plan->structure.row_size[at(r)]);
      if (own.isZero(0)) continue;
      rows.push_back(k_.joint.rows[at(r)]);
      for (const Piece& p : k_.joint.row(r)) {
        if (p.entry >= 0) continue;
        const MatrixXd m = solve::matrix_of(p, k_.stage.graph, d_.numbers);
        const RowVectorXd value = own * m, size = own.cwiseAbs() * m.cwiseAbs();
        const int first = d_.layout().known_first[at(p.signal)];
        for (Index i = 0; i < value.size(); ++i) sum[at(first + i)].add(value(i), size(i));
      }
    }
    Hidden c{RowVectorXd(states), {RowVectorXd(inputs)}};
    for (Index i = 0; i < states; ++i) c.g(i) = sum[at(i)].cleaned();
    for (Index i = 0; i < inputs; ++i) c.h[0](i) = sum[at(states + i)].cleaned();
    for (const RowMatrix<double>& f : forcing_) c.h.push_back(-y * f);
    c.rows = std::move(rows);
    return c;
  }

  /// Right-hand sides by u', u'' ...: those of the old rows, in the new order, and the new ones.
  void move_forcing(const Joint& joint, const std::vector<Hidden>& found) {
    const auto inputs = static_cast<Index>(d_.layout().inputs.size());
    std::vector<RowMatrix<double>> moved(forcing_.size(),
                                         RowMatrix<double>::Zero(joint.plan->unknowns, inputs));
    const auto place = [&](int row) {
      const auto [r, offset] = group_of(k_.joint, row);
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
    std::string names;
    const auto& added = followers_.added();
    for (std::size_t i = 0; i < added.size() && i < 8; ++i)
      names += (i ? ", " : "") + d_.layout().states[at(added[i])];
    if (added.size() > 8) names += fmt::format(", and {} more", added.size() - 8);
    k_.stage.notes.push_back(
        {Note::Kind::info, "reduce",
         fmt::format("{} states follow from the others where nothing has mass: {}", added.size(),
                     names)});
    make_proper(k_, d_, {followers_.by_input(), forcing_, constraints_});
  }

  Skeleton& k_;
  SystemData& d_;
  Followers followers_;
  std::vector<RowMatrix<double>> forcing_;  ///< [j]: rows x inputs, of u^(j + 1)
  std::vector<Hidden> constraints_;
};

}  // namespace

void reduce(Skeleton& k, SystemData& d) { Reducer(k, d).run(); }

}  // namespace titop::detail
