#include <algorithm>
#include <titop/compiler/index_reduction/new_rows.hpp>
#include <titop/compiler/solve/piece_matrix.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/each_once.hpp>

namespace titop::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using linalg::at;
using solve::JointSystem;
using solve::Piece;
using solve::RowMatrix;

}  // namespace

RowGroups::RowGroups(const solve::Plan& plan) : of_(at(plan.unknowns)) {
  for (int r = 0; r < static_cast<int>(plan.row_first.size()); ++r)
    for (int i = 0; i < plan.structure.row_size[at(r)]; ++i)
      of_[at(plan.row_first[at(r)] + i)] = {r, i};
}

NewRows::NewRows(const Skeleton& k, Factored& d)
    : k_(k), d_(d), old_(k.joint), groups_(*old_.plan), node_of_(at(d.layout().order())) {
  for (const int i : d.layout().state_nodes)
    std::fill_n(node_of_.begin() + d.layout().state_first[at(i)], d.numbers.blocks[at(i)]->A.rows(),
                i);
}

JointSystem NewRows::joint() {
  JointSystem j = old_;
  j.pieces.clear();
  j.piece_begin = {0};
  solve::Structure structure;
  structure.variable_size = old_.plan->structure.variable_size;
  structure.variable_unit = old_.plan->structure.variable_unit;
  for (int r = 0; r < static_cast<int>(old_.rows.size()); ++r) {
    std::vector<Piece> pieces(old_.row(r).begin(), old_.row(r).end());
    const auto before = old_.plan->structure.row(r);
    std::vector<int> over(before.begin(), before.end());
    for (Piece& p : pieces)
      if (p.entry >= 0) p.entry = over[at(p.entry)];
    if (const auto found = by_group_.find(r); found != by_group_.end())
      rewrite(r, found->second, pieces, over);
    detail::keep_each_once(over);
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

void NewRows::rewrite(int r, const Group& group, std::vector<Piece>& pieces,
                      std::vector<int>& over) {
  const int size = old_.plan->structure.row_size[at(r)];
  const auto place = [&](int row) {
    return VectorXd(VectorXd::Unit(size, groups_.of(row).second));
  };
  MatrixXd mask = MatrixXd::Identity(size, size);
  for (const Hidden* c : group.derivatives) mask.row(groups_.of(c->row).second).setZero();
  for (const HeldDirection* h : group.held) mask.row(groups_.of(h->row).second).setZero();
  std::vector<Piece> result;
  for (const Piece& p : pieces) put(result, p, mask * solve::matrix_of(p, d_.numbers));
  for (const Hidden* c : group.derivatives) differentiate(*c, place(c->row), result, over);
  for (const HeldDirection* h : group.held)
    add(result, over, place(h->row) * h->direction, h->signal);
  pieces = std::move(result);
}

/// The piece with this matrix, unless that is 0.
void NewRows::put(std::vector<Piece>& to, Piece p, const MatrixXd& matrix) {
  if (matrix.isZero(0)) return;
  p.of = Piece::Left::coefficient;
  p.left = static_cast<int>(d_.numbers.coefficients.size());
  p.right = -1;
  p.size = static_cast<int>(matrix.cols());
  p.sign = 1;
  d_.numbers.coefficients.push_back(std::make_shared<const RowMatrix<double>>(matrix));
  to.push_back(p);
}

void NewRows::differentiate(const Hidden& c, const VectorXd& place, std::vector<Piece>& to,
                            std::vector<int>& over) {
  const Graph& g = k_.stage.graph;
  std::map<int, RowVectorXd> of_node;
  for (const auto& [state, factor] : c.g) {
    const int i = node_of_[at(state)];
    RowVectorXd& own = of_node[i];
    if (own.size() == 0) own.setZero(d_.numbers.blocks[at(i)]->A.rows());
    own(state - d_.layout().state_first[at(i)]) = factor;
  }
  for (const auto& [i, own] : of_node) {
    const Dynamics& m = *d_.numbers.blocks[at(i)];
    const Node& node = g.nodes[at(i)];
    put(to, {.signal = node.state}, place * solve::product(own, m.A));
    for (int s = node.first_signal; s < node.state; ++s)
      if (const Signal& u = g.signals[at(s)]; u.role == Signal::Role::input && u.active)
        add(to, over, place * solve::product(own, m.B.middleCols(u.first, u.size)), s);
  }
}

/// Adds matrix * signal, with the signal's meaning substituted.
void NewRows::add(std::vector<Piece>& to, std::vector<int>& over, const MatrixXd& matrix,
                  int signal) {
  for (const solve::SignalTerm& m : old_.meaning(signal)) {
    const int v = old_.variable_of[at(m.signal)];
    if (v >= 0) over.push_back(v);
    put(to, {.entry = v, .signal = m.signal},
        m.coefficient < 0 ? matrix
                          : solve::product(matrix, *d_.numbers.coefficients[at(m.coefficient)]));
  }
}

}  // namespace titop::detail
