#include <titop/compiler/solve/layout.hpp>
#include <titop/compiler/solve/state_map.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/name_order.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;
using linalg::kProductRounding;

/// to += M R; entries that cancel to rounding become 0.
void add_product(MatrixXd& to, const MatrixXd& M, const MatrixXd& R) {
  const MatrixXd size = to.cwiseAbs() + M.cwiseAbs() * R.cwiseAbs();
  to += M * R;
  to = (to.array().abs() <= kProductRounding * size.array()).select(0, to);
}

/// M T by columns.
MatrixXd times_map(const MatrixXd& M, const StateMap& map) {
  MatrixXd all = M, size = M.cwiseAbs();
  std::vector<char> touched(at(M.cols()), 0);
  // Sizes restart from the sums: along a chain of dependent states they would grow with every link,
  // and nonzero entries would be taken for rounding.
  const auto clean = [&](Index j) {
    if (touched[at(j)])
      all.col(j) = (all.col(j).array().abs() <= kProductRounding * size.col(j).array())
                       .select(0, all.col(j));
    size.col(j) = all.col(j).cwiseAbs();
  };
  for (auto row = map.dependent().rbegin(); row != map.dependent().rend(); ++row) {
    clean(row->state);
    for (const auto& [of, factor] : row->of) {
      all.col(of) += factor * all.col(row->state);
      size.col(of) += std::abs(factor) * size.col(row->state);
      touched[at(of)] = 1;
    }
  }
  for (const int j : map.kept()) clean(j);
  return all(Eigen::all, map.kept());
}

}  // namespace

StateMap::StateMap(const std::vector<Dependent>& dependents, const Layout& l) {
  const auto n = l.states.size();
  Map map;
  std::vector<char> leaves(n, 0);
  for (const Dependent& d : dependents) leaves[at(l.state_first[at(d.node)] + d.state)] = 1;
  map.kept.reserve(n - dependents.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (leaves[i]) continue;
    map.kept.push_back(static_cast<int>(i));
    if (!dependents.empty()) map.names.push_back(l.states[i]);
  }
  for (const Dependent& d : dependents) {
    DependentRow row{l.state_first[at(d.node)] + d.state, {}, {}};
    for (const Dependent::Share& s : d.of) {
      row.of.emplace_back(l.state_first[at(s.node)] + s.state, s.factor);
      row.rounding.push_back(s.rounding);
    }
    map.rows.push_back(std::move(row));
  }
  map_ = std::make_shared<const Map>(std::move(map));
}

Eigen::VectorXd StateMap::rounding(const Eigen::VectorXd& all) const {
  Eigen::VectorXd off = Eigen::VectorXd::Zero(all.size());
  for (const DependentRow& row : map_->rows)
    for (std::size_t k = 0; k < row.of.size(); ++k) {
      const auto& [of, factor] = row.of[k];
      off(row.state) += row.rounding[k] * std::abs(all(of)) + std::abs(factor) * off(of);
    }
  return off;
}

void StateMap::reduce(StateSpace& m) const {
  if (trivial()) return;
  if (by_input_.size() > 0) {
    add_product(m.B, m.A, by_input_);
    add_product(m.D, m.C, by_input_);
  }
  m.A = times_map(m.A(kept(), Eigen::all), *this);
  m.B = m.B(kept(), Eigen::all).eval();
  m.C = times_map(m.C, *this);
  m.states = map_->names;
  m.rates = names_at(m.rates, kept());
}

}  // namespace titop::detail
