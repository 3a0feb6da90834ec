#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <titop/compiler/loops/along.hpp>
#include <titop/compiler/loops/axial_motion.hpp>
#include <titop/compiler/loops/gap.hpp>
#include <titop/compiler/loops/lines.hpp>
#include <titop/compiler/loops/may_close.hpp>
#include <titop/compiler/loops/redundant.hpp>
#include <titop/compiler/loops/reflections.hpp>
#include <titop/compiler/loops/second_order.hpp>
#include <titop/compiler/loops/still.hpp>
#include <titop/compiler/passes/lower/lowering.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/some_names.hpp>
#include <utility>

namespace titop::passes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace loops;
using linalg::at;

/// Largest gap of a loop through a body with springs along all six axes, which constrains nothing:
/// its force leaves a torque of force times gap, and momentum is lost by this share. Other loops
/// close to the digits of typed numbers.
constexpr double kGapOfSpring = 1e-5;

// --- geometry -----------------------------------------------------------------------------------

std::string way(const Motion& motion, const Closing& c) {
  std::string text;
  for (std::size_t i = 0; i < c.chain.size(); ++i) {
    if (i == 8 && c.chain.size() > 10) {
      text += fmt::format(" - ... - {}", motion.name(c.chain.back()));
      break;
    }
    text += (i ? " - " : "") + motion.name(c.chain[i]);
  }
  return text;
}

/// "4.0e-07 m", "1.0e-03 rad".
std::string gap_size(const Closing& c, double gap) {
  return c.gap_length > 0 ? fmt::format("{:.1e} m", gap * c.gap_length)
                          : fmt::format("{:.1e} rad", gap);
}

struct ChainChecker {
  const Graph& g;
  const Motion& motion;
  const StateRates& coordinates;
  std::vector<Mistake> mistakes = {};
  std::vector<Note> notes = {};

  std::string target(const Closing& c) const {
    return name_of(g, g.equations[at(c.tie->equation)].target);
  }
  void refuse(const Closing& c, std::string subject, std::string hint) {
    const Equation& e = g.equations[at(c.tie->equation)];
    mistakes.push_back({Code::kinematic_loop,
                        std::move(subject),
                        {fmt::format("{:<50} {}", print(g, e), to_string(e.where)),
                         "the chain: " + way(motion, c)},
                        std::move(hint)});
  }

  /// The blocks on the chain must define the kinematics of their ports.
  void check_blocks(const Closing& c) {
    if (const int node = motion.silent(c.chain); node >= 0)
      return refuse(c,
                    fmt::format("{} closes a chain through {}, whose block does not define the "
                                "positions of its ports",
                                target(c), g.nodes[at(node)].name),
                    "give its block kinematics() (docs/architecture.md), or open one joint");
    for (const auto& [column, matrix] : c.form)
      if (column.kind == FormColumn::Kind::states)
        for (Index j = 0; j < matrix.cols(); ++j)
          if (!matrix.col(j).isZero(0) && coordinates.rate_of(column.id, static_cast<int>(j)) < 0)
            return refuse(
                c,
                fmt::format(
                    "{} closes a chain through {}, whose state {} has no rate among its "
                    "states",
                    target(c), g.nodes[at(column.id)].name,
                    g.nodes[at(column.id)].block->interface().states[static_cast<std::size_t>(j)]),
                "positions in kinematics() must be states whose derivatives are states too");
  }

  void check_gap(const Closing& c) {
    const double most =
        c.gap > linalg::kTextDigits && has_spring(c.form) ? kGapOfSpring : linalg::kTextDigits;
    if (c.gap > most)
      refuse(c,
             fmt::format("{} closes a chain whose ends do not meet: gap {}, {:.1e} of its size, "
                         "more than {}",
                         target(c), gap_size(c, c.gap), c.gap, gap_size(c, most)),
             "check the lengths and rotations around the chain; the mounting rotations give the "
             "joints' posture");
    else if (c.gap > kMatrixDigits)
      notes.push_back({Note::Kind::warning, "chains",
                       fmt::format("{} closes its chain only to {:.1e} of its size, {}: a force "
                                   "across it leaves a torque of force times gap",
                                   target(c), c.gap, gap_size(c, c.gap))});
  }
};

// --- redundant closures --------------------------------------------------------------------------

MatrixXd orthonormal_rows(const MatrixXd& m) {
  const Eigen::HouseholderQR<MatrixXd> qr(m.transpose());
  MatrixXd Q = (qr.householderQ() * MatrixXd::Identity(m.cols(), m.rows())).transpose();
  Q = (Q.array().abs() < linalg::kAxisRounding).select(0.0, Q);
  for (Index i = 0; i < Q.rows(); ++i) Q.row(i).normalize();
  // The span of unit vectors is spanned by them: their zeros and ones stay exact.
  const Eigen::VectorXd share = Q.colwise().squaredNorm();
  MatrixXd units(0, Q.cols());
  for (Index j = 0; j < share.size(); ++j)
    if (share(j) > 1 - linalg::kAxisRounding) {
      units.conservativeResize(units.rows() + 1, Q.cols());
      units.bottomRows(1) = Eigen::RowVectorXd::Unit(Q.cols(), j);
    }
  return units.rows() == Q.rows() ? units : Q;
}

/// The rows of an equation that `rows` keeps, as an equation.
void keep_rows(Graph& g, Equation& e, const MatrixXd& rows) {
  const int size = g.signals[at(e.target)].size;
  e.part = {e.part.whole() ? rows : MatrixXd(rows * e.part.rows()), e.part.name() + ".independent"};
  if (e.part.rows().rows() == size && e.part.rows().isIdentity(0)) e.part = {};
  for (Term& t : e.terms) {
    const auto& m = std::get<Matrix>(t.factors.front());
    const Pattern p = structure(g, t);
    const Pattern kept = ((rows.array() != 0).cast<int>().matrix() * p.cast<int>()).array() > 0;
    t.factors = {Matrix{std::make_shared<const MatrixXd>(rows * *m.value),
                        std::make_shared<const Pattern>(kept)}};
  }
}

/// An equation some of whose rows depend on other equations.
struct EquationSplit {
  MatrixXd directions;  ///< orthonormal rows
  MatrixXd kept;        ///< unit rows: with the dependent ones equivalent to the equation
};

/// From k dependent directions among scaled rows. The kept rows are original ones (those of the
/// largest pivots are removed): combinations across the directions would mix translations with
/// rotations, and in a mechanism of a millimetre small entries would be rounding. The same for the
/// directions: entries at rounding level among scaled rows are cleared before the factors magnify
/// them.
EquationSplit split(const MatrixXd& scaled, const Eigen::VectorXd& factors) {
  const auto n = scaled.cols();
  std::vector<int> left(static_cast<std::size_t>(n));
  std::iota(left.begin(), left.end(), 0);
  Reflections r(scaled);
  r.take(left, 0);
  std::erase_if(left, [&](int row) { return r.taken(row); });
  MatrixXd directions =
      r.matrix()(Eigen::all, r.pivots()).eval().triangularView<Eigen::Upper>().solve(r.matrix());
  directions = (directions.array().abs() < linalg::kAxisRounding).select(0.0, directions);
  directions(Eigen::all, r.pivots()).setIdentity();
  return {orthonormal_rows(directions * factors.asDiagonal()),
          MatrixXd(MatrixXd::Identity(n, n))(left, Eigen::all)};
}

/// Releases the joint in these directions (rows, in the space of the equation's rows): it transmits
/// no force, and the wrench at its point is the sum of the other terms. The equation keeps the
/// other rows.
void release(Stage& stage, int equation, const EquationSplit& parts, Lowering& lowering) {
  Graph& g = stage.graph;
  const auto& [directions, kept] = parts;
  const MatrixXd S = g.equations[at(equation)].part.whole()
                         ? MatrixXd::Identity(directions.cols(), directions.cols())
                         : g.equations[at(equation)].part.rows();
  const int channel = g.signals[at(g.equations[at(equation)].target)].channel;
  Equation force{.target = g.channels[at(channel)].force,
                 .part = {directions * S, ".redundant"},
                 .where = g.equations[at(equation)].where};
  Origin others{.of = Origin::Of::released, .index = channel, .times = force.part.rows()};
  if (directions.rows() == g.channels[at(channel)].size) force.part = {}, others.times = {};
  force.terms = lowering.written_out(others);
  if (kept.rows() == 0) {
    stage.released.push_back({equation, channel, equation, g.equations[at(equation)]});
    g.equations[at(equation)] = force;
    stage.origins[at(equation)] = std::move(others);
    return;
  }
  const auto fresh = static_cast<int>(g.equations.size());
  stage.released.push_back({fresh, channel, equation, g.equations[at(equation)]});
  keep_rows(g, g.equations[at(equation)], kept);
  stage.origins[at(equation)].times = kept;
  stage.origins.insert(stage.origins.begin() + static_cast<std::ptrdiff_t>(g.equations.size()),
                       std::move(others));
  g.equations.push_back(std::move(force));
}

std::string direction_names(const MatrixXd& directions) {
  static constexpr const char* kNames[] = {"x", "y", "z", "about x", "about y", "about z"};
  if (directions.cols() != 6 || directions.rows() == directions.cols()) return {};
  std::string text;
  for (Index i = 0; i < directions.rows(); ++i) {
    Index j = 0;
    if (!(directions.row(i).cwiseAbs().maxCoeff(&j) > 1 - linalg::kAxisRounding)) return {};
    text += (i ? ", " : "") + std::string(kNames[j]);
  }
  return " (" + text + ")";
}

/// Names of the flexible bodies without axial motion, if no joint moves in these chains: the modes
/// of bodies are their only coordinates.
std::vector<std::string> bodies_without_axial_motion(const Component& c, const Stage& stage) {
  std::set<int> bodies;
  for (const ScalarColumn& s : c.scalars) {
    if (s.column.kind == FormColumn::Kind::angle) return {};
    if (s.column.kind == FormColumn::Kind::states) bodies.insert(s.column.id);
  }
  return without_axial_motion(bodies, stage);
}

/// Chains in a singular posture have additional first-order motions that second order blocks.
void warn_of_stops(Stage& stage, const Component& c, const ScaleFactors& factors,
                   const std::vector<const Closing*>& in_order) {
  constexpr double kStops = 1e-6;  // rounding gives 1e-15, a singular posture some tenths
  std::vector<const Closing*> closings;
  std::vector<std::string> names;
  for (const int l : c.lines) {
    closings.push_back(in_order[at(l)]);
    names.push_back(
        name_of(stage.graph, stage.graph.equations[at(in_order[at(l)]->tie->equation)].target));
  }
  const double part = stopped(c, factors, closings, stage.graph);
  if (!(part > kStops)) return;
  const std::vector<std::string> rods = bodies_without_axial_motion(c, stage);
  const std::string cause =
      rods.empty() ? "is in a singular posture"
                   : fmt::format(
                         "has no joint, and no kept mode of {} moves a child point along "
                         "the line from P",
                         detail::some_names(rods));
  stage.notes.push_back(
      {Note::Kind::warning, "chains",
       fmt::format("the chain closed by {} {}: its equations block, at second order, motions that "
                   "they allow to first order (relative residual {:.1e}), and the model contains "
                   "these motions; {}",
                   detail::some_names(names), cause, part,
                   rods.empty() ? "change the posture slightly, or lock a joint"
                                : "keep modes with axial motion, or residual vectors")});
}

/// Returns the points that the chains immobilise.
AtRest release_redundant(Stage& stage, const std::vector<Closing>& closings) {
  AtRest held;
  std::optional<Lowering> lowering;  // few chains are closed twice
  std::vector<RelationRows> lines;
  std::vector<const Closing*> in_order;
  for (const int c : along(closings)) {
    in_order.push_back(&closings[at(c)]);
    lines.push_back(line_of(closings[at(c)]));
  }
  const StateRates coordinates(stage.graph, stage.values);
  // All motions count, prescribed ones too: they must satisfy redundant closures.
  const auto classify = [&](const ScalarColumn& s) -> std::optional<loops::ColumnRole> {
    const bool state = s.column.kind == FormColumn::Kind::states;
    return loops::ColumnRole{state ? Relations::Role::coordinate : Relations::Role::unknown,
                             state ? coordinates.weight(s.column.id, s.index) : 0};
  };
  for (Component& c : components(lines, classify)) {
    const ScaleFactors factors = scale(c.relations);
    const Redundancy found = redundancy(c.relations);
    if (std::ranges::any_of(found.blocks,
                            [](const Redundant& r) { return r.directions.rows() > 0; }))
      warn_of_stops(stage, c, factors, in_order);
    for (std::size_t i = 0; i < c.lines.size(); ++i) {
      const RelationRows& line = lines[at(c.lines[i])];
      const auto rows = static_cast<Index>(line.unit.size());
      const Redundant& r = found.blocks[i];
      const std::string name =
          name_of(stage.graph, stage.graph.equations[at(line.equation)].target);
      if (r.doubtful())
        stage.notes.push_back(
            {Note::Kind::warning, "chains",
             fmt::format("{}: {} of {} closing equations are independent, by a narrow margin "
                         "(smallest kept {:.1e}, largest dropped {:.1e}, tolerance {:.0e}): give "
                         "angles and lengths to all their digits",
                         name, rows - r.directions.rows(), rows, r.weakest, r.dropped,
                         kMatrixDigits)});
      if (r.directions.rows() == 0) continue;
      const EquationSplit parts = split(r.directions, factors.row[i]);
      stage.notes.push_back(
          {Note::Kind::info, "chains",
           fmt::format("{}: {} of {} closing equations are redundant{}; internal forces there are "
                       "not determined",
                       name, r.directions.rows(), rows, direction_names(parts.directions))});
      if (!lowering)
        lowering.emplace(
            *stage.source, stage.values,
            stage.drives ? stage.drives : std::make_shared<const Drives>(*stage.source),
            stage.motions);
      release(stage, line.equation, parts, *lowering);
    }
    for (const int j : found.held)
      if (c.scalars[at(j)].column.kind != FormColumn::Kind::prescribed)
        held.insert(c.scalars[at(j)]);
  }
  return held;
}

}  // namespace

namespace {

/// Equations that close a chain, and are in use.
std::vector<Closing> closings_of(const Graph& g, const Motion& motion) {
  std::vector<Closing> result;
  for (const Tie& tie : motion.ties())
    if (tie.closes && g.equations[at(tie.equation)].active) result.push_back(motion.closing(tie));
  return result;
}

/// Throws the mistakes in the chains; notes narrow decisions.
void check_chains(Stage& stage, const SumExpander& sums, const Motion& motion,
                  const std::vector<Closing>& closings) {
  const StateRates coordinates(stage.graph, stage.values);
  ChainChecker blocks{stage.graph, motion, coordinates};
  for (const Closing& c : closings) blocks.check_blocks(c);
  if (!blocks.mistakes.empty()) throw Error(std::move(blocks.mistakes));
  const Motion geometry(stage.graph, stage.values, sums, Ground::last);
  ChainChecker gaps{stage.graph, geometry, coordinates};
  for (const Closing& c : closings_of(stage.graph, geometry)) gaps.check_gap(c);
  if (!gaps.mistakes.empty()) throw Error(std::move(gaps.mistakes));
  stage.notes.insert(stage.notes.end(), gaps.notes.begin(), gaps.notes.end());
}

}  // namespace

Stage chains(Stage stage) {
  if (!may_close(stage.graph, stage.values)) return stage;
  stage.closes = true;
  const SumExpander sums(stage.graph);
  const Motion motion(stage.graph, stage.values, sums);
  const std::vector<Closing> closings = closings_of(stage.graph, motion);
  check_chains(stage, sums, motion, closings);
  stage.chained = !closings.empty();
  if (stage.chained) hold_still(stage, motion, closings, release_redundant(stage, closings));
  return stage;
}

}  // namespace titop::passes
