#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/check_modal_data.hpp>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop::detail {
namespace {

using Eigen::MatrixXd;

void check_shapes(const ModalData& d) {
  const auto n = d.omega.size();
  const auto refuse = [&](const std::string& subject, Eigen::Index rows, Eigen::Index cols,
                          const std::string& expected) {
    throw Error(Code::bad_modes, fmt::format("{} is {} x {} for {} modes", subject, rows, cols, n),
                fmt::format("it must be {}", expected));
  };
  if (d.xi.size() != n) refuse("xi", d.xi.size(), 1, fmt::format("{} x 1", n));
  if (d.L_P.rows() != n || (n > 0 && d.L_P.cols() != 6))
    refuse("L_P", d.L_P.rows(), d.L_P.cols(), fmt::format("{} x 6, a row per mode", n));
  for (const ModalChild& c : d.children)
    if (c.Phi_C.cols() != n || (n > 0 && c.Phi_C.rows() != 6))
      refuse("Phi_C of " + c.name, c.Phi_C.rows(), c.Phi_C.cols(),
             fmt::format("6 x {}, a column per mode", n));
  for (const ModalLine& line : d.lines)
    if (line.Phi.cols() != n || line.Phi.rows() != static_cast<Eigen::Index>(line.shapes.size()))
      refuse("Phi of line " + line.name, line.Phi.rows(), line.Phi.cols(),
             fmt::format("{} x {}, a row per shape", line.shapes.size(), n));
}

std::string entry(int i, int j) {
  return fmt::format("({}, {})", component_name(i), component_name(j));
}

void require_finite(const MatrixXd& m, const std::string& name) {
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      if (!std::isfinite(m(i, j)))
        throw Error(Code::not_finite,
                    fmt::format("{} of the modal data has {} in row {}, column {}", name, m(i, j),
                                i + 1, j + 1),
                    "give finite numbers");
}

/// Degree 0, and of displacements across the line degree 1, are motions of its point.
bool fits(const LineShape& shape, int axis) {
  if (shape.component < 0 || (shape.component >= 3 && shape.component != 3 + axis)) return false;
  return shape.degree >= (shape.component < 3 && shape.component != axis ? 2 : 1);
}

void check_line(const ModalLine& line) {
  require_finite(line.Phi, "Phi of line " + line.name);
  if (line.axis < 0 || line.axis > 2 || !(line.length > 0) || !std::isfinite(line.length))
    throw Error(
        Code::bad_value,
        fmt::format("line {} of the modal data has the length {} m and runs along {}", line.name,
                    line.length,
                    line.axis < 0 || line.axis > 2 ? "none of x, y, z" : component_name(line.axis)),
        "give its length and the body axis along which it runs");
  for (const LineShape& shape : line.shapes)
    if (!fits(shape, line.axis))
      throw Error(Code::bad_value,
                  fmt::format("line {} of the modal data, along {}, has the shape {}", line.name,
                              component_name(line.axis), to_string(shape)),
                  fmt::format("shapes are displacements across the line, of degree 2 or more, "
                              "along it or its rotation {}, of degree 1 or more",
                              component_name(3 + line.axis)));
}

/// A line that is no child's is the parent's.
void check_lines(const ModalData& d) {
  std::string children;
  for (const ModalChild& c : d.children) children += (children.empty() ? "" : ", ") + c.name;
  const ModalLine* of_parent = nullptr;
  for (const ModalLine& line : d.lines) {
    check_line(line);
    if (std::ranges::find(d.children, line.name, &ModalChild::name) != d.children.end()) continue;
    if (of_parent)
      throw Error(Code::unknown_name,
                  fmt::format("lines {} and {} of the modal data are no children", of_parent->name,
                              line.name),
                  "one line may be the parent's, the others have the name of a child: " +
                      (children.empty() ? "there is none" : children));
    of_parent = &line;
  }
}

/// Modes of a structure with much damping in proportion to stiffness are above 1 if they are
/// fast, or if they are slow with damping in proportion to mass; but some of them do oscillate.
constexpr double kMostDamped = 1;

void check_values(const ModalData& d) {
  if (!(d.digits > 0) || !std::isfinite(d.digits))
    throw Error(Code::bad_value, fmt::format("the modal data have {} digits", d.digits),
                "digits is how many decimal digits the numbers carry: 15 for doubles, 7 or so for "
                "those of a text file");
  check_modes({d.omega, d.xi});
  require_finite(d.L_P, "L_P");
  require_finite(d.D_P, "D_P");
  for (const ModalChild& c : d.children) {
    require_finite(c.PC, "PC of " + c.name);
    require_finite(c.Phi_C, "Phi_C of " + c.name);
  }
  check_lines(d);
  if (d.xi.size() > 0 && d.xi.minCoeff() > kMostDamped)
    throw Error(Code::bad_modes,
                fmt::format("no mode oscillates: the least damping ratio is {}", d.xi.minCoeff()),
                "xi is a fraction of critical damping, not percent: 0.005 for 0.5 %");
}

void check_entries(const Matrix6& D_P) {
  Eigen::Index i = 0, j = 0;
  const double off = (D_P - D_P.transpose()).cwiseAbs().maxCoeff(&i, &j);
  const int row = static_cast<int>(std::min(i, j)), column = static_cast<int>(std::max(i, j));
  if (off > linalg::kMatrixDigits * D_P.cwiseAbs().maxCoeff())
    throw Error(
        Code::bad_inertia,
        fmt::format("D_P is not symmetric, by {:.2g}: {:.6g} at {}, {:.6g} at {}", off,
                    D_P(row, column), entry(row, column), D_P(column, row), entry(column, row)),
        "give the full symmetric 6 x 6 mass matrix about P");
  for (int k = 0; k < 6; ++k)
    if (D_P(k, k) < 0)
      throw Error(Code::bad_inertia, fmt::format("D_P has {} at {}", D_P(k, k), component_name(k)),
                  "masses and inertias about P must be 0 or more");
}

/// Relative deviation of D_P from a rigid body's mass matrix. Finite-element models neglect some
/// rotary inertia and lump masses off their place: about 0.01 is usual. A larger deviation than
/// this is a mistake.
constexpr double kRigidMisfit = 0.05;

Matrix6 rotations_first(const Matrix6& D_P) {
  Matrix6 swapped;
  swapped << D_P.bottomRightCorner<3, 3>(), D_P.bottomLeftCorner<3, 3>(),
      D_P.topRightCorner<3, 3>(), D_P.topLeftCorner<3, 3>();
  return swapped;
}

/// Refuses a mass matrix that no rigid body has.
void check_rigid(const ModalData& d) {
  const MassProperties p = mass_properties(d.D_P);
  const double noise = std::max(kRigidMisfit, residual_mass(d).noise);
  if (p.misfit <= noise) return;
  const Matrix6 rigid = rigid_mass(p.mass.mean(), p.inertia, -p.centre);
  Eigen::Index i = 0, j = 0;
  (d.D_P - rigid).cwiseAbs().maxCoeff(&i, &j);
  throw Error(
      Code::bad_inertia,
      fmt::format("D_P is not the mass matrix of a rigid body, by {:.2g} of it: it has {:.6g} at "
                  "{}, a body of {:.6g} kg around ({:.4g}, {:.4g}, {:.4g}) has {:.6g}",
                  p.misfit, d.D_P(i, j), entry(static_cast<int>(i), static_cast<int>(j)),
                  p.mass.mean(), p.centre.x() + 0.0, p.centre.y() + 0.0, p.centre.z() + 0.0,
                  rigid(i, j)),  // + 0.0: no -0
      mass_properties(rotations_first(d.D_P)).misfit <= noise
          ? "its rotations come first: D_P, L_P and Phi_C have x, y, z, rx, ry, rz"
          : "the masses along x, y and z are the same, the products with the centre of mass turn "
            "sign from one corner to the other; look at the order and the units");
}

void check_mass(const ModalData& d) {
  check_entries(d.D_P);
  check_rigid(d);
  const ResidualMass r = residual_mass(d);
  if (r.verdict != Definiteness::indefinite) return;
  ModalData whole;
  whole.L_P.resize(0, 6);
  whole.D_P = d.D_P;
  whole.digits = d.digits;
  const ResidualMass all = residual_mass(whole);
  if (all.verdict == Definiteness::indefinite)
    throw Error(Code::bad_inertia,
                fmt::format("D_P is negative in {}, by {:.2g} of its entry there (noise of the "
                            "data: {:.1g})",
                            component_name(all.component), -all.smallest, all.noise),
                "the inertia in D_P is about P: that about the centre of mass, plus the mass times "
                "the square of its distance");
  throw Error(
      Code::bad_modes,
      fmt::format("the modes carry more mass than there is: D_P - L_P' L_P is negative in {}, "
                  "by {:.2g} of D_P there (noise of the data: {:.1g})",
                  component_name(r.component), -r.smallest, r.noise),
      "check units and signs of L_P against D_P, or ModalData::digits");
}

}  // namespace

void check_modes(const ModalParameters& m) {
  for (Eigen::Index i = 0; i < m.omega.size(); ++i) {
    const auto refuse = [&](Code code, const char* hint) {
      throw Error(code,
                  fmt::format("mode {} has omega {} rad/s and damping ratio {}", i + 1, m.omega(i),
                              m.xi(i)),
                  hint);
    };
    if (!std::isfinite(m.omega(i)) || !std::isfinite(m.xi(i)))
      refuse(Code::not_finite, "give finite numbers");
    if (!(m.omega(i) > 0) || m.xi(i) < 0)
      refuse(Code::bad_modes,
             "omega must be positive (modes clamped at P have no rigid motion), xi 0 or more");
  }
}

void check_damping(const MatrixXd& Z, Eigen::Index n) {
  if (Z.rows() != n || Z.cols() != n)
    throw Error(Code::size,
                fmt::format("a damping matrix is {} x {} for {} modes", Z.rows(), Z.cols(), n),
                fmt::format("it must be {} x {}", n, n));
  require_finite(Z, "the damping matrix");
  if (n == 0) return;
  const Eigen::VectorXd size =
      Z.diagonal().unaryExpr([](double z) { return z != 0 ? 1 / std::sqrt(std::abs(z)) : 1.0; });
  const MatrixXd scaled = size.asDiagonal() * Z * size.asDiagonal();
  if ((scaled - scaled.transpose()).cwiseAbs().maxCoeff() > linalg::kMatrixDigits)
    throw Error(Code::bad_modes, "the damping matrix of the modes is not symmetric",
                "give (Z + Z') / 2; a skew part is gyroscopic: write it with momentum()");
  const SymmetricModes m = eigh(scaled);
  if (m.lambda(0) >= -linalg::kMatrixDigits * static_cast<double>(n)) return;
  Eigen::Index mode = 0;
  m.V.col(0).cwiseAbs().maxCoeff(&mode);
  throw Error(Code::bad_modes,
              fmt::format("the damping matrix of the modes is negative, by {:.2g} of its diagonal, "
                          "mostly in mode {}",
                          -m.lambda(0), mode + 1),
              "it must take energy from every motion: a positive semidefinite matrix");
}

void check_modal_data(const ModalData& data) {
  check_shapes(data);
  check_values(data);
  check_mass(data);
}

}  // namespace titop::detail
