#include "support/lossy_row.hpp"

#include <doctest/doctest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <titop/titop.hpp>
#include <utility>
#include <vector>

/// Rows of masses in which waves decay: each step of the factors' rules against the same rule for
/// the row's own tridiagonal equations in 50 digits, down to forces of 1e-290.

using namespace titop;
using Big = boost::multiprecision::cpp_bin_float_50;
using Numbers = std::vector<Big>;

namespace {

constexpr double kStiffness = 10;

/// n masses of 1 kg on springs of 10 N/m with dampers, on a wall; a force of 1 N on the tip.
struct Masses {
  int n;
  Big damping;
  Numbers x = Numbers(static_cast<std::size_t>(n)), v = x;

  std::size_t tip() const { return static_cast<std::size_t>(n) - 1; }
  Numbers accelerations(const Numbers& at, const Numbers& rates) const {
    Numbers stretch(at.size()), a(at.size());
    for (std::size_t i = 0; i < at.size(); ++i)
      stretch[i] = kStiffness * (i > 0 ? Big(at[i] - at[i - 1]) : at[i]) +
                   damping * (i > 0 ? Big(rates[i] - rates[i - 1]) : rates[i]);
    for (std::size_t i = 0; i < at.size(); ++i)
      a[i] = (i < tip() ? stretch[i + 1] : Big(1)) - stretch[i];
    return a;
  }
  /// Force on the wall, and acceleration of the tip.
  Big wall() const { return kStiffness * x[0] + damping * v[0]; }
  Big tip_acceleration() const { return accelerations(x, v).back(); }

  /// s (x' - x) = v', s (v' - v) = a(x', v') for the middle x', v': a tridiagonal system.
  void midpoint(double h) {
    const Big s = 2 / Big(h), z = kStiffness + damping * s;
    const Numbers damped = accelerations(Numbers(x.size()), x);  // 1 N less the dampers at rates x
    Numbers diagonal(x.size(), s * s + 2 * z), middle(x.size());
    diagonal.back() = s * s + z;
    for (std::size_t i = 0; i < x.size(); ++i)
      middle[i] =
          s * (s * x[i] + v[i]) - s * (damped[i] - (i == tip() ? 1 : 0)) + (i == tip() ? 1 : 0);
    for (std::size_t i = 1; i < x.size(); ++i) {
      const Big by = z / diagonal[i - 1];
      diagonal[i] -= by * z, middle[i] += by * middle[i - 1];
    }
    for (std::size_t i = x.size(); i-- > 0;)
      middle[i] = (middle[i] + (i < tip() ? Big(z * middle[i + 1]) : Big(0))) / diagonal[i];
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Big rate = s * (middle[i] - x[i]);
      x[i] = 2 * middle[i] - x[i], v[i] = 2 * rate - v[i];
    }
  }

  void rk4(double h) {
    Numbers sum_x(x.size()), sum_v(x.size()), at = x, rates = v;
    for (const auto& [next, weight] : {std::pair(0.5, 1), {0.5, 2}, {1.0, 2}, {0.0, 1}}) {
      const Numbers a = accelerations(at, rates), speed = rates;
      for (std::size_t i = 0; i < x.size(); ++i) {
        sum_x[i] += weight * speed[i], sum_v[i] += weight * a[i];
        at[i] = x[i] + next * h * speed[i], rates[i] = v[i] + next * h * a[i];
      }
    }
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * sum_x[i] / 6, v[i] += h * sum_v[i] / 6;
  }
};

/// Relative; below 1e-290 numbers have not all their digits.
double off(double found, const Big& exact) {
  if (abs(exact) < 1e-290) return std::abs(found) < 1e-289 ? 0 : 1;
  return std::abs(static_cast<double>(Big(found) / exact - 1));
}

}  // namespace

TEST_CASE("lossy rows: steps by midpoint and rk4 have all digits of both ends") {
  using titop_test::LossyRow;
  for (const int n : {10, 60, 300})
    for (const double damping : {0.1, 20.0, 1000.0}) {
      const System system =
          compile(LossyRow{n, damping, LossyRow::Base::held, LossyRow::Tip::force}.diagram());
      for (const Stepper stepper : {Stepper::midpoint, Stepper::rk4}) {
        const double h = stepper == Stepper::midpoint ? 0.05 : 0.5 * rk4_limit(system);
        const Trajectory found = simulate(system, Excitation::step(Eigen::VectorXd::Ones(1)),
                                          {.step = h, .until = 8 * h, .stepper = stepper});
        Masses row{n, damping};
        const double sign = found.y(0, 1) < 0 ? -1 : 1;  // of a reaction
        for (Eigen::Index k = 0; k < found.y.cols(); ++k) {
          CAPTURE(n);
          CAPTURE(damping);
          CAPTURE(k);
          CHECK(off(sign * found.y(0, k), row.wall()) <= 1e-12);
          CHECK(off(found.y(1, k), row.tip_acceleration()) <= 1e-12);
          stepper == Stepper::midpoint ? row.midpoint(h) : row.rk4(h);
        }
      }
    }
}
