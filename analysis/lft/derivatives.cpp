#include <fmt/format.h>

#include <algorithm>
#include <titop/analysis/lft/derivatives.hpp>
#include <titop/analysis/lft/opening.hpp>
#include <titop/compiler/passes/open/differences.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/schur.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using linalg::at;

namespace {

/// Blocks with this parameter that do not open it.
std::vector<std::string> closed_blocks(const Graph& g, ParameterValues values, int parameter) {
  std::vector<std::string> names;
  for (const Node& node : g.nodes) {
    const std::vector<Value> all = node.block->values();
    if (std::any_of(all.begin(), all.end(),
                    [&](const Value& v) { return v.index() == parameter; }) &&
        !passes::is_opened_by(*node.block, values, parameter))
      names.push_back(node.name);
  }
  return names;
}

}  // namespace

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
  Derivatives g{system, detail::compile_opened(system, to_open)};
  detail::OpenedMatrices opened = detail::opened_matrices(System(g.opened_), list);
  g.m_ = std::move(opened.m);
  g.in_ = std::move(opened.in), g.out_ = std::move(opened.out);
  g.inputs_ = opened.ports.back().inputs, g.outputs_ = opened.ports.back().outputs;
  g.names_ = parameters;
  const Stage& stage = system.stage();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool angle = list[i].map.kind != ParameterMap::Kind::number;
    const auto closed = closed_blocks(*stage.source, stage.values, list[i].index);
    for (const std::string& block : closed)
      g.by_differences_.push_back(parameters[i] + " of " + block);
    g.pairs_.push_back({g.all_pairs_, opened.sizes[i], angle ? 0.5 : 1.0, closed.empty(),
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

namespace {

/// P of A P + P A' + B B' = 0.
MatrixXd lyapunov(const MatrixXd& A, const MatrixXd& B) {
  const linalg::Schur s = linalg::schur(A);
  const MatrixXcd QU = s.Q * linalg::lyapunov_factor(s.T, s.Q.adjoint() * B);
  return (QU * QU.adjoint()).real();
}

void refuse_norm(const std::string& why, const char* way_out) {
  throw Error(Code::singular, "the H2 norm is infinite: " + why, way_out);
}

}  // namespace

Slopes Derivatives::h2() const {
  const Index ny = m_.D.rows() - all_pairs_, nu = m_.D.cols() - all_pairs_;
  const MatrixXd B = m_.B.rightCols(nu), C = m_.C.bottomRows(ny);
  if (m_.order() > 0) {
    const Eigen::VectorXcd poles = linalg::eigenvalues(m_.A);
    Index worst = 0;
    poles.real().maxCoeff(&worst);
    if (!(poles(worst).real() < 0))
      refuse_norm(fmt::format("the pole {:.6g}{:+.6g}j is not left of the axis",
                              poles(worst).real(), poles(worst).imag()),
                  "damp it, or leave out the output that reads its position");
  }
  bool direct = !m_.D.bottomRightCorner(ny, nu).isZero(0);
  for (const std::string& p : names_) direct = direct || !matrices(p).D.isZero(0);
  if (direct)
    refuse_norm("there is a direct term",
                "read rates or positions, or filter the inputs or outputs");
  const MatrixXd P = lyapunov(m_.A, B), Q = lyapunov(m_.A.transpose(), C.transpose());
  Slopes result{std::sqrt((C * P * C.transpose()).trace()),
                Eigen::VectorXd::Zero(static_cast<Index>(names_.size()))};
  if (!(result.value > 0))
    throw Error(Code::singular, "the H2 norm is 0, where it has no derivatives",
                "take inputs and outputs that are connected");
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const StateSpace d = matrices(names_[i]);
    const double half = (Q * d.A * P).trace() + (Q * d.B * B.transpose()).trace() +
                        (d.C * P * C.transpose()).trace();
    result.slopes(static_cast<Index>(i)) = half / result.value;
  }
  return result;
}

}  // namespace titop
