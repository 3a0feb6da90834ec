// Co-design: the stiffness and damper of a boom's root, the place of the wing and the gains of the
// attitude law are chosen together, for the least mass that keeps the pointing error, the distance
// of the loop from instability and the frequency of the wing where they must be. NLopt's SLSQP uses
// the exact derivatives of the three models. At the optimum the gradients are compared with
// differences in 50 digits of a model assembled by hand, and the conditions of Karush, Kuhn and
// Tucker are evaluated.
#include <Eigen/QR>
#include <chrono>
#include <cstdio>
#include <nlopt.hpp>
#include <optional>
#include <titop/titop.hpp>

#include "by_hand/codesign.hpp"

using namespace titop;
using namespace codesign;
using Eigen::VectorXd;

namespace {

// --- the satellite -------------------------------------------------------------------------------

/// The parameters of the diagrams.
const std::vector<std::string> kNames = {"k", "c", "y", "kp", "kd", "m"};
ParameterList parameters(const VectorXd& x) {
  ParameterList list;
  for (int i = 0; i < kVariables; ++i)
    list.emplace_back(kNames[static_cast<std::size_t>(i)], x(i) * kReference(i));
  list.emplace_back("m", kPanel + boom_mass(x(stiffness)));
  return list;
}

enum class Question { pointing, margin, frequency };

/// A free hub whose attitude is controlled about all axes; the wing lies in its plane z = 0, so
/// that turns about z stay apart from the others.
Diagram satellite(Question question) {
  Diagram d{"satellite"};
  const auto p = [&](Design i) { return d.param(kNames[i], kReference(i)); };
  const Param k = p(stiffness), c = p(damper), y = p(place), kp = p(proportional),
              kd = p(derivative), m = d.param("m", kPanel + boom_mass(1.0));
  const Vector3d up(0, 0, 1);
  auto hub = d.add("hub", RigidBody{.mass = kHub,
                                    .inertia = Vector3d(200, 200, kHubInertia).asDiagonal(),
                                    .children = {{"wing", {0, y, 0}}}});
  auto wing = d.add("wing", RigidBody{.mass = m,
                                      .inertia = Vector3d(60, 1, kPanelTurn).asDiagonal(),
                                      .PA = {0, kArm, 0}});
  auto root = hinge(d, "root", wing, hub.child("wing"), Rotation(), up);
  root.torque = k * root.angle + c * root.rate;
  auto T = d.input("T");  // disturbing torque about z [N m]
  const Eigen::MatrixXd about = up, I = Eigen::MatrixXd::Identity(3, 3);
  hub.parent.force.linear = 0;
  if (question == Question::frequency) {
    hub.parent.force.angular = -about * T;
    d.output("accel") = hub.parent.accel.about(up);
    return d;
  }
  auto law = d.add("law", Lti{.A = -kLag * I, .B = kLag * I, .C = I});
  law.in = kp * hub.parent.position.angular() + kd * hub.parent.rate.angular();
  hub.parent.force.angular = law.out - about * T;
  if (question == Question::pointing)
    d.output("angle") = hub.parent.position.angular().along(up);  // [rad]
  else
    d.output("torque") = T - about.transpose() * law.out;  // sensitivity
  return d;
}

// --- constraints and their exact gradients -------------------------------------------------------

/// Constraints g <= 0, relative to their bounds, and gradients (a row each) by the design
/// variables.
struct Constraints {
  VectorXd g = VectorXd(kConstraints);
  Eigen::MatrixXd gradient = Eigen::MatrixXd(kConstraints, kVariables);
};

/// By the design variables: m follows from the stiffness.
Eigen::RowVectorXd by_design(const VectorXd& by_parameter, const VectorXd& x) {
  VectorXd g = by_parameter.head(kVariables).cwiseProduct(kReference);
  g(stiffness) += by_parameter(kVariables) * 4.5 / std::sqrt(x(stiffness));
  return g.transpose();
}

class Models {
 public:
  const Constraints& at(const VectorXd& x) {
    if (at_ && *at_ == x) return now_;
    const ParameterList p = parameters(x);
    const Slopes h2 = derivatives(pointing_.update(p), kNames).h2();
    now_.g(0) = h2.value / kPointing - 1;
    now_.gradient.row(0) = by_design(h2.slopes / kPointing, x);
    const PeakSlopes s = derivatives(margin_.update(p), kNames).peak();
    now_.g(1) = s.value / kSensitivity - 1;
    now_.gradient.row(1) = by_design(s.slopes / kSensitivity, x);
    const PoleSlopes pole = derivatives(frequency_.update(p), kNames).poles().back();
    VectorXd slopes(kVariables + 1);
    for (int i = 0; i <= kVariables; ++i)
      slopes(i) = pole.slopes[static_cast<std::size_t>(i)](0).imag();
    now_.g(2) = 1 - pole.s.imag() / kFrequency;
    now_.gradient.row(2) = by_design(-slopes / kFrequency, x);
    at_ = x;
    return now_;
  }

 private:
  System pointing_ = compile(satellite(Question::pointing)),
         margin_ = compile(satellite(Question::margin)),
         frequency_ = compile(satellite(Question::frequency));
  std::optional<VectorXd> at_;
  Constraints now_;
};

// --- checks --------------------------------------------------------------------------------------

double largest_error(const VectorXd& x, const Constraints& exact, double peak) {
  const Real h = 1e-15;
  const Digits here = x.cast<Real>();
  double worst = (constraints_by_hand(here, peak).cast<double>() - exact.g).cwiseAbs().maxCoeff();
  for (int i = 0; i < kVariables; ++i) {
    Digits more = here, less = here;
    more(i) += h, less(i) -= h;
    const Digits difference =
        (constraints_by_hand(more, peak) - constraints_by_hand(less, peak)) / (2 * h);
    worst =
        std::max(worst, (difference.cast<double>() - exact.gradient.col(i)).cwiseAbs().maxCoeff());
  }
  return worst;
}

// --- the optimum ---------------------------------------------------------------------------------

VectorXd least() {
  VectorXd x = VectorXd::Constant(kVariables, kLeast);
  x(place) = kClearance;
  return x;
}

VectorXd optimum(Models& models) {
  nlopt::opt search(nlopt::LD_SLSQP, kVariables);
  const auto lower = least();
  search.set_lower_bounds({lower.data(), lower.data() + kVariables});
  search.set_upper_bounds(kMost);
  search.set_min_objective(
      [](unsigned n, const double* x, double* gradient, void*) {
        VectorXd g;
        const double mass = mass_of(Eigen::Map<const VectorXd>(x, n), g);
        if (gradient) std::copy(g.begin(), g.end(), gradient);
        return mass;
      },
      nullptr);
  search.add_inequality_mconstraint(
      [](unsigned, double* g, unsigned n, const double* x, double* gradient, void* data) {
        const Constraints& c = static_cast<Models*>(data)->at(Eigen::Map<const VectorXd>(x, n));
        std::copy(c.g.begin(), c.g.end(), g);
        if (!gradient) return;
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        Eigen::Map<RowMajor>(gradient, kConstraints, kVariables) = c.gradient;
      },
      &models, std::vector<double>(kConstraints, 1e-10));
  search.set_xtol_rel(1e-12);
  search.set_maxeval(200);
  std::vector<double> x(kVariables, kStart);
  double mass = 0;
  search.optimize(x, mass);
  return Eigen::Map<const VectorXd>(x.data(), kVariables);
}

/// Residual of the conditions of Karush, Kuhn and Tucker relative to the gradient of the mass:
/// multipliers of the active constraints and bounds by least squares. A negative one fails.
double kkt(const VectorXd& x, const Constraints& c, VectorXd& multipliers) {
  constexpr double kActive = 1e-8;
  VectorXd mass;
  mass_of(x, mass);
  std::vector<VectorXd> active;
  for (int i = 0; i < kConstraints; ++i)
    if (c.g(i) > -kActive) active.emplace_back(c.gradient.row(i).transpose());
  for (int i = 0; i < kVariables; ++i)
    if (x(i) < least()(i) + kActive) active.emplace_back(-VectorXd::Unit(kVariables, i));
  Eigen::MatrixXd G(kVariables, static_cast<Eigen::Index>(active.size()));
  for (Eigen::Index i = 0; i < G.cols(); ++i) G.col(i) = active[static_cast<std::size_t>(i)];
  multipliers = G.colPivHouseholderQr().solve(-mass);
  if (multipliers.minCoeff() < 0 || c.g.maxCoeff() > kActive) return 1;
  return (mass + G * multipliers).norm() / mass.norm();
}

template <class F>
double milliseconds(F f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int main() {
  Models models;
  const VectorXd x = optimum(models);
  const Constraints c = models.at(x);
  VectorXd ignored, multipliers;
  std::printf("least mass %.3f kg, from %.3f kg at the start\n", mass_of(x, ignored),
              mass_of(VectorXd::Constant(kVariables, kStart), ignored));
  const char* what[] = {"stiffness of the root [N m/rad]", "damper [N m s/rad]",
                        "place of the wing [m]", "gain of the angle [N m/rad]",
                        "gain of the rate [N m s/rad]"};
  for (int i = 0; i < kVariables; ++i)
    std::printf("  %-34s %9.4g\n", what[i], x(i) * kReference(i));
  const char* bounds[] = {"pointing", "sensitivity", "frequency"};
  for (int i = 0; i < kConstraints; ++i)
    std::printf("  %-12s %s\n", bounds[i], c.g(i) > -1e-8 ? "at its bound" : "below its bound");

  const double peak =
      derivatives(compile(satellite(Question::margin)).update(parameters(x)), kNames).peak().omega;
  const double error = largest_error(x, c, peak), residual = kkt(x, c, multipliers);
  std::printf("constraints and gradients against 50 digits by hand: to 1e-9 %s\n",
              error <= 1e-9 ? "yes" : "NO");
  std::printf("conditions of Karush, Kuhn and Tucker: to 1e-6 %s\n",
              residual <= 1e-6 ? "yes" : "NO");

  const System system = compile(satellite(Question::pointing));
  std::fprintf(stderr, "errors: gradients %.1e, conditions %.1e; one compile %.2f ms, ", error,
               residual, milliseconds([] { compile(satellite(Question::pointing)); }));
  std::fprintf(stderr, "one gradient of the H2 norm %.2f ms\n",
               milliseconds([&] { derivatives(system, kNames).h2(); }));
  return error <= 1e-9 && residual <= 1e-6 ? 0 : 1;
}
