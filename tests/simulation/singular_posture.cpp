#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/four_bar.hpp"

/// Near a singular posture the angles of a closed chain have few digits: the error says so.

using namespace titop;
using titop_test::FourBar;
using titop_test::parallelogram;

namespace {

constexpr double kStiffness = FourBar::kStiffness, kCrank = 0.3;
/// Crank and rocker turn about their pins, the coupler translates on a circle.
const double kInertia = 2 * (0.1 + 2 * 0.15 * 0.15) + 3 * kCrank * kCrank;

}  // namespace

TEST_CASE("a parallelogram near its folded posture: the error covers that of both angles") {
  const double omega = std::sqrt(kStiffness / kInertia);
  for (const double angle : {1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 3.7e-6, 1e-6, 1e-7, 3.7e-8, 1e-8}) {
    CAPTURE(angle);
    const Trajectory t =
        simulate(compile(diagram(parallelogram(angle))),
                 Excitation::step(Eigen::VectorXd::Constant(1, 1.0)), {.step = 0.01, .until = 2});
    Eigen::Vector2d off = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < t.time.size(); ++k) {
      const double turn = (1 - std::cos(omega * t.time[k])) / kStiffness;
      off = off.cwiseMax(
          (t.y.col(static_cast<Eigen::Index>(k)).array() - turn).abs().matrix().eval());
    }
    off *= kStiffness / 2;  // the largest turn is 2 / stiffness
    for (const Eigen::Index i : {0, 1}) {
      CAPTURE(i);
      CHECK(off(i) <= t.error(i) + 1e-13);
      CHECK(t.error(i) <= 1e-13 / angle);  // and claims no more than some hundred roundings
    }
  }
}
