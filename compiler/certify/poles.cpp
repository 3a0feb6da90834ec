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

/// Below this a pole may be one at 0 that rounding has moved: integrators leave a row or a column
/// of zeros, and the eigenvalues of a chain of them lie on a circle of the size of a root of
/// rounding.
double smeared_zero(const Eigen::MatrixXd& A, const VectorXcd& values) {
  for (Index i = 0; i < A.rows(); ++i)
    if (A.col(i).isZero(0) || A.row(i).isZero(0)) return 1e-5 * values.cwiseAbs().maxCoeff();
  return 0;
}

}  // namespace

FullCertificate::Poles check_poles(const System& system, const StateSpace& model,
                                   const Eigen::MatrixXd& rounding, std::vector<double>& omegas) {
  FullCertificate::Poles p;
  p.done = true;
  p.count = model.order();
  const linalg::Eigensystem e = linalg::eigensystem(model.A);
  const double smeared = smeared_zero(model.A, e.values);
  const double norm = (e.scale.cwiseInverse().asDiagonal() * model.A * e.scale.asDiagonal()).norm();
  const VectorXd left = (e.W * e.scale.asDiagonal()).rowwise().norm(),
                 right = (e.scale.cwiseInverse().asDiagonal() * e.V).colwise().norm();
  for (Index k = 0; k < e.values.size(); ++k) {
    const std::complex<double> s = e.values(k);
    const double size = std::abs(s);
    const double moved = (e.W.row(k).cwiseAbs() * rounding * e.V.col(k).cwiseAbs())(0);
    if (size <= smeared || !(kEps * norm * left(k) * right(k) + moved <= kMeasurable * size))
      continue;
    omegas.push_back(size);
    const int both = s.imag() != 0 ? 2 : 1;
    if (s.imag() < 0) continue;
    const VectorXcd off = times(system, e.V.col(k)) - s * e.V.col(k);
    const double error = std::abs((e.W.row(k) * off)(0)) / size;
    p.measured += both;
    if (error > p.error) p.error = error, p.where = s;
    if (s.real() > std::max(1e-9, 10 * error) * size) p.right += both;
    if (p.rightmost == 0.0 || s.real() / size > p.rightmost.real() / std::abs(p.rightmost))
      p.rightmost = s;
  }
  std::sort(omegas.begin(), omegas.end());
  return p;
}

}  // namespace titop::full
