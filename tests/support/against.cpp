#include "reduction/against.hpp"

#include <algorithm>
#include <numbers>
#include <titop/graph/linalg/eigen.hpp>

#include "reduction/tree.hpp"

namespace titop_test {

Truth accelerations(const by_hand::Structure& a, Eigen::Index rigid) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXl> modes(a.K.cast<long double>(),
                                                                 a.M.cast<long double>());
  Eigen::VectorXd lambda = modes.eigenvalues().cast<double>();
  lambda.head(rigid).setZero();
  const MatrixXl& V = modes.eigenvectors();
  using Eigen::MatrixXcd;
  const MatrixXcd b = (V.transpose() * a.B.cast<long double>()).cast<std::complex<double>>(),
                  c = (a.C.cast<long double>() * V).cast<std::complex<double>>();
  Truth truth{[=](std::complex<double> s) {
                const Eigen::VectorXcd each = s * s / (s * s + lambda.array());
                return MatrixXcd(c * each.asDiagonal() * b);
              },
              {}};
  for (const double x : lambda.tail(lambda.size() - rigid)) truth.omegas.push_back(std::sqrt(x));
  return truth;
}

std::vector<double> fine_points(const titop::Scene& scene, const std::vector<double>& poles,
                                int steps) {
  using std::numbers::pi;
  struct Point {
    double omega, phase;
  };
  const double low = 2 * pi * scene.band_hz[0], high = 2 * pi * scene.band_hz[1];
  const auto point = [&](double omega) {
    Point p{omega, 0};
    for (const double pole : poles) {
      if (!(pole > 0)) continue;  // a free motion has no resonance
      const double centre = std::clamp(pole, low, high);
      const double width = scene.damping_floor * pole + std::abs(pole - centre);
      p.phase += 2 * std::atan((omega - centre) / width);
    }
    return p;
  };
  std::vector<double> points;
  const auto fill = [&](auto&& self, const Point& a, const Point& b) -> void {
    if (b.phase - a.phase <= 0.04) return points.push_back(b.omega);
    const Point middle = point((a.omega + b.omega) / 2);
    self(self, a, middle);
    self(self, middle, b);
  };
  if (low > 0) points.push_back(low);
  Point before = point(low);
  for (int i = 1; i <= steps; ++i) {
    const double part = std::pow(std::sin(pi / 2 * i / steps), 2);
    const Point here = point(i < steps ? low + (high - low) * part : high);
    fill(fill, before, here);
    before = here;
  }
  return points;
}

bool Compared::is_zero(Eigen::Index i, Eigen::Index j) const {
  return !(peak(i, j) > 1e-9 * peak.row(i).maxCoeff() * peak.col(j).maxCoeff() / peak.maxCoeff());
}

double Compared::relative() const {
  double worst = 0;
  for (Eigen::Index i = 0; i < peak.rows(); ++i)
    for (Eigen::Index j = 0; j < peak.cols(); ++j)
      if (!is_zero(i, j)) worst = std::max(worst, error(i, j) / peak(i, j));
  return worst;
}

Compared compared(const titop::Scene& scene, const std::vector<double>& points, const Truth& truth,
                  const TransferOf& other) {
  Compared result;
  const double zeta = scene.damping_floor;
  for (const double w : points) {
    const std::complex<double> s{zeta * w, std::sqrt(1 - zeta * zeta) * w};
    const Eigen::MatrixXcd H = truth.transfer(s);
    if (result.peak.size() == 0)
      result.error = result.peak = Eigen::MatrixXd::Zero(H.rows(), H.cols());
    result.error = result.error.cwiseMax((H - other(s)).cwiseAbs());
    result.peak = result.peak.cwiseMax(H.cwiseAbs());
  }
  return result;
}

Beside beside(const titop::ReducedSystem& r, const titop::Scene& scene, const Truth& truth,
              int steps) {
  const titop::ErrorBound& b = r.bound();
  const auto points = fine_points(scene, truth.omegas, std::max(steps, 18 * b.samples));
  const Compared c =
      compared(scene, points, truth, [&](std::complex<double> s) { return r.transfer(s); });
  Beside result;
  result.error = c.relative();
  const Eigen::MatrixXd used = c.error.cwiseQuotient(b.peak.cwiseProduct(b.pairs));
  result.bound = used.maxCoeff();
  Eigen::Index row = 0, column = 0;
  b.pairs.maxCoeff(&row, &column);
  result.sharp = used(row, column);
  for (Eigen::Index i = 0; i < c.peak.rows(); ++i)
    for (Eigen::Index j = 0; j < c.peak.cols(); ++j) {
      if (c.is_zero(i, j)) continue;
      result.peak_low = std::min(result.peak_low, b.peak(i, j) / c.peak(i, j));
      result.peak_high = std::max(result.peak_high, b.peak(i, j) / c.peak(i, j));
    }
  return result;
}

}  // namespace titop_test
