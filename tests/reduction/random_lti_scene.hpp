#pragma once

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <titop/titop.hpp>

#include "support/rng.hpp"

/// Scenes of one dense random Lti: its theorem holds, and its order is at most the minimal one.
namespace titop_test {

/// Lags and pairs of damping 1e-4 to 1 between 0.01 and 1000 rad/s, coupled in one of three cases,
/// in random orthogonal coordinates.
struct RandomLti {
  Eigen::MatrixXd A, B, C, D;
  std::vector<std::complex<double>> poles;

  explicit RandomLti(Rng& rng) {
    const int n = 1 + rng.below(10), inputs = 1 + rng.below(2), outputs = 1 + rng.below(2);
    A = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n;) {
      const double w = std::pow(10.0, rng.between(-2, 3));
      if (i + 1 < n && rng.chance(0.6)) {
        const double zeta = std::pow(10.0, rng.between(-4, 0));
        A.block(i, i, 2, 2) << -zeta * w, w, -w, -zeta * w;
        poles.emplace_back(-zeta * w, w);
        i += 2;
      } else {
        A(i, i) = -w;
        poles.emplace_back(-w, 0);
        ++i;
      }
    }
    if (rng.below(3) == 1)
      for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j)
          if (A(j, i) == 0) A(i, j) += rng.between(-3, 3) * std::sqrt(A(i, i) * A(j, j));
    const Eigen::MatrixXd T =
        Eigen::HouseholderQR<Eigen::MatrixXd>(rng.matrix(n, n)).householderQ();
    A = (T * A * T.transpose()).eval();
    B = rng.matrix(n, inputs);
    C = rng.matrix(outputs, n);
    D = rng.chance(0.5) ? rng.matrix(outputs, inputs) : Eigen::MatrixXd::Zero(outputs, inputs);
  }

  titop::Diagram diagram() const {
    titop::Diagram d{"lti"};
    const auto u = d.input("u", static_cast<int>(B.cols()));
    auto K = d.add("K", titop::Lti{.A = A, .B = B, .C = C, .D = D});
    K.in = u;
    d.output("y", static_cast<int>(C.rows())) = K.out;
    return d;
  }

  using LongMatrix = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;
  /// By elimination in long double.
  Eigen::MatrixXcd transfer(std::complex<double> s) const {
    LongMatrix M = -A.cast<std::complex<long double>>();
    M.diagonal().array() += std::complex<long double>(s);
    const LongMatrix G = C.cast<std::complex<long double>>() *
                             M.fullPivLu().solve(LongMatrix(B.cast<std::complex<long double>>())) +
                         D.cast<std::complex<long double>>();
    return G.cast<std::complex<double>>();
  }
};

/// Largest error of a pair relative to the pair's peak, on a grid of the scene's ray and beside
/// every pole.
inline double error(const RandomLti& lti, const titop::ReducedSystem& reduced,
                    const titop::Scene& scene) {
  const double zeta = scene.damping_floor, pi = std::numbers::pi,
               low = std::max(1e-6, 2 * pi * scene.band_hz[0]), high = 2 * pi * scene.band_hz[1];
  std::vector<double> omegas;
  for (int k = 0; k <= 200; ++k) omegas.push_back(low * std::pow(high / low, k / 200.0));
  for (const std::complex<double>& p : lti.poles)
    for (const double beside : {-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0})
      if (const double w = p.imag() + beside * p.real(); w >= low && w <= high) omegas.push_back(w);
  Eigen::MatrixXd worst = Eigen::MatrixXd::Zero(lti.C.rows(), lti.B.cols()), peak = worst;
  for (const double w : omegas) {
    const std::complex<double> s(zeta * w, std::sqrt(1 - zeta * zeta) * w);
    const Eigen::MatrixXcd G = lti.transfer(s);
    worst = worst.cwiseMax((G - reduced.transfer(s)).cwiseAbs());
    peak = peak.cwiseMax(G.cwiseAbs());
  }
  return worst.cwiseQuotient(peak).maxCoeff();
}

inline void check_scene_of_lti(std::uint64_t seed) {
  Rng rng(seed);
  const RandomLti lti(rng);
  const double low = rng.chance(0.5) ? 0 : std::pow(10.0, rng.between(-2, 1)),
               high = std::max(3 * low, std::pow(10.0, rng.between(-1, 2.5)));
  const titop::Scene scene{.band_hz = {low, high},
                           .accuracy = std::pow(10.0, rng.between(-6, -1)),
                           .bound = titop::BoundKind::theorem};
  const titop::ReducedSystem reduced = compile(lti.diagram(), scene);
  const titop::System full = compile(lti.diagram());
  CHECK(reduced.order() <= full.order_verdict().highest);
  CHECK(reduced.bound().worst <= scene.accuracy);
  // 1e-11: rounding of both transfers, in double near poles of damping 0.002.
  CHECK(error(lti, reduced, scene) <= reduced.bound().worst + 1e-11);
}

}  // namespace titop_test
