#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <titop/blocks/fe/modal_checks.hpp>
#include <titop/graph/linalg/symmetric.hpp>

namespace titop {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// 1 / sqrt of a diagonal; 1 if there is nothing to scale.
Vector6 unit_scale(const Matrix6& D) {
  return D.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 1.0; });
}

}  // namespace

const char* component_name(int component) {
  static constexpr std::array<const char*, 6> names = {"x", "y", "z", "rx", "ry", "rz"};
  return names.at(static_cast<std::size_t>(component));
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
  result.noise = data_digits(data).mass;
  result.verdict = result.smallest > result.noise     ? Definiteness::definite
                   : result.smallest >= -result.noise ? Definiteness::singular
                                                      : Definiteness::indefinite;
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
  for (const ModalLine& line : data.lines) report.lines.push_back(line_rank(data, line));
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

std::string print(const std::vector<std::string>& blocked) {
  std::string text;
  for (std::size_t i = 0; i < blocked.size(); ++i)
    text += (i == 0 ? "; cannot be locked or driven: " : ", ") + blocked[i];
  return text + "\n";
}

std::string print(const ChildRank& c) {
  return fmt::format("Phi at {}: rank {}, condition {:.3g}", c.child, c.rank, c.condition) +
         print(c.blocked);
}

std::string print(const LineRank& l) {
  return fmt::format("Phi along line {}: rank {} of {}, condition {:.3g}", l.line, l.rank,
                     l.channels, l.condition) +
         print(l.blocked);
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
  for (const LineRank& line : report.lines) text += print(line);
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
