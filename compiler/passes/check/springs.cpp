#include <fmt/format.h>

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <map>
#include <titop/compiler/passes/check/dual_pairs.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <titop/graph/support/each_once.hpp>
#include <utility>

namespace titop::passes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using linalg::at;

ForceGains gains(const Graph& g, ParameterValues values, Term::Of of) {
  ForceGains result;
  for (const Equation& e : g.equations) {
    const int force = g.signals[at(e.target)].channel;
    if (force < 0) continue;
    const double sign = is_outward(g, force) ? 1 : -1;
    for (const Term& t : e.terms)
      for (const OfMotion& m : of_motions(g, t, values)) {
        if (m.of != of || m.gain.isZero(0)) continue;
        MatrixXd& sum = result[{force, m.channel}];
        if (sum.size() == 0) sum.setZero(g.channels[at(force)].size, m.gain.cols());
        sum += sign * (e.part.whole() ? m.gain : MatrixXd(e.part.rows().transpose() * m.gain));
      }
  }
  return result;
}

/// The inputs of a block that a one-way output is the rate or the position of, with their gains.
struct IntegratedInputs {
  Term::Of of = Term::Of::rate;
  MatrixXd of_inputs = {};  ///< no columns: none
};

IntegratedInputs integrated(const Dynamics& d, const Signal& output) {
  if (d.A.size() == 0 || d.C.rows() < output.first + output.size ||
      !d.D.middleRows(output.first, output.size).isZero(0))
    return {};
  MatrixXd C = d.C.middleRows(output.first, output.size);
  for (const Term::Of of : {Term::Of::rate, Term::Of::position}) {
    const MatrixXd moved = C * d.B;
    C = C * d.A;
    if (!moved.isZero(0)) return C.isZero(0) ? IntegratedInputs{of, moved} : IntegratedInputs{};
  }
  return {};
}

/// Channels that the gains tie together, in ascending order.
std::vector<std::vector<int>> tied(const ForceGains& gains, std::size_t channels) {
  boost::disjoint_sets_with_storage<> sets(channels);
  std::map<std::size_t, std::vector<int>> by_set;
  std::vector<int> all;
  for (const auto& [pair, gain] : gains) {
    sets.union_set(at(pair.first), at(pair.second));
    all.insert(all.end(), {pair.first, pair.second});
  }
  detail::keep_each_once(all);
  for (const int c : all) by_set[sets.find_set(at(c))].push_back(c);
  std::vector<std::vector<int>> result;
  for (auto& [set, list] : by_set) result.push_back(std::move(list));
  return result;
}

/// Gains among these channels as one matrix. Axes that share a unit have the size of the largest
/// gain among them: a 0 after rotations is no spring, and no fault.
struct Among {
  MatrixXd K;
  Eigen::VectorXd size;
  std::vector<Index> units;  ///< axes that share one, in the order of the rows

  Among(const std::vector<int>& channels, const Graph& g, const ForceGains& gains) {
    std::map<int, Index> first;
    Index rows = 0;
    for (const int c : channels) first[c] = std::exchange(rows, rows + g.channels[at(c)].size);
    K.setZero(rows, rows);
    for (const auto& [pair, gain] : gains)
      if (const auto row = first.find(pair.first); row != first.end())
        K.block(row->second, first.at(pair.second), gain.rows(), gain.cols()) = gain;
    size = K.diagonal();
    for (const auto& [c, row] : first) {
      const int each = entries_per_unit(g.signals[at(g.channels[at(c)].accel)]);
      for (Index i = row; i < row + g.channels[at(c)].size; i += each) {
        auto unit = size.segment(i, each);
        unit.setConstant(unit.maxCoeff());
        units.push_back(each);
      }
    }
  }

  /// For the gains of rates: the rest is gyroscopic. Rounding of its rotations is 0.
  void leave_symmetric_part() {
    const MatrixXd whole = K;
    K = (whole + whole.transpose()) / 2;
    for (Index i = 0, row = 0; i < std::ssize(units); row += units[at(i++)])
      for (Index j = 0, column = 0; j < std::ssize(units); column += units[at(j++)]) {
        const double largest =
            whole.block(row, column, units[at(i)], units[at(j)]).cwiseAbs().maxCoeff();
        auto block = K.block(row, column, units[at(i)], units[at(j)]);
        block = (block.array().abs() > linalg::kAxisRounding * largest).select(block, 0.0).eval();
      }
    for (Index i = 0, row = 0; i < std::ssize(units); row += units[at(i++)])
      size.segment(row, units[at(i)])
          .setConstant(K.diagonal().segment(row, units[at(i)]).maxCoeff());
  }

  bool symmetric_and_semidefinite() const {
    if (!K.allFinite()) return false;
    Eigen::VectorXd scale = Eigen::VectorXd::Zero(size.size());
    for (Index i = 0; i < size.size(); ++i) {
      if (size(i) > 0)
        scale(i) = 1 / std::sqrt(size(i));
      else if (!K.row(i).isZero(0) || !K.col(i).isZero(0))
        return false;
    }
    const MatrixXd S = scale.asDiagonal() * K * scale.asDiagonal();
    return (S - S.transpose()).cwiseAbs().maxCoeff() <= linalg::kAxisRounding &&
           eigh(S).lambda.minCoeff() >= -linalg::kAxisRounding * static_cast<double>(S.rows());
  }
};

}  // namespace

std::vector<OfMotion> of_motions(const Graph& g, const Term& t, ParameterValues values) {
  const Signal& s = g.signals[at(t.signal)];
  if (t.of == Term::Of::position || t.of == Term::Of::rate)
    return {{t.of, s.channel, coefficient(g, t, values)}};
  if (s.role != Signal::Role::output || s.channel >= 0) return {};
  const Node& node = g.nodes[at(s.node)];
  const IntegratedInputs found = integrated(*node.block->dynamics(values), s);
  if (found.of_inputs.size() == 0) return {};
  const MatrixXd gain = coefficient(g, t, values) * found.of_inputs;
  MatrixXd rest = found.of_inputs;
  std::vector<OfMotion> result;
  const auto& channels = node.block->interface().channels;
  for (int k = 0; k < static_cast<int>(channels.size()); ++k) {
    if (channels[at(k)].takes != Takes::accel) continue;
    const Signal& taken = g.signals[at(g.channels[at(node.first_channel + k)].accel)];
    result.push_back({found.of, node.first_channel + k, gain.middleCols(taken.first, taken.size)});
    rest.middleCols(taken.first, taken.size).setZero();
  }
  return rest.isZero(0) ? result : std::vector<OfMotion>{};
}

std::string why_no_springs(const Graph& g, ParameterValues values) {
  for (const Term::Of of : {Term::Of::position, Term::Of::rate}) {
    const ForceGains all = gains(g, values, of);
    for (const std::vector<int>& channels : tied(all, g.channels.size())) {
      Among among(channels, g, all);
      if (of == Term::Of::rate) among.leave_symmetric_part();
      if (among.symmetric_and_semidefinite()) continue;
      const auto pushed = std::find_if(channels.begin(), channels.end(), [&](int c) {
        return all.lower_bound({c, 0}) != all.lower_bound({c + 1, 0});
      });
      return fmt::format(
          "{} follows {} do", name_of(g, g.channels[at(*pushed)].force),
          of == Term::Of::position ? "positions as no springs" : "rates as no dampers");
    }
  }
  return "";
}

ForceGains gyroscopic_gains(const Graph& g, ParameterValues values) {
  const ForceGains all = gains(g, values, Term::Of::rate);
  ForceGains result;
  for (const auto& [pair, gain] : all) {
    const auto back = all.find({pair.second, pair.first});
    MatrixXd skew = gain / 2;
    if (back != all.end()) skew -= back->second.transpose() / 2;
    const bool dual = skew.size() == 36;  // forces and torques have units of their own
    const Index each = dual ? 3 : skew.rows(), width = dual ? 3 : skew.cols();
    for (Index row = 0; row < skew.rows(); row += each)
      for (Index column = 0; column < skew.cols(); column += width) {
        auto block = skew.block(row, column, each, width);
        double size = gain.block(row, column, each, width).cwiseAbs().maxCoeff();
        if (back != all.end())
          size = std::max(size, back->second.block(column, row, width, each).cwiseAbs().maxCoeff());
        if (block.cwiseAbs().maxCoeff() <= linalg::kAxisRounding * size) block.setZero();
      }
    if (skew.isZero(0)) continue;
    result[pair] = skew;
    if (back == all.end()) result[{pair.second, pair.first}] = -skew.transpose();
  }
  return result;
}

ForceGains rate_gains(const Graph& g, ParameterValues values) {
  return gains(g, values, Term::Of::rate);
}

namespace {

/// |h| if the gain on a port's rates is that of a momentum, h a x omega: torques by angular rates.
double momentum_of(const MatrixXd& gain) {
  if (gain.rows() != 6 || gain.cols() != 6) return 0;
  MatrixXd rest = gain;
  rest.bottomRightCorner<3, 3>().setZero();
  // Of an antisymmetric matrix the three entries below the diagonal, each of them twice.
  return rest.isZero(0) ? gain.norm() / std::sqrt(2.0) : 0;
}

}  // namespace

std::vector<std::pair<std::string, double>> gyroscopic_points(const Graph& g,
                                                              ParameterValues values) {
  std::map<int, double> momentum;  // by channel
  for (const auto& [pair, gain] : gyroscopic_gains(g, values)) {
    const bool own = pair.first == pair.second;
    momentum[pair.first] = std::max(momentum[pair.first], own ? momentum_of(gain) : 0);
    momentum[pair.second];
  }
  std::vector<std::pair<std::string, double>> result;
  for (const auto& [channel, h] : momentum) result.emplace_back(channel_name(g, channel), h);
  return result;
}

std::string momenta_text(const std::vector<std::pair<std::string, double>>& points) {
  std::vector<std::string> list;
  for (const auto& [port, h] : points)
    list.push_back(h > 0 ? fmt::format("{:.6g} N m s at {}", h, port)
                         : fmt::format("gyroscopic terms at {}", port));
  return fmt::format("{}", fmt::join(list, ", "));
}

}  // namespace titop::passes
