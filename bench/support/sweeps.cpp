#include "sweeps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "methods/elimination.hpp"
#include "support/cases.hpp"

namespace titop_bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop::Diagram;
using titop::FlexibleBody;
using titop::ModalData;
using titop::RigidBody;
using titop::Rotation;
using titop::SpringMass;
using Complex = std::complex<double>;
using Number = Digits150;

const std::vector<Complex> kPoints{{0.05, 1}, {0.5, 10}, {1.5, 30}};

std::vector<double> powers(double from, double to, double factor) {
  std::vector<double> list;
  for (double x = from; factor > 1 ? x <= to * 1.0001 : x >= to * 0.9999; x *= factor)
    list.push_back(x);
  return list;
}

MatrixXcd one_by_one(const Number& x) { return MatrixXcd::Constant(1, 1, rounded(x)); }

// --- chains of spring-masses
// ----------------------------------------------------------------------

struct Chain {
  std::vector<double> m, k;
  double c = 0;
};

constexpr double kLossyMass = 1, kLossyStiffness = 10, kLossyDamping = 20;
constexpr int kBeforeTip = 10;

Chain uniform(std::size_t n, double c) {
  Chain chain{std::vector<double>(n), std::vector<double>(n), c};
  for (std::size_t i = 0; i < n; ++i) {
    chain.m[i] = 1 + 0.3 * static_cast<double>(i % 3);
    chain.k[i] = 100 + 7 * static_cast<double>(i % 5);
  }
  return chain;
}

/// On the ground; a force on the first mass, the acceleration of the last.
Diagram diagram_of(const Chain& chain) {
  Diagram d{"chain"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(chain.m.size());
  for (std::size_t i = 0; i < chain.m.size(); ++i) {
    z.push_back(d.add(fmt::format("z{}", i + 1),
                      SpringMass{.mass = chain.m[i], .stiffness = chain.k[i], .damping = chain.c}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z[i], z[i - 1].child);
  }
  z.front().child.force += u;
  d.output("a") = z.back().child.accel;
  return d;
}

/// Dynamic stiffness from the free end to the wall: sums of terms of one sign, stable.
Number by_stiffness(const Chain& chain, Complex at) {
  const Number s = number<Number>(at.real(), at.imag());
  Number rest = number<Number>(0), passed = number<Number>(1);  // of all bodies beyond; x_n / x_i
  for (std::size_t i = chain.m.size(); i-- > 0;) {
    const Number g = number<Number>(chain.k[i]) + number<Number>(chain.c) * s;
    const Number own = number<Number>(chain.m[i]) * s * s + rest;
    if (i == 0) return passed * s * s / (own + g);
    passed *= g / (g + own);  // x_i / x_(i-1)
    rest = own * g / (own + g);
  }
  return rest;
}

Extreme chain_extreme(const Chain& chain, std::vector<Complex> points) {
  Extreme e{diagram_of(chain), std::move(points)};
  for (const Complex s : e.s) e.exact.push_back(one_by_one(by_stiffness(chain, s)));
  return e;
}

Extreme masses(double ratio) {
  Chain chain = uniform(10, 0.1);
  for (std::size_t i = 1; i < 10; i += 2) chain.m[i] *= ratio;
  return chain_extreme(chain, kPoints);
}

Extreme stiffnesses(double ratio) {
  Chain chain = uniform(10, 0.1);
  for (std::size_t i = 1; i < 10; i += 2) chain.k[i] *= ratio;
  return chain_extreme(chain, kPoints);
}

/// At its lowest frequencies, where the whole chain moves.
Extreme length(double n) {
  return chain_extreme(uniform(static_cast<std::size_t>(n), 0.1),
                       {{0.5 / n, 10 / n}, {2 / n, 40 / n}, {5 / n, 100 / n}});
}

/// Dampers far above critical: in a row of n on the wall a motion of the tip fades by a factor per
/// body, and a recursion from the wall grows by it. A force on the tip, the acceleration ten bodies
/// before.
Diagram lossy_diagram(int n) {
  Diagram d{"lossy row"};
  auto u = d.input("u");
  std::vector<SpringMass::Handle> z;
  z.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    z.push_back(d.add(
        fmt::format("z{}", i + 1),
        SpringMass{.mass = kLossyMass, .stiffness = kLossyStiffness, .damping = kLossyDamping}));
    if (i == 0)
      ground(z[0]);
    else
      mount(z.back(), z[z.size() - 2].child);
  }
  z.back().child.force += u;
  d.output("before") = z[z.size() - std::min<std::size_t>(z.size(), kBeforeTip)].child.accel;
  return d;
}

/// Dynamic stiffness from the wall to the tip, then the motion back from there: both are stable.
MatrixXcd lossy_by_stiffness(int n, Complex at) {
  const Number s = number<Number>(at.real(), at.imag());
  const Number g = number<Number>(kLossyStiffness) + number<Number>(kLossyDamping) * s;
  const Number own = number<Number>(kLossyMass) * s * s;
  std::vector<Number> behind;  // stiffness of all up to body i, as body i + 1 feels it
  Number felt = g;
  for (int i = 0; i < n; ++i) {
    behind.push_back(own + felt);
    felt = g * behind.back() / (g + behind.back());
  }
  Number x = number<Number>(1) / behind.back();
  for (int i = 1; i < std::min(n, kBeforeTip); ++i)
    x *= g / (g + behind[static_cast<std::size_t>(n - 1 - i)]);
  return MatrixXcd::Constant(1, 1, rounded(Number(s * s * x)));
}

Extreme lossy(double n) {
  Extreme e{lossy_diagram(static_cast<int>(n)), {{0, 8}, {0, 15.93}, {1, 8}}};
  for (const Complex s : e.s) e.exact.push_back(lossy_by_stiffness(static_cast<int>(n), s));
  return e;
}

/// At its highest frequency: A rounded has it elsewhere, and the answer turns on the distance.
Extreme damping(double c) {
  double omega = 0;
  for (const titop::Pole& pole : compile(diagram_of(uniform(10, 0))).poles())
    omega = std::max(omega, pole.omega);
  return chain_extreme(uniform(10, c), {{0, omega}});
}

/// [Alazard 2015] Fig. 7 with k5/m5 = (1 + delta) k4/m4: of order 8 if delta is 0.
Extreme close_modes(double delta) {
  Diagram d{"nearly coinciding"};
  auto u = d.input("u");
  const auto body = [&](const char* name, double mass, double stiffness) {
    return d.add(name, SpringMass{.mass = mass, .stiffness = stiffness, .damping = 0.1});
  };
  auto z1 = body("z1", 1, 10), z2 = body("z2", 2, 26), z3 = body("z3", 3, 33);
  auto z4 = d.add("z4", SpringMass{.mass = 4, .stiffness = 20});
  auto z5 = d.add("z5", SpringMass{.mass = 5, .stiffness = 25 * (1 + delta)});
  ground(z1);
  mount(z2, z1.child), mount(z3, z1.child), mount(z4, z2.child), mount(z5, z2.child);
  z2.child.force += u;
  d.output("a") = z3.child.accel;
  return {std::move(d), {{0.001, std::sqrt(5.0)}, {0.05, 1}, {0.5, 10}}, {}, 100};
}

// --- loops and light points
// -----------------------------------------------------------------------

titop::Lti gain(double g) { return {.D = MatrixXd::Constant(1, 1, g)}; }

/// x = (1 - delta) x + u, the gain spread over three blocks.
Extreme loop(double delta) {
  const double g[] = {3.0, 0.7, (1 - delta) / 2.1};
  Diagram d{"loop"};
  auto u = d.input("u");
  auto a = d.add("a", gain(g[0])), b = d.add("b", gain(g[1])), c = d.add("c", gain(g[2]));
  a.in = c.out + u;
  b.in = a.out;
  c.in = b.out;
  d.output("y") = c.out;
  const Number product = number<Number>(g[0]) * number<Number>(g[1]) * number<Number>(g[2]);
  return {std::move(d), {{0, 1}}, {one_by_one(product / (number<Number>(1) - product))}};
}

/// m xdd = spring (x0 - x), m0 x0dd = u - spring (x0 - x).
Extreme light_parent(double m0) {
  Diagram d{"light parent"};
  auto u = d.input("u");
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 50, .damping = 0.1, .parent_mass = m0});
  z.parent.force = -u;
  d.output("a") = z.child.accel;
  Extreme e{std::move(d), kPoints};
  for (const Complex at : e.s) {
    const Number s = number<Number>(at.real(), at.imag()), two = number<Number>(2);
    const Number spring = number<Number>(50) + number<Number>(0.1) * s;
    e.exact.push_back(one_by_one(
        spring / (two * number<Number>(m0) * s * s + (two + number<Number>(m0)) * spring)));
  }
  return e;
}

/// Two levers on hinges about z, tied to each other at two points: they rotate together if the
/// hinges are coaxial, and are immobile if they are delta apart. A spring-mass is mounted on one.
Extreme ties(double delta) {
  Diagram d{"levers"};
  const Eigen::Vector3d y{0, 1, 0}, z{0, 0, 1};
  const auto lever = [](double from) {
    return RigidBody{
        .mass = 2,
        .inertia = 0.5 * Eigen::Matrix3d::Identity(),
        .children = {{"far", {1 - from, 0, 0}}, {"near", {0.5 - from, 0, 0}}, {"site", {2, 0, 0}}}};
  };
  auto base = d.add("base", RigidBody{.children = {{"J1"}, {"J2", {delta, 0, 0}}}});
  auto one = d.add("one", lever(0)), two = d.add("two", lever(delta));
  ground(base);
  for (const auto& h :
       {hinge(d, "h1", one, base.child("J1"), {}, z), hinge(d, "h2", two, base.child("J2"), {}, z)})
    h.torque = 40 * h.angle;
  weld(two.child("far").along(y), one.child("far").along(y));
  weld(two.child("near").along(y), one.child("near").along(y));
  auto m = d.add("m", SpringMass{.mass = 3, .stiffness = 75, .damping = 0.2});
  mount(m, one.child("site").along(y));
  m.child.force += d.input("u");
  d.output("a") = m.child.accel;
  Extreme e{std::move(d), kPoints};
  for (const Complex s : e.s)
    e.exact.push_back(MatrixXcd::Constant(1, 1, s * s / (3.0 * s * s + 0.2 * s + 75.0)));
  return e;
}

// --- bodies with six degrees of freedom
// -----------------------------------------------------------

Extreme masses_6(double ratio) {
  return {case_diagram(Case::D, 6, {.ratio = std::sqrt(ratio)}), kPoints};
}

/// 2 m of aluminium with a lever of some length at both ends.
titop::Beam aluminium() {
  return {.length = 2.0,
          .section = titop::rectangle(0.06, 0.04),
          .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
          .elements = 4,
          .modes = {.kept = 6, .xi = {0.005}}};
}

/// Free: from the wrench on the first body to the acceleration of the last.
Diagram chain_of(const std::vector<FlexibleBody>& bodies) {
  Diagram d{"chain"};
  auto U = d.input("U", 6);
  std::vector<FlexibleBody::Handle> b;
  b.reserve(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    b.push_back(d.add(fmt::format("b{}", i + 1), bodies[i]));
    if (i > 0)
      mount(b[i], b[i - 1].child, Rotation::about({1, 2, 3}, 0.7 * static_cast<double>(i)));
  }
  b.front().parent.force = -U;
  d.output("a", 6) = b.back().child.accel;
  return d;
}

Extreme lever_arms(double arm) {
  const auto beam = FlexibleBody(aluminium());
  const auto lever = FlexibleBody(RigidBody{.mass = 5,
                                            .inertia = Eigen::Matrix3d::Identity(),
                                            .children = {{"C", {arm, 0.3 * arm, -0.2 * arm}}}});
  return {chain_of({beam, lever, beam, lever, beam}), kPoints};
}

/// The same chain in another unit of length; the model is in that unit as well.
Extreme units(double length) {
  const FlexibleBody beam(titop::scaled(titop::modal_data(aluminium()), {.length = length}));
  return {chain_of({beam, beam, beam, beam}), kPoints};
}

double to_digits(double x, int digits) {
  return std::strtod(fmt::format("{:.{}e}", x, digits - 1).c_str(), nullptr);
}

/// As a file with so many digits would have it.
ModalData written(ModalData d, int digits) {
  const auto round = [&](auto& m) {
    for (auto& x : m.reshaped()) x = to_digits(x, digits);
  };
  round(d.omega), round(d.L_P), round(d.D_P);
  for (auto& child : d.children) round(child.Phi_C);
  d.digits = digits;
  return d;
}

/// Against the same chain with all its digits. All modes are kept: the more modes, the smaller is
/// the residual mass at P.
Extreme digits(double count) {
  titop::Beam beam = aluminium();
  beam.elements = 10;
  beam.modes.kept = 60;
  const ModalData whole = titop::modal_data(beam);
  const auto chain = [](const ModalData& d) { return chain_of({d, d, d}); };
  Extreme e{chain(written(whole, static_cast<int>(count))), {{0.5, 10}, {50, 1000}, {500, 1e4}}};
  const titop::System right = compile(chain(whole), {.minimize_up_to = 0});
  for (const Complex s : e.s) e.exact.push_back(right.transfer(s, titop::Precision::digits50));
  return e;
}

}  // namespace

std::vector<Sweep> sweeps() {
  const auto by_damping = [](double c) { return 2e-14 / c; };  // an ulp over 0.1 c of critical
  const auto by_digits = [](double count) { return std::pow(10, 5 - count); };  // condition 1e5
  return {
      {"mass-ratio", "ten spring-masses: every second mass times r", "mass ratio r",
       powers(1e-16, 1e16, 100), masses},
      {"mass-ratio-6dof", "six flexible bodies: every second mass and stiffness times r",
       "mass ratio r", powers(1e-16, 1e16, 1e4), masses_6},
      {"stiffness-ratio", "ten spring-masses: every second stiffness times r", "stiffness ratio r",
       powers(1e-16, 1e16, 100), stiffnesses},
      {"chain-length",
       "spring-masses in a row",
       "bodies",
       {3, 10, 30, 100, 300, 1000, 3000, 10000, 30000, 100000},
       length},
      {"lossy-row",
       "spring-masses with dampers of 20 N s/m in a row on a wall: a force on the tip",
       "bodies",
       {3, 10, 30, 100, 300, 1000, 3000, 10000, 30000, 100000},
       lossy},
      {"loop", "an algebraic loop at distance delta from singular", "delta", powers(1, 1e-17, 0.1),
       loop},
      {"light-parent", "a force on a point of mass m0", "m0 [kg]", powers(1, 1e-300, 1e-20),
       light_parent},
      {"damping", "ten spring-masses at their highest resonance", "damping c [N s/m]",
       powers(1, 1e-16, 0.1), damping, by_damping},
      {"close-modes", "five masses with two frequencies apart by delta: minimal model", "delta",
       powers(1, 1e-16, 0.1), close_modes},
      {"closures", "two levers on hinges delta apart and tied twice: do they turn?", "delta [m]",
       powers(0.1, 1e-15, 0.1), ties},
      {"digits",
       "three beams from data of few digits",
       "digits",
       {16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6},
       digits,
       by_digits},
      {"lever-arms", "beams on levers of length L", "L [m]", powers(1e-8, 1e8, 10), lever_arms},
      {"units", "four beams: lengths in another unit", "unit of length [m]", powers(1e-9, 1e9, 10),
       units},
  };
}

}  // namespace titop_bench
