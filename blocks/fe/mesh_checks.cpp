#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>
#include <vector>

namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// points x 3: the mass of each point along x, y, z.
MatrixXd point_masses(const Mesh& mesh) {
  const Index n = mesh.M.rows();
  MatrixXd unit = MatrixXd::Zero(n, 3);
  for (Index i = 0; i < n; ++i) {
    const int c = mesh.dofs[static_cast<std::size_t>(i)].component;
    if (c < 3) unit(i, c) = 1;
  }
  const MatrixXd sums = mesh.M * unit;
  MatrixXd masses = MatrixXd::Zero(static_cast<Index>(mesh.points.size()), 3);
  for (Index i = 0; i < n; ++i) {
    const Dof& dof = mesh.dofs[static_cast<std::size_t>(i)];
    if (dof.component < 3)
      masses(static_cast<Index>(dof.point), dof.component) = sums(i, dof.component);
  }
  return masses;
}

std::optional<MassProperties> from_geometry(const Mesh& mesh) {
  for (const Dof& dof : mesh.dofs)
    if (dof.component >= kGeneralised) return std::nullopt;
  const MatrixXd masses = point_masses(mesh);
  const double tolerance = linalg::kTextDigits * std::abs(masses.col(0).sum());
  Matrix6 D = Matrix6::Zero();
  for (Index i = 0; i < masses.rows(); ++i) {
    const auto m = masses.row(i);
    if (!(m.maxCoeff() - m.minCoeff() <= tolerance)) return std::nullopt;
    const Vector3d& position = mesh.points[static_cast<std::size_t>(i)].position;
    D += rigid_mass(m.mean(), Matrix3d::Zero(), -position);
  }
  return mass_properties(D);
}

std::string print(const char* source, const MassProperties& m,
                  const std::optional<DataUnits>& units) {
  const auto [L, M, T] = units.value_or(DataUnits{});
  const Vector3d c = L * m.centre, I = M * L * L * m.inertia.diagonal();
  return fmt::format(
      "{}: mass {:.8g}{}, centre of mass {:.6g} {:.6g} {:.6g}{}, inertia there {:.6g} {:.6g} "
      "{:.6g}{}\n",
      source, M * m.mass.mean(), units ? " kg" : "", c.x(), c.y(), c.z(), units ? " m" : "", I(0),
      I(1), I(2), units ? " kg m^2" : " (units of the mesh)");
}

constexpr double kSameCentre = 0.01;  ///< lumping moves mass by a part of an element

}  // namespace

namespace {

/// |R| of each row's point, translations and rotations apart: the same in all frames of the grids.
MatrixXd sizes_at_points(const Mesh& mesh, const MatrixXd& R) {
  const auto points = static_cast<Index>(mesh.points.size());
  MatrixXd squares = MatrixXd::Zero(2 * points, R.cols()), result(R.rows(), R.cols());
  const auto place = [&](Index i) {
    const Dof& dof = mesh.dofs[static_cast<std::size_t>(i)];
    return static_cast<Index>(dof.point) + (dof.component < 3 ? 0 : points);
  };
  for (Index i = 0; i < R.rows(); ++i) squares.row(place(i)) += R.row(i).cwiseAbs2();
  for (Index i = 0; i < R.rows(); ++i) {
    const bool moves = mesh.dofs[static_cast<std::size_t>(i)].component < kGeneralised;
    result.row(i) = (moves ? 1.0 : 0.0) * squares.row(place(i)).cwiseSqrt();
  }
  return result;
}

}  // namespace

RigidStiffness rigid_stiffness(const Mesh& mesh) {
  const MatrixXd R = rigid_motions(mesh, Vector3d::Zero());
  RigidStiffness result;
  const MatrixXd KR = (mesh.K * R).cwiseAbs();
  const double largest = mesh.K.cwiseAbs().maxCoeff();
  // An entry that symmetry makes zero is as exact as the largest one K(i, j) could be,
  // sqrt(K(i, i) K(j, j)).
  const VectorXd root = mesh.K.diagonal().cwiseAbs().cwiseSqrt();
  const MatrixXd pattern = (mesh.K.array() != 0).cast<double>();
  const MatrixXd terms = root.asDiagonal() * pattern * root.asDiagonal() * sizes_at_points(mesh, R);
  if (largest > 0) result.of_largest = KR.maxCoeff() / largest;
  Index row = 0, column = 0;
  result.of_terms =
      (terms.array() > 0).select(KR.cwiseQuotient(terms), 0.0).maxCoeff(&row, &column);
  result.worst = dof_name(mesh, row);
  return result;
}

MeshReport mesh_report(const Mesh& mesh) {
  check(mesh);
  MeshReport report;
  const MatrixXd R = rigid_motions(mesh, Vector3d::Zero());
  report.mass = mass_properties(R.transpose() * (mesh.M * R));
  report.geometry = from_geometry(mesh);
  report.asymmetry = asymmetry(mesh);
  if (mesh.K.size() == 0) return report;
  RigidStiffness held = rigid_stiffness(mesh);
  report.KR = held.of_largest;
  report.KR_terms = held.of_terms;
  report.KR_worst = std::move(held.worst);
  return report;
}

std::vector<std::string> implausible(const MeshReport& report) {
  std::vector<std::string> lines;
  if (!report.geometry) return lines;
  const double m = report.mass.mass.mean();
  // The radius of gyration is the size of a body.
  const double size = std::sqrt(std::max(report.mass.inertia.trace(), 0.0) / std::abs(m));
  const double apart = (report.mass.centre - report.geometry->centre).norm();
  if (apart > kSameCentre * size)
    lines.push_back(
        fmt::format("centre of mass of M {:.3g} from that of its points, of a radius of "
                    "gyration of {:.3g}",
                    apart, size));
  return lines;
}

std::string to_string(const MeshReport& report, const std::optional<DataUnits>& units) {
  std::string text = print("from M", report.mass, units);
  text += report.geometry ? print("from the points", *report.geometry, units)
                          : "from the points: not known, as some have different masses along x, y "
                            "and z, or there are generalised coordinates\n";
  text += fmt::format("misfit of R'MR to a rigid body {:.1e}\n", report.mass.misfit);
  text += fmt::format(
      "stiffness against rigid motions {:.1e} of the largest, {:.1e} of its terms, "
      "worst at {}\n",
      report.KR, report.KR_terms, report.KR_worst);
  if (report.asymmetry > 0)
    text += fmt::format("asymmetry of K and M {:.1e} of their diagonals\n", report.asymmetry);
  for (const std::string& line : implausible(report)) text += "warning: " + line + "\n";
  return text;
}

VectorXd omega_uncertainty(const Mesh& given, const std::string& parent, int count) {
  check(given);
  const Mesh mesh = symmetrised(given);
  const Vector3d P = mesh.points[find_point(mesh, parent)].position;
  const auto rows =
      interface_rows(mesh, parent, mesh.rigid ? still_directions(mesh, P) : std::array<bool, 6>{});
  std::vector<Index> f;
  for (Index i = 0; i < mesh.M.rows(); ++i)
    if (std::find(rows.begin(), rows.end(), i) == rows.end()) f.push_back(i);
  const MatrixXd K = mesh.K(f, f), M = mesh.M(f, f);
  const SymmetricModes modes = eigh_lowest(K, M, count);
  // Entries (i, j) and (j, i) are one number of the file: the sum over both counts it once at
  // double weight, whose square is twice the sum of the two squares.
  const auto variance = [](const MatrixXd& S, const VectorXd& v) {
    const MatrixXd squares = S.cwiseAbs2();
    const VectorXd v2 = v.cwiseAbs2();
    return 2 * v2.dot(squares * v2) - v2.cwiseAbs2().dot(squares.diagonal());
  };
  VectorXd result(count);
  for (Index k = 0; k < count; ++k) {
    const VectorXd v = modes.V.col(k);
    const double lambda = modes.lambda(k);
    const double spread = std::sqrt(variance(K, v) + lambda * lambda * variance(M, v));
    result(k) = std::pow(10, -mesh.digits) * spread / (2 * lambda);
  }
  return result;
}

}  // namespace titop::fe
