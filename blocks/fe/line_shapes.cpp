#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <titop/blocks/fe/hermite.hpp>
#include <titop/blocks/fe/line_shapes.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/error.hpp>
#include <utility>

namespace titop {

std::string to_string(const LineShape& shape) {
  if (shape.component < 0 || shape.component > 5)
    return fmt::format("component {} of degree {}", shape.component, shape.degree);
  return fmt::format("{}{}", component_name(shape.component), shape.degree);
}

}  // namespace titop

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

unsigned degree_of(int degree) { return static_cast<unsigned>(degree); }

double legendre_slope(int degree, double x) {
  double sum = 0;
  for (int k = degree - 1; k >= 0; k -= 2) sum += (2 * k + 1) * std::legendre(degree_of(k), x);
  return sum;
}

/// Index among `rows` of this component of a point, -1 if it has none.
Index find_row(const Mesh& mesh, const std::vector<Index>& rows, std::size_t point, int component) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Dof& dof = mesh.dofs[static_cast<std::size_t>(rows[i])];
    if (dof.point == point && dof.component == component) return static_cast<Index>(i);
  }
  return -1;
}

bool all_have(const Mesh& mesh, const EdgeLine& line, const std::vector<Index>& rows,
              int component) {
  return std::ranges::all_of(line.nodes.points, [&](std::size_t point) {
    return find_row(mesh, rows, point, component) >= 0;
  });
}

/// A component along the line as a function: the row of its value, and that of its slope along the
/// line with its sign.
struct EdgeFunction {
  int value, slope;
  double sign;
};

/// Of the displacement along axis c, whose slope is a rotation; of the rotation about the line,
/// whose slope is the twist of a plate: w_xy = -d(ry)/dy = d(rx)/dx.
EdgeFunction function_of(const EdgeLine& line, int component) {
  if (component >= 3) return {component, kTwist, line.axis == 1 ? -1.0 : 1.0};
  const Vector3d turn = cross(Vector3d::Unit(line.axis)) * Vector3d::Unit(component);
  Index axis = 0;
  const double size = turn.cwiseAbs().maxCoeff(&axis);
  return {component, size > 0 ? 3 + static_cast<int>(axis) : -1, turn(axis)};
}

/// Displacements that all nodes have, and the rotation about the line.
std::vector<int> components_of(const Mesh& mesh, const EdgeLine& line,
                               const std::vector<Index>& rows) {
  std::vector<int> result;
  for (const int c : {0, 1, 2, 3 + line.axis})
    if (all_have(mesh, line, rows, c)) result.push_back(c);
  return result;
}

/// Throws if a node with degrees of freedom is on the line between its nodes, and none of them.
void require_all_between(const Mesh& mesh, const EdgeLine& line) {
  const double room = place_tolerance(mesh);
  for (const Dof& dof : mesh.dofs) {
    if (dof.component >= kGeneralised) continue;
    const Vector3d from_middle = mesh.points[dof.point].position - line.middle;
    Vector3d across = from_middle;
    across(line.axis) = 0;
    if (across.norm() > room || std::abs(from_middle(line.axis)) > line.length / 2) continue;
    const bool at_node = std::ranges::any_of(line.nodes.points, [&](std::size_t point) {
      return point == dof.point ||
             std::abs(mesh.points[point].position(line.axis) - line.middle(line.axis) -
                      from_middle(line.axis)) <= room;
    });
    if (!at_node)
      throw Error(Code::bad_value,
                  fmt::format("{} of mesh {} leaves out node {}, which is on the line between them",
                              line.nodes.name, mesh.name, mesh.points[dof.point].name),
                  "it would move apart from the shapes: take all nodes of the line, "
                  "fe::segment(mesh, A, B) or fe::edge");
  }
}

/// True if the slope of this component is a row of every node, which then has cubic Hermite
/// functions along the line. Only a plate's elements have them, not each node with rotations.
bool is_hermite(const Mesh& mesh, const EdgeLine& line, const std::vector<Index>& rows,
                const EdgeFunction& f) {
  return f.slope >= 0 && all_have(mesh, line, rows, kTwist) && all_have(mesh, line, rows, f.slope);
}

/// Weights of a function's values, and of its slopes behind each: its mass matrix by Hermite's
/// functions, or lumped.
MatrixXd weights_of(const EdgeLine& line, bool hermite) {
  const Index count = line.at.size(), width = hermite ? 2 * count : count;
  MatrixXd weights = MatrixXd::Zero(width, width);
  for (Index i = 0; i + 1 < count; ++i) {
    const double h = (line.at(i + 1) - line.at(i)) * line.length / 2;
    if (hermite)
      weights.block<4, 4>(2 * i, 2 * i) += hermite_mass(h) * (h / 420);
    else
      weights.diagonal().segment<2>(i).array() += h / 2;
  }
  return weights;
}

}  // namespace

EdgeLine line_of(const Mesh& mesh, const NodeSet& nodes) {
  Vector3d low = mesh.points[nodes.points.front()].position, high = low;
  for (const std::size_t i : nodes.points) {
    low = low.cwiseMin(mesh.points[i].position);
    high = high.cwiseMax(mesh.points[i].position);
  }
  EdgeLine line;
  Index axis = 0;
  line.length = (high - low).maxCoeff(&axis);
  line.axis = static_cast<int>(axis);
  line.middle = (low + high) / 2;
  Vector3d spread = high - low;
  spread(axis) = 0;
  if (!(spread.norm() <= place_tolerance(mesh)) || line.length <= place_tolerance(mesh))
    throw Error(Code::bad_value,
                fmt::format("{} of mesh {} is no line along x, y or z: its nodes extend by {:.6g}, "
                            "{:.6g} and {:.6g}",
                            nodes.name, mesh.name, high.x() - low.x(), high.y() - low.y(),
                            high.z() - low.z()),
                "shapes are of straight edges along the body's axes: turn the mesh, or use "
                "fe::rigid or fe::average");
  const auto count = static_cast<Index>(nodes.points.size());
  const auto place = [&](std::size_t point) { return mesh.points[point].position(axis); };
  line.nodes = nodes;
  std::ranges::sort(line.nodes.points, {}, place);
  line.at.resize(count);
  for (Index i = 0; i < count; ++i)
    line.at(i) = 2 * (place(line.nodes.points[static_cast<std::size_t>(i)]) - line.middle(axis)) /
                 line.length;
  require_all_between(mesh, line);
  return line;
}

std::vector<LineShape> shapes_of(const Mesh& mesh, const EdgeLine& line,
                                 const std::vector<Index>& rows, int m) {
  std::vector<LineShape> result;
  for (const int c : components_of(mesh, line, rows))
    for (int degree = c < 3 && c != line.axis ? 2 : 1; degree < m; ++degree)
      result.push_back({c, degree});
  return result;
}

VectorXd displacements(const Mesh& mesh, const EdgeLine& line, const std::vector<Index>& rows,
                       const LineShape& shape) {
  VectorXd u = VectorXd::Zero(static_cast<Index>(rows.size()));
  const EdgeFunction f = function_of(line, shape.component);
  for (std::size_t i = 0; i < line.nodes.points.size(); ++i) {
    const double x = line.at(static_cast<Index>(i));
    const std::size_t point = line.nodes.points[i];
    u(find_row(mesh, rows, point, f.value)) = std::legendre(degree_of(shape.degree), x);
    if (const Index slope = find_row(mesh, rows, point, f.slope); slope >= 0)
      u(slope) = f.sign * legendre_slope(shape.degree, x) * 2 / line.length;
  }
  return u;
}

Observation measure_of(const Mesh& mesh, const EdgeLine& line, const std::vector<Index>& rows) {
  Observation m{MatrixXd(0, static_cast<Index>(rows.size())), MatrixXd(0, 0)};
  for (const int component : components_of(mesh, line, rows)) {
    const EdgeFunction f = function_of(line, component);
    const bool hermite = is_hermite(mesh, line, rows, f);
    const MatrixXd weights = weights_of(line, hermite);
    const Index first = m.B.rows(), total = first + weights.rows();
    m.B.conservativeResizeLike(MatrixXd::Zero(total, m.B.cols()));
    m.W.conservativeResizeLike(MatrixXd::Zero(total, total));
    m.W.bottomRightCorner(weights.rows(), weights.rows()) = weights;
    for (Index i = 0; i < line.at.size(); ++i) {
      const std::size_t point = line.nodes.points[static_cast<std::size_t>(i)];
      const Index row = first + (hermite ? 2 * i : i);
      m.B(row, find_row(mesh, rows, point, f.value)) = 1;
      if (hermite) m.B(row + 1, find_row(mesh, rows, point, f.slope)) = f.sign;
    }
  }
  return m;
}

}  // namespace titop::fe
