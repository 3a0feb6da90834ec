#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <titop/analysis/reduction/rate_feedback.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using linalg::at;

[[noreturn]] void refuse_forces(std::string message) {
  throw NoStructure(Code::bad_value, std::move(message),
                    "forces of a structure with rotors follow positions as springs do and rates as "
                    "dampers and gyroscopes do: make others, such as those of a law, inputs");
}

bool has_rotors(const Graph& g, ParameterValues values) {
  return std::any_of(g.nodes.begin(), g.nodes.end(),
                     [](const Node& n) { return n.block->type() == "Rotor"; }) ||
         !passes::gyroscopic_gains(g, values).empty();
}

/// Orthonormal columns that span these of one unit; unit vectors if they span all.
MatrixXd span_of(const MatrixXd& columns) {
  if (columns.isZero(0)) return MatrixXd(columns.rows(), 0);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  qr.setThreshold(linalg::kAxisRounding);
  const Index rank = qr.rank();
  if (rank == columns.rows()) return MatrixXd::Identity(rank, rank);
  return MatrixXd(qr.householderQ()).leftCols(rank);
}

/// Per channel the directions (columns) in which rates act or are read.
using Directions = std::map<int, MatrixXd>;

Directions directions(const Graph& g, const passes::ForceGains& gains) {
  std::map<int, MatrixXd> all;
  const auto add = [&](int channel, const MatrixXd& columns) {
    MatrixXd& m = all[channel];
    m.conservativeResize(columns.rows(), m.cols() + columns.cols());
    m.rightCols(columns.cols()) = columns;
  };
  for (const auto& [pair, gain] : gains) {
    add(pair.first, gain);
    add(pair.second, gain.transpose());
  }
  Directions result;
  for (const auto& [channel, columns] : all) {
    const Index each = entries_per_unit(g.signals[at(g.channels[at(channel)].accel)]);
    MatrixXd U(columns.rows(), 0);
    for (Index row = 0; row < columns.rows(); row += each) {
      const MatrixXd own = span_of(columns.middleRows(row, each));
      const Index first = U.cols();
      U.conservativeResize(Eigen::NoChange, first + own.cols());
      U.rightCols(own.cols()).setZero();
      U.block(row, first, each, own.cols()) = own;
    }
    result[channel] = U;
  }
  return result;
}

/// F between the directions of all channels, in their order.
MatrixXd between(const Directions& directions, const passes::ForceGains& gains) {
  std::map<int, Index> first;
  Index size = 0;
  for (const auto& [channel, U] : directions) first[channel] = size, size += U.cols();
  MatrixXd F = MatrixXd::Zero(size, size);
  for (const auto& [pair, gain] : gains) {
    const MatrixXd &U = directions.at(pair.first), &V = directions.at(pair.second);
    F.block(first[pair.first], first[pair.second], U.cols(), V.cols()) = U.transpose() * gain * V;
  }
  return F;
}

/// Takes the terms of rates out of the equations of forces.
void take_out(Graph& g, ParameterValues values) {
  std::vector<Equation> kept;
  for (Equation& e : g.equations) {
    const int channel = g.signals[at(e.target)].channel;
    const auto is_rate = [&](const Term& t) {
      const auto motions = passes::of_motions(g, t, values);
      return !motions.empty() && std::all_of(motions.begin(), motions.end(),
                                             [](const auto& m) { return m.of == Term::Of::rate; });
    };
    const bool force = channel >= 0 && g.channels[at(channel)].force == e.target;
    const auto removed = force ? std::erase_if(e.terms, is_rate) : 0;
    if (removed == 0 || !e.terms.empty() || !e.accumulate) kept.push_back(std::move(e));
  }
  g.equations = std::move(kept);
}

Matrix as_factor(MatrixXd m) { return {std::make_shared<const MatrixXd>(std::move(m))}; }

/// Inputs and outputs in their place.
void open(Graph& g, const Directions& directions) {
  for (const auto& [channel, U] : directions) {
    const Channel c = g.channels[at(channel)];
    const int size = static_cast<int>(U.cols());
    if (size == 0) continue;
    const std::string name = channel_name(g, channel);
    const int w = add_input(g, fmt::format("to the rate of {}", name), size);
    g.equations.push_back({.target = c.force,
                           .accumulate = true,
                           .of_spec = true,
                           .terms = {{.signal = w,
                                      .sign = is_outward(g, channel) ? -1.0 : 1.0,
                                      .factors = {as_factor(U)}}}});
    g.outputs.push_back({.name = fmt::format("rate of {}", name),
                         .size = size,
                         .set = true,
                         .terms = {{.signal = c.accel,
                                    .of = Term::Of::rate,
                                    .factors = {as_factor(U.transpose())}}},
                         .declared = static_cast<int>(g.outputs.size())});
  }
}

}  // namespace

std::optional<RateFeedback> rate_feedback(const Graph& graph, ParameterValues values) {
  if (!has_rotors(graph, values)) return {};
  if (std::string why = passes::why_no_springs(graph, values); !why.empty())
    refuse_forces(std::move(why));
  const passes::ForceGains gains = passes::rate_gains(graph, values);
  if (gains.empty()) return {};
  RateFeedback f{graph, {}, {}, passes::momenta_text(passes::gyroscopic_points(graph, values))};
  const Directions list = directions(graph, gains);
  for (const auto& [channel, U] : list)
    f.ports.insert(f.ports.end(), at(U.cols()), channel_name(graph, channel));
  f.F = between(list, gains);
  take_out(f.graph, values);
  open(f.graph, list);
  return f;
}

}  // namespace titop::detail
