#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/compiler/passes/check/checker.hpp>
#include <titop/compiler/passes/check/dual_pairs.hpp>
#include <titop/compiler/passes/check/springs.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/with_warnings.hpp>

namespace titop::passes {
namespace {

using Eigen::MatrixXd;
using linalg::at;

/// Gains from a channel's own position and rate to its force: direct ones, not through other blocks
/// or points. In the signs of work: springs and dampers are positive.
struct OwnGains {
  MatrixXd position, rate;           ///< empty: none
  std::vector<const Equation*> all;  ///< with such terms
  std::string spring, damper;        ///< names of the readings that they follow
};

/// A reading of this channel: its own port's, or its joint's angle.
bool may_be_of(const Graph& g, const Term& t, int channel) {
  const Signal& s = g.signals[at(t.signal)];
  if (t.of == Term::Of::position || t.of == Term::Of::rate) return s.channel == channel;
  return s.role == Signal::Role::output && s.channel < 0 && s.node == g.channels[at(channel)].node;
}

std::map<int, OwnGains> own_gains(const Graph& g, ParameterValues values) {
  std::map<int, OwnGains> result;
  for (const Equation& e : g.equations) {
    const int channel = g.signals[at(e.target)].channel;
    if (channel < 0 || g.channels[at(channel)].force != e.target) continue;
    for (const Term& t : e.terms) {
      if (!may_be_of(g, t, channel)) continue;
      for (const OfMotion& m : of_motions(g, t, values)) {
        if (m.channel != channel || m.gain.isZero(0)) continue;
        OwnGains& own = result[channel];
        const bool spring = m.of == Term::Of::position;
        MatrixXd& sum = spring ? own.position : own.rate;
        const MatrixXd gain =
            e.part.whole() ? m.gain : MatrixXd(e.part.rows().transpose() * m.gain);
        if (sum.size() == 0) sum.setZero(gain.rows(), gain.cols());
        sum += is_outward(g, channel) ? gain : MatrixXd(-gain);
        (spring ? own.spring : own.damper) = print(g, Term{t.signal, t.of, 1, {}});
        if (own.all.empty() || own.all.back() != &e) own.all.push_back(&e);
      }
    }
  }
  return result;
}

/// True if it is negative along one of the axes that the equation drives, beyond the rounding of a
/// 0 after rotation, among three translations or rotations.
bool negative(const MatrixXd& gain, const Equation& e) {
  if (gain.size() == 0) return false;
  const MatrixXd& rows = e.part.rows();
  const MatrixXd along = e.part.whole() ? gain : MatrixXd(rows * gain * rows.transpose());
  const Eigen::Index half = along.rows() == 6 ? 3 : along.rows();
  const double largest = gain.cwiseAbs().maxCoeff();
  for (Eigen::Index first = 0; first < along.rows(); first += half) {
    const auto own = along.block(first, first, half, half);
    if (own.diagonal().minCoeff() < -linalg::kAxisRounding * largest) return true;
  }
  return false;
}

/// A negative spring is the most frequent mistake of sign, and sometimes intended.
void note_negative_springs(Checker& c, ParameterValues values) {
  for (const auto& [channel, own] : own_gains(c.graph, values)) {
    const char sign = is_outward(c.graph, channel) ? '+' : '-';
    for (const Equation* e : own.all) {
      std::string right;
      if (negative(own.position, *e))
        right = fmt::format("a spring is {} k * {}", sign, own.spring);
      if (negative(own.rate, *e))
        right +=
            fmt::format("{}a damper is {} c * {}", right.empty() ? "" : ", ", sign, own.damper);
      if (right.empty()) continue;
      c.notes.push_back({Note::Kind::warning, "check",
                         fmt::format("{} is destabilising: {} ({}); ignore this if it is intended",
                                     print(c.graph, *e), right, written(c.graph, *e).text())});
    }
  }
}

/// True if the term is an input as it is, at most rotated, with the sign +.
bool is_plain_input(const Graph& g, const Term& t) {
  return g.signals[at(t.signal)].role == Signal::Role::external && t.sign > 0 &&
         std::none_of(t.factors.begin(), t.factors.end(), [](const Factor& f) {
           return std::holds_alternative<Value>(f) || std::holds_alternative<Matrix>(f);
         });
}

/// A parent's force is the wrench on the parent: an input on the body has the sign -.
void note_signs_of_inputs(Checker& c) {
  const Graph& g = c.graph;
  for (const Equation& e : g.equations) {
    const Signal& target = g.signals[at(e.target)];
    if (target.channel < 0 || target.quantity != Quantity::force) continue;
    const Node& node = g.nodes[at(target.node)];
    if (node.block->interface().channels[at(target.spec)].name != "parent") continue;
    for (const Term& t : e.terms) {
      if (!is_plain_input(g, t)) continue;
      const std::string port = name_of(g, e.target) + e.part.name(), input = print(g, t);
      c.notes.push_back(
          {Note::Kind::info, "check",
           fmt::format("{} is the wrench that {} exerts on its parent: in {} the input acts on {} "
                       "as -{}; for {} on {} write {} {} -{} ({})",
                       port, node.name, print(g, e), node.name, input, input, node.name, port,
                       e.accumulate ? "+=" : "=", input, written(g, e).text())});
    }
  }
}

void note_no_outputs(Checker& c) {
  if (c.graph.inputs.empty() || !c.graph.outputs.empty()) return;
  c.notes.push_back({Note::Kind::warning, "check",
                     "the diagram has inputs, but no output: write d.output(\"x\") = ..., or, of "
                     "size 6, d.output(\"a\", 6) = ..."});
}

/// An input that is not read: a line may have been forgotten.
void note_unread_inputs(Checker& c) {
  const Graph& g = c.graph;
  std::vector<char> read(g.signals.size(), 0);
  const auto mark = [&](const std::vector<Term>& terms) {
    for (const Term& t : terms) read[at(t.signal)] = 1;
  };
  for (const Equation& e : g.equations) mark(e.terms);
  for (const Output& o : g.outputs) mark(o.terms);
  for (const Input& input : g.inputs)
    if (!read[at(input.signal)])
      c.notes.push_back(
          {Note::Kind::warning, "check",
           fmt::format("no equation and no output reads the input {} ({}): write it on the right "
                       "of one, or remove it",
                       input.name, written(g.inputs, "inputs", input).text())});
}

constexpr double kTurn = 2 * std::numbers::pi * (1 + 1e-9);  ///< a whole turn may be rounded up

}  // namespace

std::vector<RotationAngle> rotation_angles(const Graph& g, ParameterValues values) {
  std::vector<RotationAngle> result;
  const auto look = [&](const std::vector<Term>& terms, const auto& where) {
    for (const Term& t : terms)
      for (const Factor& f : t.factors)
        if (const auto* T = std::get_if<Rotation>(&f))
          for (const Value& angle : T->values())
            if (angle.is_parameter() || std::abs(angle.at(values)) > kTurn)
              result.push_back({angle, where()});
  };
  for (const Equation& e : g.equations)
    look(e.terms, [&] { return name_of(g, e.target) + ", " + written(g, e).text(); });
  for (const Output& o : g.outputs)
    look(o.terms, [&] {
      return fmt::format("output {}, {}", o.name, written(g.outputs, "outputs", o).text());
    });
  return result;
}

std::vector<Note> degree_notes(const std::vector<RotationAngle>& angles, ParameterValues values) {
  std::map<double, std::string_view> seen;
  for (const RotationAngle& a : angles)
    if (const double size = std::abs(a.angle.at(values)); size > kTurn) seen.emplace(size, a.where);
  std::vector<Note> result;
  for (const auto& [angle, where] : seen)
    result.push_back({Note::Kind::warning, "check",
                      fmt::format("a rotation by {0:.6g} rad is more than a turn ({1}): angles are "
                                  "in radians, {0:.6g} degrees are {2:.6g} rad",
                                  angle, where, angle * std::numbers::pi / 180)});
  return result;
}

namespace {

void note_warnings_of_blocks(Checker& c) {
  for (const Node& node : c.graph.nodes)
    if (const auto* block = dynamic_cast<const WithWarnings*>(node.block.get()))
      for (const std::string& line : block->warnings())
        c.notes.push_back({Note::Kind::warning, "check", fmt::format("{}: {}", node.name, line)});
}

}  // namespace

void note_rarely_meant(Checker& c, ParameterValues values) {
  note_warnings_of_blocks(c);
  note_free_lines(c);
  note_negative_springs(c, values);
  note_signs_of_inputs(c);
  note_no_outputs(c);
  note_unread_inputs(c);
}

}  // namespace titop::passes
