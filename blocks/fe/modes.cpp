#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <titop/blocks/fe/clamped.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/fe/mode_damping.hpp>
#include <titop/graph/error.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>

/// modal_data: from the matrices of a mesh to its clamped modes.
namespace titop::fe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Throws bad_modes if K resists rigid motion by more than its digits explain.
void require_free(const Mesh& mesh) {
  const RigidStiffness held = rigid_stiffness(mesh);
  const double noise =
      std::max({linalg::kTextDigits, 100 * std::pow(10, -mesh.digits), 10 * mesh.position_noise});
  if (held.of_terms <= noise) return;
  throw Error(
      Code::bad_modes,
      fmt::format("the stiffness of mesh {} resists rigid motion: at {}, {:.1e} of its terms",
                  mesh.name, held.worst, held.of_terms),
      fmt::format("the data contain supports (*BOUNDARY, SPC, springs to ground): remove them, the "
                  "diagram supports the body; or positions have another unit than the matrices, or "
                  "a grid its own frame. Rounding of {:.3g} digits gives {:.0e}",
                  mesh.digits, noise));
}

/// A mode whose strain energy is within the rounding of K is a mechanism that the Cholesky
/// factorization did not detect. The terms of v'Kv = lambda sum to |v|'|K||v| and cancel.
void require_stiffness(const Clamped& c, const SymmetricModes& modes) {
  const MatrixXd size = c.K.cwiseAbs() * modes.V.cwiseAbs();
  for (Index k = 0; k < modes.lambda.size(); ++k) {
    const double terms = modes.V.col(k).cwiseAbs().dot(size.col(k));
    if (modes.lambda(k) > linalg::kProductRounding * terms) continue;
    Index row = 0;
    modes.V.col(k).cwiseAbs().maxCoeff(&row);
    refuse_mechanism(c, row);
  }
}

/// M = E-part + Z-part in coordinates scaled to a unit diagonal: x = scale (E a + Z b), with
/// M x = 0 on Z. A zero diagonal keeps scale 1.
struct MassSplit {
  VectorXd scale;   ///< n_f
  MatrixXd E, Z;    ///< orthonormal: masses, massless motions
  VectorXd masses;  ///< scaled mass of each column of E
};

MassSplit split_mass(const Clamped& c) {
  MassSplit split;
  split.scale = c.M.diagonal().unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 1.0; });
  const SymmetricModes m = eigh(split.scale.asDiagonal() * c.M * split.scale.asDiagonal());
  const double noise = 10 * double(c.M.rows()) * std::pow(10, -c.mesh.digits);
  if (m.lambda(0) < -noise) {
    Index row = 0;
    m.V.col(0).cwiseAbs().maxCoeff(&row);
    throw Error(
        Code::bad_modes,
        fmt::format("the mass matrix of mesh {} is not semidefinite: negative at {}, {:.3g} "
                    "of its diagonal",
                    c.mesh.name, name_of(c, row), m.lambda(0)),
        "check the signs of point masses and their offsets, or Mesh::digits");
  }
  const Index massless = (m.lambda.array() <= noise).count();
  split.Z = m.V.leftCols(massless);
  split.E = m.V.rightCols(m.V.cols() - massless);
  split.masses = m.lambda.tail(m.V.cols() - massless);
  return split;
}

void require_unloaded(const Clamped& c, const MassSplit& split, const std::vector<Index>& loaded) {
  std::string names;
  for (const Index row : loaded)
    if (split.Z.row(row).norm() > linalg::kTextDigits)
      names += (names.empty() ? "" : ", ") + name_of(c, row);
  if (names.empty()) return;
  throw Error(Code::bad_modes,
              fmt::format("mesh {} has no mass at {}: a wrench there gives no finite acceleration",
                          c.mesh.name, names),
              "keep a number of modes, with residual vectors at that child (kept, residual), or "
              "give the node some inertia");
}

/// All finite modes if M is singular: statics in the massless motions b, Z'K(E a + Z b) = 0.
SymmetricModes condensed_modes(const Clamped& c, const std::vector<Index>& loaded) {
  const MassSplit split = split_mass(c);
  require_unloaded(c, split, loaded);
  const MatrixXd K = split.scale.asDiagonal() * c.K * split.scale.asDiagonal();
  const MatrixXd KZ = K * split.Z;
  MatrixXd T = split.E;
  T -= split.Z * solve_definite(split.Z.transpose() * KZ, KZ.transpose() * split.E);
  const VectorXd root = split.masses.cwiseSqrt().cwiseInverse();
  T = split.scale.asDiagonal() * T * root.asDiagonal();
  SymmetricModes modes =
      eigh_definite(T.transpose() * c.K * T, MatrixXd::Identity(root.size(), root.size()));
  modes.V = T * modes.V;
  return modes;
}

SymmetricModes clamped_modes(const Clamped& c, const std::vector<std::string>& children,
                             std::optional<int> kept) {
  const Index n = c.M.rows();
  if (kept && (*kept < 0 || *kept > n))
    throw Error(Code::bad_value,
                fmt::format("{} modes asked of mesh {}, which has {}", *kept, c.mesh.name, n),
                "leave ModeOptions::kept out to keep them all");
  if (const Index row = weak_pivot(c.K); row >= 0) refuse_mechanism(c, row);
  SymmetricModes modes;
  if (weak_pivot(c.M, 10 * std::pow(10, -c.mesh.digits)) < 0) {
    modes = eigh_definite(c.K, c.M);
    if (kept) modes = {modes.lambda.head(*kept), modes.V.leftCols(*kept)};
  } else if (kept) {
    modes = eigh_lowest(c.K, c.M, *kept);
  } else {
    modes = condensed_modes(c, loaded_rows(c, children));
  }
  require_stiffness(c, modes);
  return modes;
}

/// Rows of the coordinates of the line of this name, in the order of its shapes; none if the
/// interface is no line.
std::vector<Index> line_rows(const Mesh& mesh, const std::string& name) {
  std::vector<Index> rows;
  for (const MeshLine& line : mesh.lines)
    if (line.name == name)
      for (const std::size_t point : line.points)
        rows.push_back(std::ranges::find(mesh.dofs, point, &Dof::point) - mesh.dofs.begin());
  return rows;
}

/// Unit wrenches at a child, or the inertia loads of unit accelerations of the parent, and unit
/// forces of the shapes of its line: n_f rows.
MatrixXd unit_loads(const Clamped& c, const std::string& parent, const std::string& name) {
  const bool at_parent = find_point(c.mesh, name) == find_point(c.mesh, parent);
  std::vector<Index> rows = at_parent ? std::vector<Index>{} : loaded_rows(c, {name});
  for (const Index row : line_rows(c.mesh, name))
    rows.push_back(std::find(c.f.begin(), c.f.end(), row) - c.f.begin());
  const auto count = static_cast<Index>(rows.size());
  MatrixXd B = MatrixXd::Zero(c.M.rows(), count + (at_parent ? 6 : 0));
  for (Index j = 0; j < count; ++j) B(rows[static_cast<std::size_t>(j)], j) = 1;
  if (at_parent) B.rightCols(6) = c.M_rf.transpose();
  return B;
}

/// Columns of X made M-orthonormal, the one with the largest remainder first. A column with a
/// remainder below kInSpan is a combination of the others.
MatrixXd independent(MatrixXd X, const MatrixXd& M) {
  const auto norms = [&] { return VectorXd((X.cwiseProduct(M * X)).colwise().sum().cwiseSqrt()); };
  const VectorXd size = norms();
  for (Index j = 0; j < X.cols(); ++j)
    if (size(j) > 0) X.col(j) /= size(j);
  MatrixXd Q(X.rows(), 0);
  while (X.cols() > 0) {
    Index next = 0;
    const double left = norms().maxCoeff(&next);
    if (!(left > linalg::kInSpan)) break;
    VectorXd q = X.col(next) / left;
    q -= Q * (Q.transpose() * (M * q));  // once more: the first pass leaves rounding / left
    q /= std::sqrt(q.dot(M * q));
    Q.conservativeResize(Eigen::NoChange, Q.cols() + 1);
    Q.rightCols(1) = q;
    X -= q * (q.transpose() * (M * X));
  }
  return Q;
}

/// The kept modes are removed from the loads before the solve, not only from the responses after
/// it: the remaining response may be 1e-10 of the whole.
SymmetricModes residual_modes(const Clamped& c, const SymmetricModes& kept, const MatrixXd& loads) {
  const VectorXd weight =
      c.M.diagonal().unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 1.0; });
  const MatrixXd MV = c.M * kept.V;
  MatrixXd B = loads - MV * (kept.V.transpose() * loads);
  constexpr double kCarried = 1e-9;  // of a load: the modes carry it but for their rounding
  std::vector<Index> columns;
  for (Index j = 0; j < B.cols(); ++j)
    if ((weight.asDiagonal() * B.col(j)).norm() >
        kCarried * (weight.asDiagonal() * loads.col(j)).norm())
      columns.push_back(j);
  MatrixXd X = solve_definite(c.K, B(Eigen::all, columns));
  X -= kept.V * (MV.transpose() * X);
  const MatrixXd Q = independent(std::move(X), c.M);
  SymmetricModes modes = eigh(Q.transpose() * c.K * Q);
  modes.V = Q * modes.V;
  return modes;
}

void add_residual(const Clamped& c, const std::string& parent, const ModeOptions& options,
                  SymmetricModes& modes) {
  MatrixXd loads(c.M.rows(), 0);
  for (const std::string& name : options.residual) {
    const MatrixXd more = unit_loads(c, parent, name);
    loads.conservativeResize(Eigen::NoChange, loads.cols() + more.cols());
    loads.rightCols(more.cols()) = more;
  }
  const SymmetricModes more = residual_modes(c, modes, loads);
  const Index N = modes.lambda.size(), total = N + more.lambda.size();
  modes.lambda.conservativeResize(total);
  modes.lambda.tail(total - N) = more.lambda;
  modes.V.conservativeResize(Eigen::NoChange, total);
  modes.V.rightCols(total - N) = more.V;
}

ModalLine line_of(const Mesh& mesh, const MeshLine& line, const MatrixXd& Phi) {
  return {line.name, line.axis, line.length, line.shapes,
          Phi(line_rows(mesh, line.name), Eigen::all)};
}

/// Warns of a clamp or a moment at one node of a plate.
void warn_of_plate_node(const Mesh& mesh, const std::string& name, bool parent,
                        std::vector<std::string>& warnings) {
  if (!is_plate_node(mesh, find_point(mesh, name))) return;
  warnings.push_back(
      fmt::format("{} is one node of {}: {} there does not converge with the mesh (the slope grows "
                  "with the logarithm of 1/h): use fe::rigid or fe::average over the real "
                  "footprint",
                  name, mesh.name, parent ? "a clamp" : "a moment"));
}

void require_distinct(const Mesh& mesh, const std::vector<std::string>& children) {
  std::set<std::string> seen;
  for (const std::string& child : children)
    if (!seen.insert(child).second)
      throw Error(Code::duplicate_name,
                  fmt::format("child {} of mesh {} is named twice", child, mesh.name),
                  "name it once");
}

}  // namespace

ModalData modal_data(const Mesh& given, const std::string& parent,
                     const std::vector<std::string>& children, const ModeOptions& options) {
  check(given);
  const Mesh mesh = symmetrised(given);
  require_distinct(mesh, children);
  require_distinct(mesh, options.residual);
  const Clamped c = clamp(mesh, parent, options);
  SymmetricModes modes = clamped_modes(c, children, options.kept);
  require_free(mesh);  // after the check for mechanisms
  const Index kept = modes.lambda.size();
  if (!options.residual.empty()) add_residual(c, parent, options, modes);

  ModalData data;
  data.omega = modes.lambda.cwiseSqrt();
  data.xi = damping_ratios(mesh, options, kept, data.omega);
  data.L_P = modes.V.transpose() * c.M_rf.transpose();
  data.D_P = c.D_P;
  data.digits = mesh.digits;
  data.warnings = mesh.warnings;
  MatrixXd Phi = MatrixXd::Zero(mesh.M.rows(), modes.V.cols());  // the clamped rows stay zero
  Phi(c.f, Eigen::all) = modes.V;
  const Vector3d P = mesh.points[find_point(mesh, parent)].position;
  for (const std::string& child : children)
    data.children.push_back({child, mesh.points[find_point(mesh, child)].position - P,
                             MatrixXd::Zero(6, modes.V.cols())});
  for (ModalChild& child : data.children) {
    const auto rows = interface_rows(mesh, child.name, c.rigid);
    for (std::size_t i = 0; i < 6; ++i)
      if (rows.at(i) >= 0) child.Phi_C.row(static_cast<Index>(i)) = Phi.row(rows.at(i));
  }
  for (const MeshLine& line : mesh.lines)
    if (line.name == parent || std::ranges::find(children, line.name) != children.end())
      data.lines.push_back(line_of(mesh, line, Phi));
  warn_of_plate_node(mesh, parent, true, data.warnings);
  for (const std::string& child : children)
    if (child != parent) warn_of_plate_node(mesh, child, false, data.warnings);
  return data;
}

}  // namespace titop::fe
