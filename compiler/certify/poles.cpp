#include <algorithm>
#include <cmath>
#include <limits>
#include <titop/compiler/certify/poles.hpp>
#include <titop/compiler/system.hpp>
#include <titop/graph/linalg/dense.hpp>

namespace titop::full {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kEps = std::numeric_limits<double>::epsilon();
/// A pole that rounding of A may move by more than this, of its size, says nothing about the model.
constexpr double kMeasurable = 1e-8;

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

FullCertificate::Poles check_poles(const System& system, const StateSpace& model,
                                   const Eigen::MatrixXd& rounding, std::vector<double>& omegas) {
  FullCertificate::Poles p;
  p.done = true;
  p.count = model.order();
  const linalg::Eigensystem e = linalg::eigensystem(model.A);
  const double norm = (e.scale.cwiseInverse().asDiagonal() * model.A * e.scale.asDiagonal()).norm();
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  const auto keep_rightmost = [&](std::complex<double> s) {
    if (p.rightmost == 0.0 || lean(s) > lean(p.rightmost)) p.rightmost = s;
  };
  for (Index k = 0; k < e.values.size(); ++k) {
    const std::complex<double> s = e.values(k);
    const double size = std::abs(s);
    const double moved = (e.W.row(k).cwiseAbs() * rounding * e.V.col(k).cwiseAbs())(0);
    const double rounded = kEps * norm * left(k) * right(k) + moved;
    if (rounded <= 0.1 * size) omegas.push_back(size);
    if (!(rounded <= kMeasurable * size)) {
      if (s.real() > 10 * rounded) {  // not measured, but where it is not in doubt
        ++p.right;
        keep_rightmost(s);
      }
      continue;
    }
    const int both = s.imag() != 0 ? 2 : 1;
    if (s.imag() < 0) continue;
    const VectorXcd off = times(system, e.V.col(k)) - s * e.V.col(k);
    const double error = std::abs((e.W.row(k) * off)(0)) / size;
    p.measured += both;
    if (error > p.error) p.error = error, p.where = s;
    if (s.real() > std::max(1e-9, 10 * error) * size) p.right += both;
    keep_rightmost(s);
  }
  std::sort(omegas.begin(), omegas.end());
  return p;
}

}  // namespace titop::full
