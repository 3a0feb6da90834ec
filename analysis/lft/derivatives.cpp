#include <fmt/format.h>

#include <algorithm>
#include <titop/analysis/lft/derivatives.hpp>
#include <titop/analysis/lft/opening.hpp>
#include <titop/analysis/norms/gramian.hpp>
#include <titop/analysis/norms/scaled.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/schur.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

Derivatives derivatives(const System& system, const std::vector<std::string>& parameters) {
  std::vector<detail::IsolatedParameter> list;
  std::vector<passes::ToOpen> to_open;
  std::vector<Mistake> mistakes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string& name = parameters[i];
    if (std::find(parameters.begin(), parameters.begin() + static_cast<std::ptrdiff_t>(i), name) !=
        parameters.begin() + static_cast<std::ptrdiff_t>(i))
      mistakes.push_back({Code::duplicate_name,
                          fmt::format("parameter {} is named twice", name),
                          {},
                          "name it once"});
    list.push_back(detail::unranged(system, name, mistakes));
    to_open.push_back({.parameter = list.back().index, .differences = true});
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  Derivatives g{system, detail::compile_opened(detail::data_of(system), to_open)};
  detail::OpenedMatrices opened = detail::opened_matrices(System(g.opened_), list);
  g.m_ = std::move(opened.m);
  g.in_ = std::move(opened.in), g.out_ = std::move(opened.out);
  g.inputs_ = opened.ports.back().inputs, g.outputs_ = opened.ports.back().outputs;
  g.names_ = parameters;
  const System of_all(g.opened_);
  const std::vector<ByDifferences>& by_differences = of_all.stage().by_differences;
  for (const ByDifferences& b : by_differences)
    g.by_differences_.push_back(of_all.stage().graph.parameters[at(b.parameter)].name + " of " +
                                b.block);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool angle = list[i].map.kind != ParameterMap::Kind::number;
    const auto closed =
        std::ranges::count(by_differences, list[i].index, &ByDifferences::parameter);
    g.pairs_.push_back({g.all_pairs_, opened.sizes[i], angle ? 0.5 : 1.0, closed == 0,
                        opened.ports[i].inputs, opened.ports[i].outputs});
    g.all_pairs_ += opened.sizes[i];
  }
  return g;
}

StateSpace Derivatives::matrices(const std::string& p) const {
  const Pairs& i = pairs_[at(index_of(p))];
  const Index ny = m_.D.rows() - all_pairs_, nu = m_.D.cols() - all_pairs_;
  const MatrixXd Bw = i.slope * m_.B.middleCols(i.first, i.size),
                 Dyw = i.slope * m_.D.bottomRows(ny).middleCols(i.first, i.size),
                 Cz = m_.C.middleRows(i.first, i.size),
                 Dzu = m_.D.rightCols(nu).middleRows(i.first, i.size);
  return {.A = Bw * Cz,
          .B = Bw * Dzu,
          .C = Dyw * Cz,
          .D = Dyw * Dzu,
          .states = m_.states,
          .inputs = {m_.inputs.begin() + all_pairs_, m_.inputs.end()},
          .outputs = {m_.outputs.begin() + all_pairs_, m_.outputs.end()}};
}

Slopes Derivatives::h2() const {
  const Index ny = m_.D.rows() - all_pairs_, nu = m_.D.cols() - all_pairs_;
  const StateSpace m = detail::scaled(m_);
  detail::require_stable_h2(m);
  bool direct = !m.D.bottomRightCorner(ny, nu).isZero(0);
  for (const std::string& p : names_) direct = direct || !matrices(p).D.isZero(0);
  if (direct) detail::refuse_direct_h2();
  const MatrixXd B = m.B.rightCols(nu), C = m.C.bottomRows(ny);
  const MatrixXd P = detail::gramian(m.A, B), Q = detail::gramian(m.A.transpose(), C.transpose());
  Slopes result{std::sqrt((C * P * C.transpose()).trace()),
                Eigen::VectorXd::Zero(static_cast<Index>(names_.size()))};
  if (!(result.value > 0))
    throw Error(Code::singular, "the H2 norm is 0, where it has no derivatives",
                "take inputs and outputs that are connected");
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const Pairs& p = pairs_[i];
    const MatrixXd Bw = p.slope * m.B.middleCols(p.first, p.size),
                   Dyw = p.slope * m.D.bottomRows(ny).middleCols(p.first, p.size),
                   Cz = m.C.middleRows(p.first, p.size),
                   Dzu = m.D.rightCols(nu).middleRows(p.first, p.size);
    const double half = ((Cz * P) * (Q * Bw)).trace() + ((Q * Bw) * (Dzu * B.transpose())).trace() +
                        ((Dyw * Cz) * (P * C.transpose())).trace();
    result.slopes(static_cast<Index>(i)) = half / result.value;
  }
  return result;
}

}  // namespace titop
