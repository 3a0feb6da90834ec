#include <algorithm>
#include <cmath>
#include <titop/analysis/certify/faults.hpp>
#include <titop/analysis/certify/poles.hpp>
#include <titop/compiler/system/system.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop::certification {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// A pole that rounding of A may move by more than this, relative to its size, gives no verdict on
/// the model.
constexpr double kMeasurable = 1e-8;
/// Times its possible error: the real part of a pole that is surely right of the axis.
constexpr double kSurely = 10;

/// A v through the factors.
VectorXcd times(const System& system, const VectorXcd& v) {
  const VectorXd u = VectorXd::Zero(static_cast<Index>(system.inputs().size()));
  VectorXcd result(v.size());
  result.real() = system.apply(v.real(), u).xdot;
  result.imag() = system.apply(v.imag(), u).xdot;
  return result;
}

double lean(std::complex<double> s) { return s.real() / std::abs(s); }

}  // namespace

FoundPoles check_poles(const System& system, const StateSpace& model,
                       const Eigen::MatrixXd& rounding) {
  FoundPoles found;
  FullCertificate::Poles& p = found.poles;
  p.done = true;
  p.count = model.order();
  const linalg::Eigensystem e = linalg::eigensystem(model.A);
  const double norm = (e.scale.cwiseInverse().asDiagonal() * model.A * e.scale.asDiagonal()).norm();
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  const auto keep_rightmost = [&](std::complex<double> s) {
    if (s == 0.0) return;  // neither left nor right
    if (p.rightmost == 0.0 || lean(s) > lean(p.rightmost)) p.rightmost = s;
  };
  for (Index k = 0; k < e.values.size(); ++k) {
    const std::complex<double> s = e.values(k);
    const double size = std::abs(s);
    const double moved = (e.W.row(k).cwiseAbs() * rounding * e.V.col(k).cwiseAbs())(0);
    const double rounded = linalg::kEpsilon * norm * left(k) * right(k) + moved;
    if (size > 0 && rounded <= linalg::kOneDigit * size) found.omegas.push_back(size);
    if (!(rounded <= kMeasurable * size)) {
      if (s.real() > kSurely * rounded) {  // not measured, but if it is not in doubt
        found.right.push_back({s, rounded});
        keep_rightmost(s);
      }
      continue;
    }
    const int both = s.imag() != 0 ? 2 : 1;
    if (s.imag() < 0) continue;
    const VectorXcd off = times(system, e.V.col(k)) - s * e.V.col(k);
    const double change = std::abs((e.W.row(k) * off)(0));
    const double error = change == 0 ? 0 : change / size;  // 0 to the last bit if A is 0
    p.measured += both;
    if (error > p.error) p.error = error, p.where = s;
    if (s.real() > std::max(linalg::kPoleOnAxis, kSurely * error) * size) {
      found.right.push_back({s, rounded});
      if (both == 2) found.right.push_back({std::conj(s), rounded});
    }
    keep_rightmost(s);
  }
  p.right = static_cast<int>(found.right.size());
  std::sort(found.omegas.begin(), found.omegas.end());
  return found;
}

std::vector<FoundPoles::Right> shown(const std::vector<FoundPoles::Right>& right,
                                     const StateSpace& minimal) {
  if (right.empty()) return {};
  const VectorXcd values = linalg::eigenvalues(minimal.A);
  std::vector<std::complex<double>> all(values.begin(), values.end());
  std::vector<FoundPoles::Right> result;
  for (const FoundPoles::Right& pole : right) {
    const double apart = std::max(kPoleHolds * std::abs(pole.s), pole.rounding);
    const auto same = std::find_if(all.begin(), all.end(), [&](std::complex<double> s) {
      return std::abs(s - pole.s) <= apart;
    });
    if (same == all.end()) continue;
    result.push_back(pole);
    all.erase(same);
  }
  return result;
}

std::vector<std::complex<double>> around(const std::vector<FoundPoles::Right>& growing) {
  constexpr int kPoles = 8;  // one that adds energy is enough
  const std::complex<double> directions[] = {1, {0, 1}, -1, {0, -1}};
  std::vector<std::complex<double>> points;
  int taken = 0;
  for (const FoundPoles::Right& pole : growing) {
    if (pole.s.imag() < 0 || ++taken > kPoles) continue;
    for (const double radius : {0.1, 1e-3})
      for (const std::complex<double> direction : directions)
        points.push_back(pole.s + radius * pole.s.real() * direction);
  }
  return points;
}

}  // namespace titop::certification
