#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/linalg/eigen.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// 1 / sqrt of a diagonal; 1 if there is nothing to scale.
Vector6 unit_scale(const Matrix6& D) {
  return D.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 1.0; });
}

double noise_of(const ModalData& data) { return 10 * std::pow(10, -data.digits); }

/// Mode shapes also have the rounding error of their eigenproblem, about 1e-14 of the largest
/// entry; entries below this bound count as zero motion.
constexpr double kOfShapes = 1e-11;

double shape_noise(const ModalData& data) { return std::max(noise_of(data), kOfShapes); }

/// Reference sizes of its rows: the largest of their kind, translations or rotations, or of the
/// other kind times (over) the distance from P.
Vector6 row_sizes(const ModalChild& child) {
  const Vector6 norms = child.Phi_C.rowwise().norm();
  const double translation = norms.head<3>().maxCoeff(), rotation = norms.tail<3>().maxCoeff();
  const double length = child.PC.norm();
  Vector6 sizes;
  sizes.head<3>().setConstant(std::max(translation, rotation * length));
  sizes.tail<3>().setConstant(std::max(rotation, length > 0 ? translation / length : 0.0));
  return sizes;
}

/// The same of a line's rows, with those of the child at its middle: displacements, or rotations
/// times the line's length. A row of zeros is exact and has the size 0.
VectorXd shape_sizes(const ModalData& data, const ModalLine& line) {
  const VectorXd norms = line.Phi.rowwise().norm();
  const auto is_rotation = [&](Index i) {
    return line.shapes[static_cast<std::size_t>(i)].component >= 3;
  };
  double displacement = 0;
  for (Index i = 0; i < norms.size(); ++i)
    displacement = std::max(displacement, norms(i) * (is_rotation(i) ? line.length : 1));
  for (const ModalChild& child : data.children)
    if (child.name == line.name) {
      const Vector6 point = child.Phi_C.rowwise().norm();
      displacement = std::max(
          {displacement, point.head<3>().maxCoeff(), point.tail<3>().maxCoeff() * line.length});
    }
  VectorXd sizes = VectorXd::Zero(norms.size());
  for (Index i = 0; i < norms.size(); ++i)
    if (norms(i) > 0) sizes(i) = is_rotation(i) ? displacement / line.length : displacement;
  return sizes;
}

/// Rows that are negligible compared with the others.
std::array<bool, 6> resting_rows(const ModalData& data, const ModalChild& child) {
  const double noise = shape_noise(data);
  const Vector6 norms = child.Phi_C.rowwise().norm(), sizes = row_sizes(child);
  std::array<bool, 6> resting{};
  for (int i = 0; i < 6; ++i) resting[static_cast<std::size_t>(i)] = !(norms(i) > noise * sizes(i));
  return resting;
}

/// The same space, spanned by vectors with as many zeros as possible (Gauss-Jordan on the columns,
/// the largest entry as pivot): a basis that can be read and does not depend on rounding.
MatrixXd readable(MatrixXd W) {
  for (Index k = 0; k < W.cols(); ++k) {
    Index row = 0, column = 0;
    W.rightCols(W.cols() - k).cwiseAbs().maxCoeff(&row, &column);
    W.col(k).swap(W.col(k + column));
    W.col(k) /= W(row, k);
    for (Index j = 0; j < W.cols(); ++j)
      if (j != k) W.col(j) -= W(row, j) * W.col(k);
  }
  return W;
}

}  // namespace

const char* component_name(int component) {
  static constexpr std::array<const char*, 6> names = {"x", "y", "z", "rx", "ry", "rz"};
  return names.at(static_cast<std::size_t>(component));
}

/// First coefficient 1, small ones left out.
std::string combination(const Vector6& w) {
  const double largest = w.cwiseAbs().maxCoeff();
  std::string text;
  double first = 0;
  for (int i = 0; i < 6; ++i) {
    if (std::abs(w(i)) < linalg::kTextDigits * largest) continue;
    if (first == 0) first = w(i);
    const double c = w(i) / first;
    if (!text.empty()) text += c < 0 ? " - " : " + ";
    const bool one = std::abs(std::abs(c) - 1) < linalg::kTextDigits;
    text += one ? component_name(i) : fmt::format("{:.3g} {}", std::abs(c), component_name(i));
  }
  return text;
}

MassProperties mass_properties(const Matrix6& D_P) {
  MassProperties result;
  result.mass = D_P.diagonal().head<3>();
  const double m = result.mass.mean();
  if (m > 0) {
    const Matrix3d S = (D_P.topRightCorner<3, 3>() - D_P.bottomLeftCorner<3, 3>()) / (2 * m);
    result.centre = -Vector3d(S(2, 1) - S(1, 2), S(0, 2) - S(2, 0), S(1, 0) - S(0, 1)) / 2;
  }
  const Matrix3d S = cross(-result.centre);
  result.inertia = D_P.bottomRightCorner<3, 3>() + m * S * S;
  const Vector6 scale = unit_scale(D_P);
  const Matrix6 rest = D_P - rigid_mass(m, result.inertia, -result.centre);
  result.misfit = (scale.asDiagonal() * rest * scale.asDiagonal()).cwiseAbs().maxCoeff();
  return result;
}

ResidualMass residual_mass(const ModalData& data) {
  ResidualMass result;
  result.D_P0 = data.D_P - data.L_P.transpose() * data.L_P;
  const Vector6 scale = unit_scale(data.D_P);
  const SymmetricModes modes = eigh(scale.asDiagonal() * result.D_P0 * scale.asDiagonal());
  Index component = 0;
  modes.V.col(0).cwiseAbs().maxCoeff(&component);
  result.smallest = modes.lambda(0);
  result.component = static_cast<int>(component);
  result.noise = noise_of(data);
  result.verdict = result.smallest > result.noise     ? Definiteness::definite
                   : result.smallest >= -result.noise ? Definiteness::singular
                                                      : Definiteness::indefinite;
  return result;
}

ChildRank child_rank(const ModalData& data, const ModalChild& child) {
  ChildRank result{child.name, 0, 0, {}};
  const auto resting = resting_rows(data, child);
  std::vector<Index> moving;
  for (int i = 0; i < 6; ++i) {
    if (resting[static_cast<std::size_t>(i)])
      result.blocked.push_back(component_name(i));
    else
      moving.push_back(i);
  }
  const auto count = static_cast<Index>(moving.size());
  if (count == 0) return result;
  MatrixXd A = child.Phi_C(moving, Eigen::all);
  const VectorXd norms = A.rowwise().norm();
  A = norms.cwiseInverse().asDiagonal() * A;
  // A = R'Q': its singular values are those of the small R', for any number of modes.
  MatrixXd R = MatrixXd::Zero(count, count);
  const Eigen::HouseholderQR<MatrixXd> qr(A.transpose());
  const Index rows = std::min(count, A.cols());
  R.topRows(rows) = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd> svd(R.transpose(), Eigen::ComputeFullU);
  const VectorXd sigma = svd.singularValues();
  const Index rank = (sigma.array() > shape_noise(data)).count();
  result.rank = static_cast<int>(rank);
  result.condition = sigma(0) / sigma(rank - 1);
  const MatrixXd still = readable(svd.matrixU().rightCols(count - rank));
  for (Index k = 0; k < still.cols(); ++k) {
    Vector6 w = Vector6::Zero();
    w(moving) = still.col(k).cwiseQuotient(norms);
    result.blocked.push_back(combination(w));
  }
  return result;
}

DataDigits data_digits(const ModalData& data) {
  const auto children = static_cast<Index>(data.children.size());
  Index row = 6 * children;
  for (const ModalLine& line : data.lines) row += static_cast<Index>(line.shapes.size());
  DataDigits result{VectorXd::Zero(row + 6), shape_noise(data), noise_of(data)};
  for (Index c = 0; c < children; ++c) {
    const ModalChild& child = data.children[static_cast<std::size_t>(c)];
    const Vector6 sizes = row_sizes(child);
    for (int i = 0; i < 6; ++i)
      if (!child.Phi_C.row(i).isZero(0)) result.size(6 * c + i) = sizes(i);
  }
  row = 6 * children;
  for (const ModalLine& line : data.lines)
    for (const double size : shape_sizes(data, line)) result.size(row++) = size;
  result.size.tail<6>() = data.D_P.diagonal().cwiseSqrt();
  return result;
}

EffectiveMass effective_mass(const ModalData& data) {
  const Vector6 inverse =
      data.D_P.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
  EffectiveMass result;
  result.fraction = data.L_P.cwiseAbs2() * inverse.asDiagonal();
  result.total = result.fraction.colwise().sum();
  return result;
}

std::vector<std::string> implausible(const ModalData& data) {
  constexpr double kMostPlausible = 0.2, kSlowest = 1e-4, kFastest = 1e6;
  std::vector<std::string> lines;
  Index mode = 0;
  if (data.xi.size() > 0 && data.xi.maxCoeff(&mode) > kMostPlausible)
    lines.push_back(fmt::format("damping ratio {:.3g} of mode {}, above {}: percent?",
                                data.xi(mode), mode + 1, kMostPlausible));
  if (data.omega.size() == 0) return lines;
  const double lowest = data.omega.minCoeff() / (2 * std::numbers::pi);
  if (lowest < kSlowest || lowest > kFastest)
    lines.push_back(fmt::format("lowest frequency {:.3g} Hz, {} {:g} Hz: units?", lowest,
                                lowest < kSlowest ? "below" : "above",
                                lowest < kSlowest ? kSlowest : kFastest));
  return lines;
}

std::vector<std::string> implausible_modulus(double E) {
  constexpr double kSoftest = 1e8;
  if (E >= kSoftest) return {};
  return {fmt::format("Young's modulus {:.3g} Pa, below {:g} Pa: in MPa?", E, kSoftest)};
}

ModalReport modal_report(const ModalData& data) {
  ModalReport report{data.omega, mass_properties(data.D_P), residual_mass(data),
                     {},         effective_mass(data),      implausible(data)};
  for (const ModalChild& child : data.children) report.children.push_back(child_rank(data, child));
  return report;
}

namespace {

std::string print(const ResidualMass& r) {
  const char* name = component_name(r.component);
  switch (r.verdict) {
    case Definiteness::definite:
      return fmt::format("residual mass D_P0: definite, smallest fraction {:.3g} at {}\n",
                         r.smallest, name);
    case Definiteness::singular:
      return fmt::format(
          "residual mass D_P0: singular to the data's digits ({:.1g}) at {}: the "
          "parent channel has no inverse there\n",
          r.noise, name);
    case Definiteness::indefinite: break;
  }
  return fmt::format(
      "residual mass D_P0: NEGATIVE at {}, {:.3g} of the rigid mass, beyond the "
      "data's digits ({:.1g})\n",
      name, r.smallest, r.noise);
}

std::string print(const ChildRank& c) {
  std::string text =
      fmt::format("Phi at {}: rank {}, condition {:.3g}", c.child, c.rank, c.condition);
  for (std::size_t i = 0; i < c.blocked.size(); ++i)
    text += (i == 0 ? "; cannot be locked or driven: " : ", ") + c.blocked[i];
  return text + "\n";
}

std::string print(const Vector6& fractions) {
  std::string text;
  for (const double f : fractions) text += fmt::format(" {:7.4f}", f);
  return text + "\n";
}

}  // namespace

std::string to_string(const ModalReport& report) {
  const MassProperties& m = report.mass;
  std::string text = fmt::format(
      "mass {:.8g} kg, centre of mass {:.6g} {:.6g} {:.6g} m from P, misfit to a rigid body "
      "{:.1e}\n",
      m.mass.mean(), m.centre.x(), m.centre.y(), m.centre.z(), m.misfit);
  text += print(report.residual);
  for (const ChildRank& child : report.children) text += print(child);
  text +=
      "effective mass, fraction of the total\n  mode     rad/s       x       y       z"
      "      rx      ry      rz\n";
  std::vector<Index> order(static_cast<std::size_t>(report.omega.size()));
  std::iota(order.begin(), order.end(), 0);
  const VectorXd largest = report.omega.size() == 0
                               ? VectorXd()
                               : VectorXd(report.effective.fraction.rowwise().maxCoeff());
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return largest(a) > largest(b); });
  order.resize(std::min<std::size_t>(order.size(), 10));
  std::sort(order.begin(), order.end());
  for (const Index k : order)
    text += fmt::format("  {:4} {:9.6g}", k + 1, report.omega(k)) +
            print(Vector6(report.effective.fraction.row(k)));
  text += fmt::format("  all {:10}", report.omega.size()) + print(report.effective.total);
  for (const std::string& line : report.implausible) text += "warning: " + line + "\n";
  return text;
}

}  // namespace titop
