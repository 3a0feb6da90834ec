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
  return fmt::format("{}{}", component_name(shape.component), shape.degree);
}

}  // namespace titop

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kStraight = 1e-9;  ///< of the length: positions from text or sums of lengths

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
  if (!(spread.norm() <= kStraight * line.length) || line.length == 0)
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
  const auto count = static_cast<Index>(line.nodes.points.size());
  const bool plate = all_have(mesh, line, rows, kTwist);
  const Index width = plate ? 2 * count : count;
  const std::vector<int> components = components_of(mesh, line, rows);
  // Weights of one function: its mass matrix, by Hermite's functions or lumped.
  MatrixXd weights = MatrixXd::Zero(width, width);
  for (Index i = 0; i + 1 < count; ++i) {
    const double h = (line.at(i + 1) - line.at(i)) * line.length / 2;
    if (plate)
      weights.block<4, 4>(2 * i, 2 * i) += hermite_integrals(h).values;
    else
      weights.diagonal().segment<2>(i).array() += h / 2;
  }
  const auto functions = static_cast<Index>(components.size());
  Observation m{MatrixXd::Zero(functions * width, static_cast<Index>(rows.size())),
                MatrixXd::Zero(functions * width, functions * width)};
  for (Index k = 0; k < functions; ++k) {
    const EdgeFunction f = function_of(line, components[static_cast<std::size_t>(k)]);
    m.W.block(k * width, k * width, width, width) = weights;
    for (Index i = 0; i < count; ++i) {
      const std::size_t point = line.nodes.points[static_cast<std::size_t>(i)];
      m.B(k * width + (plate ? 2 * i : i), find_row(mesh, rows, point, f.value)) = 1;
      if (plate) m.B(k * width + 2 * i + 1, find_row(mesh, rows, point, f.slope)) = f.sign;
    }
  }
  return m;
}

}  // namespace titop::fe
