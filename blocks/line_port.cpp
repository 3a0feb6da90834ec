#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/line_port.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <utility>

namespace titop {

namespace {

std::string list_of_shapes(const ModalLine& line) {
  std::string all;
  for (const LineShape& s : line.shapes) all += (all.empty() ? "" : ", ") + to_string(s);
  return all;
}

bool is_rotation(const LineShape& shape) { return shape.component >= 3; }

/// A body axis of line a as one of b's, with its sign.
struct Turned {
  int axis;
  double sign;
};

Turned turned(const LinePort& a, const LinePort& b, const Matrix3d& T, int axis) {
  Eigen::Index to = 0;
  const double size = T.col(axis).cwiseAbs().maxCoeff(&to);
  if (!(size >= 1 - linalg::kMatrixDigits))
    throw Error(
        Code::bad_value,
        fmt::format("lines {} and {} meet under axes that are not parallel", a.name, b.name),
        "T_ba must turn the axis of one line into that of the other: put a mounting rotation "
        "between bodies, or turn the mesh");
  return {static_cast<int>(to), T(to, axis) > 0 ? 1.0 : -1.0};
}

/// A shape of b, times a factor.
struct ShapeTerm {
  LineShape shape;
  double factor;
};

/// The shape of a as a sum of b's. P_k(-s) = (-1)^k P_k(s); a displacement across lines that meet
/// at an oblique angle is one of two components.
std::vector<ShapeTerm> terms_in(const LinePort& a, const LinePort& b, const Matrix3d& T,
                                const LineShape& shape) {
  const Turned along = turned(a, b, T, a.line.axis);
  const double flip = along.sign < 0 && shape.degree % 2 == 1 ? -1 : 1;
  if (is_rotation(shape)) return {{{along.axis + 3, shape.degree}, flip * along.sign}};
  std::vector<ShapeTerm> terms;
  for (int c = 0; c < 3; ++c) {
    const double t = T(c, shape.component);
    if (std::abs(t) >= 1 - linalg::kMatrixDigits)
      return {{{c, shape.degree}, t > 0 ? flip : -flip}};
    if (std::abs(t) > linalg::kMatrixDigits) terms.push_back({{c, shape.degree}, flip * t});
  }
  return terms;
}

bool has_component(const ModalLine& line, int component) {
  return std::ranges::find(line.shapes, component, &LineShape::component) != line.shapes.end();
}

/// The only direction in which the line's nodes are displaced; none: there are several, or none.
std::optional<int> deflection(const ModalLine& line) {
  std::optional<int> only;
  for (int c = 0; c < 3; ++c) {
    if (!has_component(line, c)) continue;
    if (only) return std::nullopt;
    only = c;
  }
  return only;
}

/// True if line b cannot follow this displacement of a, since its body is rigid in that direction:
/// both are then held straight. At any angle between panels that deflect along their normal alone.
bool is_held(const LinePort& a, const LinePort& b, const Matrix3d& T, const LineShape& shape) {
  if (is_rotation(shape)) return false;
  const std::optional<int> mine = deflection(a.line), other = deflection(b.line);
  if (mine && other) return std::abs(T(*other, *mine)) < 1 - linalg::kMatrixDigits;
  return std::ranges::none_of(terms_in(a, b, T, shape), [&](const ShapeTerm& term) {
    return has_component(b.line, term.shape.component);
  });
}

/// Shapes of a that are not held.
std::vector<LineShape> tied(const LinePort& a, const LinePort& b, const Matrix3d& T) {
  std::vector<LineShape> result = a.line.shapes;
  std::erase_if(result, [&](const LineShape& s) { return is_held(a, b, T, s); });
  return result;
}

bool has_shape(const LinePort& line, const LineShape& shape) {
  return std::ranges::any_of(line.line.shapes, [&](const LineShape& s) {
    return s.component == shape.component && s.degree == shape.degree;
  });
}

/// True if b has all shapes that the tied ones of a are in its frame.
bool has_all(const LinePort& a, const LinePort& b, const Matrix3d& T) {
  return std::ranges::all_of(tied(a, b, T), [&](const LineShape& shape) {
    return std::ranges::all_of(terms_in(a, b, T, shape),
                               [&](const ShapeTerm& term) { return has_shape(b, term.shape); });
  });
}

void require_same(const LinePort& a, const LinePort& b, const Rotation& T_ba) {
  if (!T_ba.values().empty())
    throw Error(Code::bad_value,
                fmt::format("lines {} and {} meet by a rotation with parameters", a.name, b.name),
                "give its number: the shapes of a line do not turn");
  if (a.is_parent && b.is_parent)
    throw Error(
        Code::bad_value, fmt::format("lines {} and {} are both parents", a.name, b.name),
        "one of the bodies must have its line as a child: modal_data(mesh, parent, {line})");
  const double longer = std::max(a.line.length, b.line.length);
  if (!(std::abs(a.line.length - b.line.length) <= linalg::kTextDigits * longer))
    throw Error(Code::bad_value,
                fmt::format("line {} has the length {:.9g} m, line {} {:.9g} m", a.name,
                            a.line.length, b.name, b.line.length),
                "weld edges of one length: take the common segment, fe::segment(mesh, edge, from, "
                "to)");
  const Matrix3d T = T_ba.nominal();
  const bool same_axis = turned(a, b, T, a.line.axis).axis == b.line.axis;
  const bool fits = same_axis && has_all(a, b, T) && has_all(b, a, T.transpose());
  if (!fits)
    throw Error(Code::size,
                fmt::format("line {} along {} has the shapes {}, line {} along {} has {}", a.name,
                            "xyz"[a.line.axis], list_of_shapes(a.line), b.name, "xyz"[b.line.axis],
                            list_of_shapes(b.line)),
                "give both edges the same number of polynomials, fe::legendre(m), and T_ba between "
                "their frames; plates that meet at an oblique angle the same Plate::in_plane");
}

void hold_shapes(const LinePort& line, const SourceLine& at) {
  for (const DualPort<1>& shape : line.shape_ports) ground(shape, at);
}

/// Holds the shapes of a that b cannot follow.
void hold_straight(const LinePort& a, const LinePort& b, const Matrix3d& T, const SourceLine& at) {
  for (std::size_t i = 0; i < a.line.shapes.size(); ++i)
    if (is_held(a, b, T, a.line.shapes[i])) ground(a.shape_ports[i], at);
}

/// factor * e, of the same quantity if it is 1 or -1.
Expr scaled(const Expr& e, double factor) {
  if (factor == 1) return e;
  return factor == -1 ? e.negated() : e.times(Value(factor));
}

/// Equal motion and opposite forces of the shapes of both lines; those that the other line cannot
/// follow are held.
void tie_shapes(const LinePort& a, const LinePort& b, const Matrix3d& T, bool rotations,
                const SourceLine& at) {
  hold_straight(a, b, T, at), hold_straight(b, a, T.transpose(), at);
  for (std::size_t i = 0; i < a.line.shapes.size(); ++i) {
    if (!rotations && is_rotation(a.line.shapes[i])) continue;
    if (is_held(a, b, T, a.line.shapes[i])) continue;
    const DualPort<1>& mine = a.shape_ports[i];
    Expr motion;
    for (const auto& [shape, factor] : terms_in(a, b, T, a.line.shapes[i])) {
      const DualPort<1> other = b.shape(shape);
      const Expr part = scaled(other.accel.expr(), factor);
      motion = motion.graph() ? motion.plus(part, 1) : part;
      other.force += Rhs(scaled(mine.reaction.expr(), factor).negated(), at);
    }
    mine.accel = Rhs(motion, at);
  }
}

/// States that the rotation's shapes are free, which is meant here.
void release_rotations(const LinePort& line, const SourceLine& at) {
  for (std::size_t i = 0; i < line.line.shapes.size(); ++i)
    if (is_rotation(line.line.shapes[i])) release(line.shape_ports[i], at);
}

struct ParentOnly {
  DualPort<6> parent;
};

}  // namespace

DualPort<1> LinePort::shape(const LineShape& wanted) const {
  for (std::size_t i = 0; i < line.shapes.size(); ++i)
    if (line.shapes[i].component == wanted.component && line.shapes[i].degree == wanted.degree)
      return shape_ports[i];
  throw Error(Code::unknown_name, fmt::format("line {} has no shape {}", name, to_string(wanted)),
              "its shapes are " + list_of_shapes(line));
}

FlexibleBodyHandle::FlexibleBodyHandle(Graph* graph, int node)
    : BodyHandle(graph, node), graph_(graph), node_(node) {}

LinePort FlexibleBodyHandle::line(const std::string& name) const {
  const Node& node = graph_->nodes[static_cast<std::size_t>(node_)];
  const auto& data = *dynamic_cast<const Specified<FlexibleBody::Spec>&>(*node.block).spec().data;
  const auto found = std::ranges::find(data.lines, name, &ModalLine::name);
  if (found == data.lines.end()) {
    std::string names;
    for (const ModalLine& l : data.lines) names += (names.empty() ? "" : ", ") + l.name;
    throw Error(Code::unknown_name, fmt::format("{} has no line {}", node.name, name),
                names.empty() ? "give its mesh one: fe::with_interface(mesh, name, fe::shapes(...))"
                              : "its lines are " + names);
  }
  const int child_channel = detail::find_child(*graph_, node_, name, 6);
  LinePort port{node.name + "." + name,
                child_channel < 0 ? parent : detail::channel<6>(graph_, node_, child_channel),
                child_channel < 0,
                {found->name, found->axis, found->length, found->shapes, {}},
                {}};
  for (const LineShape& shape : found->shapes)
    port.shape_ports.push_back(detail::channel<1>(
        graph_, node_, detail::find_channel(*graph_, node_, channel_of(*found, shape))));
  return port;
}

void ground(const LinePort& line, SourceLine at) {
  ground(line.point, at);
  hold_shapes(line, at);
}

void mount(const LinePort& line, const DualPort<6>& site, const Rotation& T_ba, SourceLine at) {
  if (!line.is_parent)
    throw Error(Code::bad_value,
                fmt::format("line {} is mounted and is not its body's parent", line.name),
                "modal_data(mesh, line, {...}) makes it the parent; to close a chain write weld");
  weld(line, site, T_ba, at);
}

void weld(const LinePort& line, const DualPort<6>& site, const Rotation& T_ba, SourceLine at) {
  if (line.is_parent)
    mount(ParentOnly{line.point}, site, T_ba, at);
  else
    weld(line.point, site, T_ba, at);
  hold_shapes(line, at);
}

void weld(const LinePort& a, const LinePort& b, const Rotation& T_ba, SourceLine at) {
  if (b.is_parent && !a.is_parent) return weld(b, a, T_ba.inverse(), at);
  require_same(a, b, T_ba);
  if (a.is_parent)
    mount(ParentOnly{a.point}, b.point, T_ba, at);
  else
    weld(a.point, b.point, T_ba, at);
  tie_shapes(a, b, T_ba.nominal(), /*rotations=*/true, at);
}

Hinge::Handle hinge_line(Diagram& d, const std::string& name, const LinePort& a, const LinePort& b,
                         const Rotation& T_ba, SourceLine at) {
  require_same(a, b, T_ba);
  if (!a.is_parent)
    throw Error(Code::bad_value,
                fmt::format("line {}, which turns by {}, is not its body's parent", a.name, name),
                "modal_data(mesh, line, {...}) makes it the parent; to close a chain write a joint "
                "and weld");
  const Hinge::Handle joint =
      hinge(d, name, ParentOnly{a.point}, b.point, T_ba, Vector3d::Unit(a.line.axis), at);
  tie_shapes(a, b, T_ba.nominal(), /*rotations=*/false, at);
  release_rotations(a, at), release_rotations(b, at);
  return joint;
}

}  // namespace titop
