#include <fmt/format.h>

#include <cmath>
#include <titop/blocks/specified.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/graph/opened.hpp>
#include <titop/graph/pole.hpp>

namespace titop {
namespace {

using Eigen::MatrixXd;

const Interface& spring_face() {
  static const Interface shared{{{"child", 1, Takes::force}, {"parent", 1, Takes::accel}},
                                {},
                                {{"stretch", 1, Quantity::position}},
                                {"stretch", "stretch_rate"},
                                rates_follow(1)};
  return shared;
}

void check_values(double m, double k, double c, double m0) {
  if (!std::isfinite(m) || !std::isfinite(k) || !std::isfinite(c) || !std::isfinite(m0))
    throw Error(
        Code::not_finite,
        fmt::format("SpringMass{{mass {}, stiffness {}, damping {}, parent_mass {}}}", m, k, c, m0),
        "give finite numbers");
  if (!(m > 0) || m0 < 0)
    throw Error(Code::bad_inertia, fmt::format("SpringMass has mass {} and parent_mass {}", m, m0),
                "mass must be positive [kg], parent_mass 0 or more");
  if (k < 0 || c < 0)
    throw Error(Code::bad_value, fmt::format("SpringMass has stiffness {} and damping {}", k, c),
                "stiffness [N/m] and damping [N s/m] must be 0 or more");
}

class SpringMassBlock : public Block, public Specified<SpringMass> {
 public:
  explicit SpringMassBlock(const SpringMass& spec) : spec_(spec) {}
  const SpringMass& spec() const override { return spec_; }
  std::string_view type() const override { return "SpringMass"; }
  const Interface& interface() const override { return spring_face(); }

  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const double m = spec_.mass.at(values), k = spec_.stiffness.at(values);
    const double c = spec_.damping.at(values), m0 = spec_.parent_mass.at(values);
    check_values(m, k, c, m0);
    auto d = std::make_shared<Dynamics>();
    d->A = Eigen::Matrix2d{{0, 1}, {-k / m, -c / m}};
    d->B = Eigen::Matrix2d{{0, 0}, {1 / m, -1}};
    d->C = Eigen::Matrix<double, 3, 2>{{-k / m, -c / m}, {k, c}, {1, 0}};
    d->D = Eigen::Matrix<double, 3, 2>{{1 / m, 0}, {0, -m0}, {0, 0}};
    return d;
  }

  /// (6) with damping, written out: C (s - A)^-1 B + D cancels at low frequencies.
  Response response(std::complex<double> s, ParameterValues values) const override {
    const double m = spec_.mass.at(values), k = spec_.stiffness.at(values);
    const double c = spec_.damping.at(values), m0 = spec_.parent_mass.at(values);
    const std::complex<double> spring = k + c * s, inertia = m * s * s, den = inertia + spring;
    if (den == 0.0) throw pole_at(s, "a SpringMass");
    Response r{Eigen::MatrixXcd(2, 2), Eigen::MatrixXcd(3, 2)};
    r.X << 1.0 / den, -m / den, s / den, -m * s / den;
    r.Y << s * s / den, spring / den, spring / den, -m0 - m * spring / den, 1.0 / den, -m / den;
    return r;
  }

  Pattern feedthrough() const override {
    Pattern p = Pattern::Constant(3, 2, false);
    p(0, 0) = p(1, 1) = true;
    return p;
  }

  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    Kinematics k{.reference = 1, .tau = {}, .Phi = {}};
    k.tau.assign(2, MatrixXd::Identity(1, 1));
    k.Phi.assign(2, MatrixXd::Zero(1, 2));
    k.Phi[0](0, 0) = 1;  // the stretch
    k.stiffness = Eigen::Vector2d(spec_.stiffness.at(values), 0);
    return k;
  }

  /// m: z = xdd_C; k: z = stretch; c: z = its rate; m0: z = xdd_P.
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    using RowVector = Eigen::RowVectorXd;
    const double inverse = 1 / spec_.mass.at(values);
    const Eigen::VectorXd back = Eigen::Vector2d(0, -inverse);  // on the mass
    const Eigen::VectorXd mass = Eigen::Vector3d(-inverse, 0, 0),
                          spring = Eigen::Vector3d(-inverse, 1, 0),
                          foot = Eigen::Vector3d(0, -1, 0);
    return with_pairs(*dynamics(values),
                      {{spec_.mass, back, mass, {}, {}, RowVector::Unit(3, 0)},
                       {spec_.stiffness, back, spring, RowVector::Unit(2, 0), {}},
                       {spec_.damping, back, spring, RowVector::Unit(2, 1), {}},
                       {spec_.parent_mass, {}, foot, {}, RowVector::Unit(2, 1)}},
                      parameters);
  }

  std::vector<Value> values() const override {
    return {spec_.mass, spec_.stiffness, spec_.damping, spec_.parent_mass};
  }

  std::optional<Cause> why_singular(int channel, ParameterValues values) const override {
    if (channel != 1 || spec_.parent_mass.at(values) != 0) return std::nullopt;
    return Cause{"has parent mass 0",
                 "give SpringMass{.parent_mass = ...}, or impose parent.accel instead"};
  }

 private:
  SpringMass spec_;
};

}  // namespace

BlockPtr as_block(const SpringMass& spec) {
  check_values(spec.mass.nominal(), spec.stiffness.nominal(), spec.damping.nominal(),
               spec.parent_mass.nominal());
  return std::make_shared<SpringMassBlock>(spec);
}

}  // namespace titop
