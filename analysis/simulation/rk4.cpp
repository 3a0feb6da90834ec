#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <titop/analysis/simulation/simulate.hpp>
#include <titop/analysis/simulation/steppers.hpp>
#include <titop/graph/linalg/dense.hpp>
#include <titop/graph/linalg/rounding.hpp>

namespace titop {
namespace {

using Eigen::VectorXd;

class Rk4 : public detail::StepRule {
 public:
  Rk4(const System& system, double h) : system_(system), h_(h) {}

  VectorXd step(const VectorXd& x, const VectorXd& u0, const VectorXd& u1) const override {
    const VectorXd middle = 0.5 * (u0 + u1);
    const VectorXd a = rate(x, u0), b = rate(x + h_ / 2 * a, middle),
                   c = rate(x + h_ / 2 * b, middle), d = rate(x + h_ * c, u1);
    return x + h_ / 6 * (a + 2 * b + 2 * c + d);
  }

 private:
  VectorXd rate(const VectorXd& x, const VectorXd& u) const { return system_.apply(x, u).xdot; }

  const System& system_;
  double h_;
};

/// |1 + z + z^2/2 + z^3/6 + z^4/24| beyond 1.
bool grows(std::complex<double> z) {
  return std::abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) > 1;
}

/// The largest |z| along the ray of a stable pole, where growth begins.
double reach(std::complex<double> direction) {
  double inside = 2.5, outside = 4;  // the region contains the half disc of 2.5, none of 4
  for (int i = 0; i < 50; ++i) {
    const double middle = (inside + outside) / 2;
    (grows(middle * direction) ? outside : inside) = middle;
  }
  return inside;
}

}  // namespace

double rk4_limit(const System& system) {
  StateSpace m;
  system.write(m);
  double limit = std::numeric_limits<double>::infinity();
  if (m.A.size() == 0) return limit;
  const Eigen::VectorXcd poles = linalg::eigenvalues(m.A);
  for (std::complex<double> p : poles) {
    const double size = std::abs(p);
    if (!(size > 0) || p.real() > linalg::kPoleOnAxis * size) continue;
    // On the axis up to rounding: along it the region reaches sqrt(8).
    if (std::abs(p.real()) <= linalg::kPoleOnAxis * size) p = {0, size};
    limit = std::min(limit, reach(p / size) / size);
  }
  return limit;
}

namespace detail {

std::unique_ptr<StepRule> rk4_rule(const System& system, double h) {
  const double limit = rk4_limit(system);
  if (h > limit)
    throw Error(Code::bad_value,
                fmt::format("rk4 is unstable with steps of {:.6g} s: {} allows {:.6g} s at most", h,
                            system.stage().graph.name, limit),
                "take smaller steps, or Stepper::exact or Stepper::midpoint, which are stable at "
                "any step");
  return std::make_unique<Rk4>(system, h);
}

}  // namespace detail
}  // namespace titop
