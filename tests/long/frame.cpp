#include <doctest/doctest.h>

#include <numeric>

#include "../../examples/scenes/satellite.hpp"
#include "reduction/scenes.hpp"
#include "support/close.hpp"

/// Three beams of CalculiX, 342 modes each, in the skew frame of tests/reduction: as many modes as
/// the scene needs, compared with the usual truncation.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

/// Accelerations by some of the modes, as a sum.
Truth sum_of(const InModes& m) {
  const MatrixXcd b = m.b.cast<Complex>(), c = m.c.cast<Complex>();
  Truth truth{[=, mu = m.mu](Complex s) {
                const Eigen::VectorXcd each = s * s / (1.0 + s * s * mu.array());
                return MatrixXcd(c * each.asDiagonal() * b);
              },
              {}};
  for (const double x : m.mu) truth.omegas.push_back(1 / std::sqrt(x));
  return truth;
}

/// Plain truncation: the fewest modes, taken in this order, such that the sum of the others is at
/// most `accuracy` of any pair's peak on these points.
Index plain_truncation(const InModes& m, const std::vector<Complex>& s, const MatrixXd& peak,
                       const std::vector<Index>& order, double accuracy) {
  std::vector<MatrixXcd> rest(s.size(), MatrixXcd::Zero(peak.rows(), peak.cols()));
  auto fewest = static_cast<Index>(order.size());
  for (Index k = fewest - 1; k >= 0; --k) {
    const Index j = order[static_cast<std::size_t>(k)];
    const MatrixXd shape = m.c.col(j) * m.b.row(j);
    double worst = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      rest[i] += s[i] * s[i] / (1.0 + s[i] * s[i] * m.mu(j)) * shape;
      worst = std::max(worst, rest[i].cwiseAbs().cwiseQuotient(peak).maxCoeff());
    }
    if (worst <= accuracy) fewest = k;
  }
  return fewest;
}

/// Modes by their own largest part of any pair, largest first.
std::vector<Index> by_own_peak(const InModes& m, const std::vector<Complex>& s,
                               const MatrixXd& peak) {
  VectorXd size = VectorXd::Zero(m.mu.size());
  for (Index j = 0; j < size.size(); ++j) {
    double gain = 0;
    for (const Complex& x : s) gain = std::max(gain, std::abs(x * x / (1.0 + x * x * m.mu(j))));
    size(j) = gain * (m.c.col(j) * m.b.row(j)).cwiseAbs().cwiseQuotient(peak).maxCoeff();
  }
  std::vector<Index> order(static_cast<std::size_t>(size.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index i, Index j) { return size(i) > size(j); });
  return order;
}

}  // namespace

TEST_CASE("the CalculiX frame up to its tenth frequency to 1e-4: 20 coordinates of 1026") {
  const FlexibleBody beam = scenes::read_boom({});
  REQUIRE(beam.data().omega.size() == 342);
  const InModes modes = in_modes<double>(frame_by_hand(beam.data()), false);
  const Truth truth = sum_of(modes);
  const double end = truth.omegas[truth.omegas.size() - 10] / (2 * std::numbers::pi);
  const titop::Scene scene{.band_hz = {0, end}, .accuracy = 1e-4};
  const ReducedSystem r = compile(frame(beam), scene);
  CHECK(r.full().order() == 2 * 1026);
  CHECK(r.order() <= 2 * 20);
  const Beside by_hand = check_beside(r, scene, truth);
  CHECK(r.bound().worst <= 1.2 * by_hand.error);
  for (const KeptMode& m : r.modes()) {
    if (!m.exact) continue;
    double nearest = 1;
    for (const double w : truth.omegas)
      nearest = std::min(nearest, relative(2 * std::numbers::pi * m.hertz, w));
    CHECK(nearest <= 1e-8);
  }

  // Plain truncation of the whole to the same accuracy, on a grid that can only miss some of it.
  const std::vector<double> points = fine_points(scene, truth.omegas, 200);
  std::vector<Complex> s;
  for (std::size_t k = 0; k < points.size(); k += 8)
    s.push_back(points[k] * Complex(0.002, std::sqrt(1 - 0.002 * 0.002)));
  std::vector<Index> by_frequency(static_cast<std::size_t>(modes.mu.size()));
  std::iota(by_frequency.rbegin(), by_frequency.rend(), 0);
  const Index frequency = plain_truncation(modes, s, r.bound().peak, by_frequency, 1e-4);
  const Index own_peak =
      plain_truncation(modes, s, r.bound().peak, by_own_peak(modes, s, r.bound().peak), 1e-4);
  CHECK(frequency >= 15 * r.order());  // r.order() / 2 coordinates: 30 times as many and more
  CHECK(own_peak >= 7 * r.order());

  // Each beam by its modes up to twice the band: another structure.
  const ModalData ruled = scenes::up_to(beam.data(), 2 * end);
  CHECK(ruled.omega.size() >= 4);
  const double off =
      compared(scene, points, truth, sum_of(in_modes<double>(frame_by_hand(ruled), false)).transfer)
          .relative();
  CHECK(off > 0.5);
}
