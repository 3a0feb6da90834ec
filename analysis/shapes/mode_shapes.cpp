#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <titop/analysis/shapes/mode_shapes.hpp>
#include <titop/analysis/shapes/places.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Complex = std::complex<double>;
using detail::PlacedPoint;
using Eigen::Index;
using Eigen::MatrixXcd;
using linalg::at;

constexpr const char* kMotion = "motion of ";  ///< outputs that are added
/// A circle leaves a factor of 10 to the poles inside and outside of it. By the trapezoidal rule
/// with 16 points, which is exact for a power below 16, these change the residue by 10^-16.
constexpr double kApart = 100;
constexpr int kOnCircle = 16;

/// "wing.C1"
std::string point_name(const Graph& g, int channel) {
  const Channel& c = g.channels[at(channel)];
  const Node& n = g.nodes[at(c.node)];
  return n.name + "." + n.block->interface().channels[at(c.spec)].name;
}

bool is_spatial_or_axis(const Channel& c) { return c.size == 6 || c.size == 1; }

/// Forces at all points, of a diagram without inputs.
void add_forces(Graph& g) {
  for (std::size_t c = 0; c < g.channels.size(); ++c) {
    const Channel channel = g.channels[c];
    if (channel.takes != Takes::force || !is_spatial_or_axis(channel)) continue;
    const int w = add_input(g, "force at " + point_name(g, static_cast<int>(c)), channel.size);
    Equation e{.target = channel.force, .accumulate = true};
    e.terms = {{.signal = w}};
    g.equations.push_back(std::move(e));
  }
}

/// The diagram with the accelerations of all points as outputs.
System with_points(const System& system) {
  return System(detail::compile_rewritten(detail::data_of(system), [](const Stage& stage) {
    Stage begin;
    begin.values = stage.values;
    begin.motions = stage.motions;
    begin.before = stage.dependents;
    Graph g = stage.written();
    for (std::size_t c = 0; c < g.channels.size(); ++c) {
      if (!is_spatial_or_axis(g.channels[c])) continue;
      Output output{.name = kMotion + point_name(g, static_cast<int>(c)),
                    .size = g.channels[c].size,
                    .set = true};
      output.terms = {{.signal = g.channels[c].accel}};
      output.declared = static_cast<int>(g.outputs.size());
      g.outputs.push_back(std::move(output));
    }
    if (g.inputs.empty()) add_forces(g);
    begin.source = std::make_shared<const Graph>(std::move(g));
    return begin;
  }));
}

/// First row of each point among the outputs.
std::vector<Index> rows_of_points(const System& system, const std::vector<PlacedPoint>& points) {
  std::map<std::string, Index> row;
  for (std::size_t i = 0; i < system.outputs().size(); ++i)
    row.insert({system.outputs()[i], static_cast<Index>(i)});
  std::vector<Index> rows;
  const Graph& g = system.stage().graph;
  for (const PlacedPoint& p : points) {
    const std::string name = kMotion + point_name(g, p.channel);
    rows.push_back(row.at(g.channels[at(p.channel)].size == 1 ? name : name + "(1)"));
  }
  return rows;
}

/// Radius of a circle around s that contains the poles that are equal to it, and no other.
double radius_around(Complex s, const std::vector<Pole>& poles) {
  std::vector<double> distances;
  for (const Pole& p : poles) {
    distances.push_back(std::abs(p.s - s));
    if (p.pair) distances.push_back(std::abs(std::conj(p.s) - s));
  }
  std::sort(distances.begin(), distances.end());
  double inside = linalg::kSameFrequency * std::abs(s);
  for (const double d : distances) {
    if (d > kApart * inside) return std::sqrt(inside * d);
    inside = std::max(inside, d);
  }
  return inside * std::sqrt(kApart);
}

/// Residue of the transfer to all points: translations and rotations of each, 6 rows, by inputs.
struct PoleResidue {
  MatrixXcd motion;
  double radius = 0;  ///< of the circle
  double around = 0;  ///< largest entry of (s - pole) T(s) on the circle
};

class PointMotions {
 public:
  explicit PointMotions(const System& system)
      : system_(with_points(system)),
        places_(detail::places(system_.stage().graph, system_.stage().values)),
        rows_(rows_of_points(system_, places_.points)),
        poles_(system_.poles()) {}

  const detail::Places& places() const { return places_; }
  const Graph& graph() const { return system_.stage().graph; }
  ParameterValues values() const { return system_.stage().values; }

  PoleResidue residue(Complex pole) const {
    const double radius = radius_around(pole, poles_);
    const auto inputs = static_cast<Index>(system_.inputs().size());
    PoleResidue sum{MatrixXcd::Zero(6 * std::ssize(rows_), inputs), radius};
    for (int k = 0; k < kOnCircle; ++k) {
      const Complex step = std::polar(radius, (2 * k + 1) * std::numbers::pi / kOnCircle);
      const MatrixXcd term = step * motions(pole + step);
      sum.motion += term / kOnCircle;
      if (term.size() > 0) sum.around = std::max(sum.around, term.cwiseAbs().maxCoeff());
    }
    return sum;
  }

 private:
  /// Displacements of all points for accelerations of the channels, over s^2.
  MatrixXcd motions(Complex s) const {
    const MatrixXcd T = system_.transfer(s) / (s * s);
    MatrixXcd list(6 * std::ssize(rows_), T.cols());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const PlacedPoint& p = places_.points[i];
      const auto own = T.middleRows(rows_[i], p.translation.cols());
      list.middleRows(static_cast<Index>(6 * i), 3) = p.translation.cast<Complex>() * own;
      list.middleRows(static_cast<Index>(6 * i) + 3, 3) = p.rotation.cast<Complex>() * own;
    }
    return list;
  }

  System system_;
  detail::Places places_;
  std::vector<Index> rows_;
  std::vector<Pole> poles_;
};

/// Largest translation 1 m, or largest rotation 1 rad without translations; in the phase of the
/// largest sum of squares.
ModeShape normalized(const Eigen::VectorXcd& motion) {
  const Eigen::Map<const Eigen::Matrix<Complex, 6, Eigen::Dynamic>> all(motion.data(), 6,
                                                                        motion.size() / 6);
  ModeShape shape{0, {}, all.topRows(3), all.bottomRows(3)};
  const double rotated = shape.rotation.colwise().norm().maxCoeff();
  double size = shape.translation.colwise().norm().maxCoeff();
  const bool turns_only = size <= linalg::kHalfDigits * rotated;
  if (turns_only) size = rotated, shape.translation.setZero();
  const auto& leading = turns_only ? shape.rotation : shape.translation;
  Complex phase = std::polar(1.0, -std::arg(leading.cwiseProduct(leading).sum()) / 2);
  Index row = 0, col = 0;
  leading.cwiseAbs().maxCoeff(&row, &col);
  if ((phase * leading(row, col)).real() < 0) phase = -phase;
  shape.translation *= phase / size;
  shape.rotation *= phase / size;
  return shape;
}

/// No shape of a pole, with the reason.
Mistake without_shape(const Pole& p, const char* why, const char* way_out) {
  return {Code::bad_value,
          fmt::format("the pole at {:.6g} rad/s has no mode shape: {}", p.omega, why),
          {},
          way_out};
}

/// Adds the shape to `modes`, or the reason why there is none to `without`.
void add_shape(const PointMotions& points, const std::vector<Pole>& poles, int index,
               std::vector<ModeShape>& modes, std::vector<Mistake>& without) {
  const Pole& pole = poles[at(index)];
  if (pole.omega == 0)
    return without.push_back(
        without_shape(pole, "its motion is rigid", "take a pole of an elastic mode"));
  const PoleResidue residue = points.residue(pole.s);
  Index before = 0;  // equal poles that come first in the list
  for (int i = 0; i < index; ++i) before += std::abs(poles[at(i)].s - pole.s) < residue.radius;
  const Eigen::JacobiSVD<MatrixXcd> svd(residue.motion, Eigen::ComputeThinU);
  const double negligible = linalg::kHalfDigits * residue.around;
  if (before >= svd.singularValues().size() || svd.singularValues()(before) <= negligible)
    return without.push_back(
        without_shape(pole, "no input moves a point in it",
                      "add an input that excites it; modes of controllers move no point"));
  modes.push_back(normalized(svd.matrixU().col(before)));
  modes.back().index = index;
  modes.back().pole = pole;
}

/// Lines from the parent point of each body to its other points.
std::vector<std::pair<int, int>> lines_of(const Graph& g, const std::vector<PlacedPoint>& points,
                                          ParameterValues values) {
  std::vector<int> point_of(g.channels.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i)
    point_of[at(points[i].channel)] = static_cast<int>(i);
  std::vector<std::pair<int, int>> lines;
  for (const Node& n : g.nodes) {
    const auto count = static_cast<int>(n.block->interface().channels.size());
    const auto k = count > 0 ? n.block->kinematics(values) : std::nullopt;
    if (!k) continue;
    const int parent = point_of[at(n.first_channel + k->reference)];
    for (int i = 0; i < count; ++i)
      if (const int child = point_of[at(n.first_channel + i)];
          i != k->reference && child >= 0 && parent >= 0)
        lines.emplace_back(parent, child);
  }
  return lines;
}

}  // namespace

ModeShapes mode_shapes(const System& system, std::span<const int> wanted) {
  const std::vector<Pole> poles = system.poles();
  for (const int index : wanted)
    if (index < 0 || index >= std::ssize(poles))
      throw Error(
          Code::unknown_name, fmt::format("there is no pole {}", index),
          fmt::format("{} has {} poles, counted from 0", system.stage().graph.name, poles.size()));
  const PointMotions motions(system);
  const std::vector<PlacedPoint>& points = motions.places().points;
  if (points.empty())
    throw Error(Code::bad_value,
                fmt::format("{} has no point whose place is known", system.stage().graph.name),
                "mode shapes need bodies with ports of six degrees of freedom");
  ModeShapes result;
  for (const PlacedPoint& p : points)
    result.points.push_back({point_name(motions.graph(), p.channel), p.place});
  result.lines = lines_of(motions.graph(), points, motions.values());
  result.notes = motions.places().notes;
  std::vector<Mistake> without;
  for (const int index : wanted) add_shape(motions, poles, index, result.modes, without);
  if (result.modes.empty() && !without.empty()) throw Error(std::move(without));
  for (const Mistake& m : without) result.without.push_back(m.message);
  return result;
}

}  // namespace titop
