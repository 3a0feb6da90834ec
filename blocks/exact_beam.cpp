#include <fmt/format.h>

#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <titop/blocks/body_interface.hpp>
#include <titop/blocks/continuum.hpp>
#include <titop/blocks/exact_beam.hpp>
#include <titop/blocks/specified.hpp>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/pole.hpp>
#include <titop/graph/with_warnings.hpp>

namespace titop {
namespace {

using detail::FromRest;
using detail::RealOf;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex50 = boost::multiprecision::cpp_complex_50;

constexpr Index kChild = 0, kParent = 6, kScalars = 12;

/// Factors of the damping law at s.
template <class Z>
struct Point {
  using R = RealOf<Z>;
  Z gain;   ///< s^2 / (1 + stiffness s)
  Z p;      ///< s (s + mass) / (1 + stiffness s)
  Z share;  ///< s / (s + mass), factor of the deformation
  Z rest;   ///< mass / (s + mass) = 1 - share

  Point(const Z& s, const fe::Rayleigh& damping) {
    const Z by_mass = s + Z(R(damping.mass)), by_stiffness = Z(R(1)) + Z(R(damping.stiffness)) * s;
    gain = s * s / by_stiffness;
    p = s * by_mass / by_stiffness;
    share = damping.mass == 0 ? Z(R(1)) : Z(s / by_mass);
    rest = damping.mass == 0 ? Z(R(0)) : Z(Z(R(damping.mass)) / by_mass);
  }
};

/// A function f of the total motion: mass damping acts on the deformation alone, hence f(0) + share
/// (f(q) - f(0)). Near rest by the slope of f, without a difference that cancels: share q = -gain
/// mu.
template <class Z>
Z relative(const FromRest<Z>& f, const Point<Z>& at, const RealOf<Z>& mu) {
  if (detail::is_near_rest(Z(at.p * mu))) return Z(f.at_zero) - at.gain * Z(mu) * f.slope;
  return at.rest * Z(f.at_zero) + at.share * f.value;
}

/// Y(s), [xdd_C; F_P] by [F_C; xdd_P], 12 x 12.
template <class Z>
class Assembly {
 public:
  using R = RealOf<Z>;
  using Matrix = Eigen::Matrix<Z, Eigen::Dynamic, Eigen::Dynamic>;

  Assembly(const ExactBeam& beam, const Z& s)
      : at_(s, beam.damping), length_(beam.length), Y(Matrix::Constant(kScalars, kScalars, Z(0))) {
    const Material& m = beam.material;
    const R area(beam.section.area), rho(m.rho), E(m.E), mass = rho * area * length_;
    const R polar =
        beam.section.I_x ? R(*beam.section.I_x) : R(R(beam.section.I_y) + R(beam.section.I_z));
    const R G = m.G ? R(*m.G) : R(E / (2 * (1 + R(*m.nu))));
    add_axial(0, E * area, mass);
    add_axial(3, G * R(beam.section.J), rho * polar * length_);
    add_bending(1, 5, 1, E * R(beam.section.I_z), mass);
    add_bending(2, 4, -1, E * R(beam.section.I_y), mass);
  }

 private:
  Point<Z> at_;
  R length_;

 public:
  Matrix Y;

 private:
  void set(Index row, Index column, const Z& value) { Y(row, column) = Y(column, row) = value; }

  /// Rod or shaft.
  void add_axial(Index i, const R& stiffness, const R& inertia) {
    const R mu = inertia * length_ / stiffness;
    const detail::Axial<Z> f = detail::axial(Z(-(at_.p * mu)));
    set(kChild + i, kChild + i, at_.gain * Z(R(length_ / stiffness)) * f.end.value);
    set(kChild + i, kParent + i, relative(f.across, at_, mu));
    set(kParent + i, kParent + i, -Z(inertia) * relative(f.end, at_, mu));
  }

  /// Deflection d and rotation r of one plane. `sign`: of the slope by the rotation.
  void add_bending(Index d, Index r, int sign, const R& EI, const R& mass) {
    const R &L = length_, flexibility = L / EI, turn(sign);
    const R mu = mass * L * L * flexibility;
    const detail::Bending<Z> f = detail::bending(Z(-(at_.p * mu)));
    const auto moved = [&](const FromRest<Z>& g) { return relative(g, at_, mu); };
    const Z soft = at_.gain * Z(flexibility);
    set(kChild + d, kChild + d, soft * Z(R(L * L)) * f.deflection.value);
    set(kChild + d, kChild + r, soft * Z(R(turn * L)) * f.mixed.value);
    set(kChild + r, kChild + r, soft * f.rotation.value);
    set(kChild + d, kParent + d, moved(f.across));
    set(kChild + r, kParent + r, moved(f.across));
    set(kChild + d, kParent + r, Z(R(turn * L)) * moved(f.lever));
    set(kChild + r, kParent + d, -at_.gain * Z(R(turn * mu / L)) * f.bow.value);
    set(kParent + d, kParent + d, -Z(mass) * moved(f.rotation));
    set(kParent + d, kParent + r, -Z(R(turn * mass * L)) * moved(f.mixed));
    set(kParent + r, kParent + r, -Z(R(mass * L * L)) * moved(f.deflection));
  }
};

template <class Z>
auto matrix_at(const ExactBeam& beam, const Z& s) {
  return std::move(Assembly<Z>(beam, s).Y);
}

/// The numbers as sums of this many doubles.
std::vector<MatrixXcd> as_doubles(Eigen::Matrix<Complex50, Eigen::Dynamic, Eigen::Dynamic> Y,
                                  int doubles) {
  std::vector<MatrixXcd> result;
  for (int k = 0; k < doubles; ++k) {
    MatrixXcd& part = result.emplace_back(Y.rows(), Y.cols());
    for (Index i = 0; i < Y.size(); ++i) {
      part(i) = {static_cast<double>(Y(i).real()), static_cast<double>(Y(i).imag())};
      Y(i) -= Complex50(part(i).real(), part(i).imag());
    }
  }
  return result;
}

/// omega = 1 / sqrt(mu) of the softer plane, a third of its first frequency: no entry of Y is small
/// there.
double slow_frequency(const ExactBeam& b) {
  const double I = std::min(b.section.I_y, b.section.I_z);
  return std::sqrt(b.material.E * I / (b.material.rho * b.section.area)) / (b.length * b.length);
}

class ExactBeamBlock : public Block,
                       public Specified<ExactBeam>,
                       public ClosedForm,
                       public WithWarnings {
 public:
  explicit ExactBeamBlock(const ExactBeam& spec) : spec_(spec), face_(body_interface({"C"}, 0)) {
    auto d = std::make_shared<Dynamics>();
    d->A.resize(0, 0), d->B.resize(0, kScalars), d->C.resize(kScalars, 0);
    d->D = at(slow_frequency(spec)).real();
    dynamics_ = std::move(d);
  }
  const ExactBeam& spec() const override { return spec_; }
  std::string_view type() const override { return "ExactBeam"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return dynamics_; }
  Response response(std::complex<double> s, ParameterValues) const override {
    return {MatrixXcd(0, kScalars), at(s)};
  }
  std::vector<MatrixXcd> closed_form(std::complex<double> s, ParameterValues,
                                     int doubles) const override {
    std::vector<MatrixXcd> result =
        doubles == 1 ? std::vector{matrix_at(spec_, s)}
                     : as_doubles(matrix_at(spec_, Complex50(s.real(), s.imag())), doubles);
    return checked(std::move(result), s);
  }
  Pattern feedthrough() const override { return dynamics_->D.array() != 0; }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> all = implausible(
        Beam{.length = spec_.length, .section = spec_.section, .material = spec_.material});
    all.push_back("has no finite state space: only transfers and frequency responses are computed");
    return all;
  }
  Kinematics undeformed() const override {
    return body_kinematics({{spec_.length, 0, 0}}, {MatrixXd(6, 0)});
  }
  Cause no_state_space() const override {
    return {"has infinitely many modes (ExactBeam), and no finite state space",
            "transfer and frequency_response take it; otherwise put FlexibleBody{with_elements("
            "beam, n)} in its place (compare(finite, exact, scene) tells the error), or let "
            "reduce_beams(diagram, scene) choose"};
  }

 private:
  MatrixXcd at(std::complex<double> s) const { return closed_form(s, {}, 1).front(); }
  std::vector<MatrixXcd> checked(std::vector<MatrixXcd> Y, std::complex<double> s) const {
    check_finite(s, type());
    if (!std::isfinite(std::norm(s)) || !std::isfinite(std::norm(s / slow_frequency(spec_))))
      throw Error(Code::not_finite,
                  fmt::format("a {} at |s| = {}: numbers overflow", type(), std::abs(s)),
                  "take an s of smaller modulus");
    for (const MatrixXcd& part : Y)
      if (!part.allFinite()) throw pole_at(s, fmt::format("a {} clamped at P", type()));
    return Y;
  }

  ExactBeam spec_;
  Interface face_;
  std::shared_ptr<const Dynamics> dynamics_;
};

void require_damping(double value, const char* name, const char* unit) {
  if (value >= 0 && std::isfinite(value)) return;
  throw Error(Code::bad_value, fmt::format("damping.{} of the beam is {} {}", name, value, unit),
              "give numbers >= 0: mass [1/s] and stiffness [s]");
}

}  // namespace

Beam with_elements(const ExactBeam& beam, int elements, fe::ModeOptions modes) {
  modes.rayleigh = beam.damping;
  return {.length = beam.length,
          .section = beam.section,
          .material = beam.material,
          .elements = elements,
          .modes = std::move(modes)};
}

BlockPtr as_block(const ExactBeam& beam) {
  check(with_elements(beam, 1));
  require_damping(beam.damping.mass, "mass", "1/s");
  require_damping(beam.damping.stiffness, "stiffness", "s");
  return std::make_shared<const ExactBeamBlock>(beam);
}

}  // namespace titop
