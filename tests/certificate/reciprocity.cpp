#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/names.hpp"
#include "support/rng.hpp"

/// Reciprocity of a structure: the acceleration at force i due to force j equals that at force j
/// due to force i. Expected asymmetries are computed by hand from the masses and springs.

using namespace titop;
using Complex = std::complex<double>;
using titop_test::at_s;
using titop_test::has_line;
using titop_test::has_name;
using titop_test::has_names;
using titop_test::relative;
using titop_test::Rng;
using titop_test::two_digits;

namespace {

/// The full certificate's grid for poles between these frequencies [rad/s].
std::vector<Complex> grid(double lowest, double highest) {
  std::vector<Complex> list;
  for (int k = 0; k < 24; ++k)
    list.push_back(Complex(0.05, 1) * 0.1 * lowest * std::pow(100 * highest / lowest, k / 23.0));
  return list;
}

struct Worst {
  double value = 0;
  Complex s;
};

/// Largest |G21 - G12| / max(sqrt(|G11 G22|), |G12|, |G21|) over the grid.
Worst worst(const std::vector<Complex>& points,
            const std::function<Eigen::Matrix2cd(Complex)>& G_of) {
  Worst result;
  for (const Complex s : points) {
    const Eigen::Matrix2cd G = G_of(s);
    const double size =
        std::max({std::sqrt(std::abs(G(0, 0) * G(1, 1))), std::abs(G(0, 1)), std::abs(G(1, 0))});
    if (const double now = std::abs(G(1, 0) - G(0, 1)) / size; now > result.value)
      result = {now, s};
  }
  return result;
}

void check_is(const FullCertificate::Reciprocity& r, const Worst& expected) {
  CHECK(relative(r.asymmetry, expected.value) <= 1e-10);
  CHECK(relative(r.where, expected.s) <= 1e-10);
}

/// Masses 1 and 2 on springs 4 and 18 of their own (2 and 3 rad/s). The filtered position of the
/// first one drives the second, with gain g [N/m]. Inputs and their outputs in units of u1, u2.
Diagram one_way(double g, double u1, double u2) {
  Diagram d{"one way"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("b", SpringMass{.mass = 2, .stiffness = 18});
  auto filter = d.add("filter", Lti{.D = Eigen::MatrixXd{{g}}});
  ground(a);
  ground(b);
  filter.in = a.stretch;
  a.child.force = u1 * d.input("f1");
  b.child.force = u2 * d.input("f2");
  b.child.force += filter.out;
  d.output("a1") = u1 * a.child.accel;
  d.output("a2") = u2 * b.child.accel;
  return d;
}

Eigen::Matrix2cd one_way_by_hand(double g, Complex s) {
  const Complex Z1 = s * s + 4.0, Z2 = 2.0 * s * s + 18.0;
  return s * s * Eigen::Matrix2cd{{1.0 / Z1, 0}, {g / (Z1 * Z2), 1.0 / Z2}};
}

/// A mass on another, which is mounted on the ground. Forces on both.
Diagram stack() {
  Diagram d{"stack"};
  auto lower = d.add("lower", SpringMass{.mass = 3, .stiffness = 50, .damping = 0.4});
  auto upper = d.add("upper", SpringMass{.mass = 2, .stiffness = 70, .damping = 0.3});
  ground(lower);
  mount(upper, lower.child);
  lower.child.force += d.input("f1");
  upper.child.force += d.input("f2");
  d.output("a1") = lower.child.accel;
  d.output("a2") = upper.child.accel;
  return d;
}

/// s^2 Z^-1 of the stack, with this share of the upper spring's force on the lower mass.
Eigen::Matrix2cd stack_by_hand(double share, Complex s) {
  const Complex k1 = 50.0 + 0.4 * s, k2 = 70.0 + 0.3 * s;
  const Eigen::Matrix2cd Z{{3.0 * s * s + k1 + share * k2, -share * k2}, {-k2, 2.0 * s * s + k2}};
  return s * s * Z.inverse();
}

/// Two masses of 1 kg with gyroscopic coupling: m vd = f + g [0 1; -1 0] v. No energy is supplied
/// or dissipated, but the coupling is antisymmetric.
class Gyroscope : public Block {
 public:
  explicit Gyroscope(double g) {
    face_.channels = {{"x", 1, Takes::force}, {"y", 1, Takes::force}};
    face_.states = {"vx", "vy"};
    matrices_->A = matrices_->C = g * Eigen::MatrixXd{{0, 1}, {-1, 0}};
    matrices_->B = matrices_->D = Eigen::MatrixXd::Identity(2, 2);
  }
  std::string_view type() const override { return "Gyroscope"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }

 private:
  Interface face_;
  std::shared_ptr<Dynamics> matrices_ = std::make_shared<Dynamics>();
};

struct GyroscopeSpec {
  double g = 1;
  struct Handle {
    Handle(Graph* graph, int node)
        : x(detail::channel<1>(graph, node, 0)), y(detail::channel<1>(graph, node, 1)) {}
    DualPort<1> x, y;
  };
};
BlockPtr as_block(const GyroscopeSpec& spec) { return std::make_shared<Gyroscope>(spec.g); }

}  // namespace

TEST_CASE("a structure is reciprocal; the numbers are those of its springs and masses") {
  const System system = compile(stack());
  const FullCertificate c = certify(system);
  CHECK(c.holds());
  CHECK(c.reciprocity.done);
  CHECK(c.reciprocity.structure);
  CHECK(c.reciprocity.why_no_structure.empty());
  CHECK(c.reciprocity.forces == 2);
  CHECK(c.reciprocity.asymmetry <= 1e-14);
  CHECK(has_line(to_string(c), {"2 forces"}));
}

TEST_CASE("a filter that reads here and pushes there: measured as by hand, and no fault") {
  for (const double g : {0.3, -7.0, 400.0}) {
    CAPTURE(g);
    const FullCertificate c = certify(compile(one_way(g, 1, 1)));
    CAPTURE(to_string(c));
    const auto& r = c.reciprocity;
    CHECK(c.holds());
    CHECK(r.done);
    CHECK(!r.structure);
    CHECK(has_names(r.why_no_structure, {"b.child.force", "filter.out"}));
    CHECK(((r.first == "f1" && r.second == "f2") || (r.first == "f2" && r.second == "f1")));
    const auto G = [&](Complex s) { return one_way_by_hand(g, s); };
    check_is(r, worst(grid(2, 3), G));
    CHECK(has_line(to_string(c), {"2 forces", "f1", "f2", two_digits(r.asymmetry), at_s(r.where),
                                  r.why_no_structure}));
  }
}

TEST_CASE("the asymmetry is the same number in all units of the forces") {
  const double right = certify(compile(one_way(0.3, 1, 1))).reciprocity.asymmetry;
  for (const double u1 : {1e-9, 1.0, 1e7})
    for (const double u2 : {1e-6, 1e9}) {
      const auto r = certify(compile(one_way(0.3, u1, u2))).reciprocity;
      CHECK(relative(r.asymmetry, right) <= 1e-10);
      const auto none = certify(compile(one_way(0, u1, u2))).reciprocity;
      CHECK(none.asymmetry <= 1e-14);
    }
}

TEST_CASE(
    "planted: a wrench that comes back by a thousandth too much is a fault, by hand as large") {
  const double share = 1.001;
  const auto data =
      std::const_pointer_cast<detail::SystemData>(detail::compile_graph(stack().graph(), {}));
  const Graph& g = data->graph();
  int planted = 0;
  for (std::size_t e = 0; e < g.equations.size(); ++e)
    for (std::size_t k = 0; k < g.equations[e].terms.size(); ++k) {
      if (name_of(g, g.equations[e].terms[k].signal) != "upper.parent.force") continue;
      auto& c = data->numbers.coefficients[static_cast<std::size_t>(
                                               data->skeleton->joint.equation_coefficient[e]) +
                                           k];
      c = std::make_shared<const solve::RowMatrix<double>>(share * *c);
      ++planted;
    }
  CHECK(planted == 1);
  // The dense model is that of the factors made before: its poles are those of the true stack.
  Eigen::Matrix2d K{{120, -70}, {-70, 70}};
  const Eigen::Vector2d root(1 / std::sqrt(3.0), 1 / std::sqrt(2.0));
  K = root.asDiagonal() * K * root.asDiagonal();
  const double mean = K.trace() / 2, rest = std::sqrt(mean * mean - K.determinant());
  const FullCertificate c = certify(System(data));
  CHECK(c.reciprocity.structure);
  const auto G = [&](Complex s) { return stack_by_hand(share, s); };
  const Worst expected = worst(grid(std::sqrt(mean - rest), std::sqrt(mean + rest)), G);
  // Damping moves |s| of the poles in the fourth digit, and with them the grid.
  CHECK(expected.value >= 1e-4);
  CHECK(relative(c.reciprocity.asymmetry, expected.value) <= 0.01);
  bool found = false;
  for (const std::string& fault : c.faults)
    found = found || has_names(fault, {"f1", "f2", two_digits(c.reciprocity.asymmetry)});
  CHECK(found);
}

TEST_CASE("motion without a reaction is no structure, and energy may be supplied") {
  Diagram d{"carried for nothing"};
  auto lower = d.add("lower", SpringMass{.mass = 3, .stiffness = 50, .damping = 0.4});
  auto upper = d.add("upper", SpringMass{.mass = 2, .stiffness = 70, .damping = 0.3});
  ground(lower);
  upper.parent.accel = lower.child.accel;
  lower.child.force = d.input("f1");
  upper.child.force = d.input("f2");
  d.output("a1") = lower.child.accel;
  d.output("a2") = upper.child.accel;
  const FullCertificate c = certify(compile(d));
  CAPTURE(to_string(c));
  CHECK(c.holds());
  CHECK(c.passivity.least <= -0.1);
  CHECK(!c.passivity.structure);
  CHECK(!c.reciprocity.structure);
  CHECK(has_name(c.reciprocity.why_no_structure, "upper.parent"));
  CHECK(!has_name(c.reciprocity.why_no_structure, "upper.parent.accel"));  // which is no reason
  const double w1 = std::sqrt(50 / 3.0), w2 = std::sqrt(35.0);  // no share of it comes back
  check_is(c.reciprocity, worst(grid(w1, w2), [](Complex s) { return stack_by_hand(0, s); }));
}

TEST_CASE("a gyroscopic block of one's own: passive, not reciprocal, named, and no fault") {
  const double g = 3;
  Diagram d{"spinning"};
  auto top = d.add("top", GyroscopeSpec{g});
  top.x.force = d.input("fx");
  top.y.force = d.input("fy");
  d.output("ax") = top.x.accel;
  d.output("ay") = top.y.accel;
  const FullCertificate c = certify(compile(d));
  CHECK(c.holds());
  CHECK(c.passivity.structure);
  CHECK(c.passivity.least >= -1e-12);
  CHECK(!c.reciprocity.structure);
  CHECK(has_name(c.reciprocity.why_no_structure, "top"));
  const auto G = [&](Complex s) {  // s (s - g J)^-1
    return Eigen::Matrix2cd(s / (s * s + g * g) * Eigen::Matrix2cd{{s, g}, {-g, s}});
  };
  // Below g the force across is the larger one: 2 at all these s.
  CHECK(relative(c.reciprocity.asymmetry, worst(grid(g, g), G).value) <= 1e-10);
}

TEST_CASE("forces wherever they may act on a structure: every sign and part of a port") {
  Rng random(20261123);
  for (int i = 0; i < 5; ++i) {
    const auto turn = [&] {
      return Rotation::about({random.between(-1, 1), 1, random.between(-1, 1)},
                             random.between(0, 3));
    };
    const Vector3d r(random.between(-1, 1), 0.5, random.between(-1, 1));
    Diagram d{"all kinds"};
    auto hub = d.add(
        "hub", RigidBody{.mass = 50,
                         .inertia = Vector3d(9, 8, 7).asDiagonal(),
                         .PA = {0.1, 0.2, 0},
                         .children = {{"A", {1, 0, 0.5}}, {"B", {0, 1, 0}}, {"S", {0, 0, 1}}}});
    auto boom = d.add("boom", FlexibleBody{Beam{.length = 3,
                                                .section = rectangle(0.06, 0.04),
                                                .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                                .elements = 2,
                                                .modes = {.kept = 4, .xi = {0.01}}}});
    auto wheel = d.add("wheel", RigidBody{.mass = 4, .children = {{"rim", {0.2, 0, 0.1}}}});
    auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 300, .damping = 1, .parent_mass = 0.5});
    hub.parent.force = -d.input("U", 6);
    auto h = hinge(d, "h", boom, hub.child("A"), turn(), {0, 1, 1});
    h.torque = -d.input("motor");
    auto b = bushing(d, "b", wheel, hub.child("B"), turn(),
                     {.stiffness = {4e3, 5e3, 9e3, 300, 200, 100}, .damping = {1, 2, 3, 1, 1, 1}});
    mount(z, hub.child("S").along(r));
    auto F = d.input("F", 6), V = d.input("V", 3);
    auto across = d.input("across"), between = d.input("between"), moved = d.input("moved");
    boom.child.force += F;             // at a child point
    b.child.force += d.input("W", 6);  // on the bushing's child point, whose block takes motions
    wheel.parent.force += -d.input("P", 6);  // on a mounted parent point
    wheel.child("rim").force.linear += V;
    hub.child("S").force.linear.along({1, 2, 0}) += across;
    z.child.force += between;  // of an actuator between two points
    hub.child("S").force.linear.along(r) += -between;
    auto shaker = d.add("shaker", SpringMass{.mass = 1, .stiffness = 50});
    shaker.parent.accel = moved;  // imposed, and no force: held while the others act
    d.output("of shaker") = shaker.child.accel;
    d.output("of U", 6) = hub.parent.accel;
    d.output("of motor") = h.accel;
    d.output("of F", 6) = boom.child.accel;
    d.output("of W", 6) = b.child.accel;
    d.output("of P", 6) = wheel.parent.accel;
    d.output("of V", 3) = wheel.child("rim").accel.linear;
    d.output("of across") = hub.child("S").accel.linear.along({1, 2, 0});
    d.output("of between") = z.child.accel - hub.child("S").accel.linear.along(r);
    const FullCertificate c = certify(compile(d), {.points = 8});
    CAPTURE(to_string(c));
    CHECK(c.holds());
    CHECK(c.passivity.pairs == 8);
    CHECK(c.reciprocity.forces == 6 + 1 + 6 + 6 + 6 + 3 + 1 + 1);
    CHECK(c.reciprocity.structure);
    CHECK(c.reciprocity.asymmetry <= 1e-11);
  }
}

TEST_CASE("internal forces of a closed chain: their rounding is no asymmetry, in any units") {
  // A parallelogram of links of length 1 in an oblique plane, pushed in it and across it.
  const Matrix3d T = Eigen::AngleAxisd(0.8, Vector3d(3, -1, 2).normalized()).matrix();
  const Vector3d x = T.col(0), y = T.col(1), z = T.col(2);
  const Rotation up = Rotation::about(z, 1.1), down = Rotation::about(z, -1.1);
  for (const double unit : {1.0, 1e-9, 1e9}) {
    CAPTURE(unit);
    Diagram d{"parallelogram"};
    const RigidBody link{.mass = 2,
                         .inertia = Eigen::Matrix3d::Identity() / 6,
                         .PA = 0.5 * x,
                         .children = {{"C", x}}};
    auto base = d.add("base", RigidBody{.mass = 1, .children = {{"J1"}, {"J2", x}}});
    auto crank = d.add("crank", link), coupler = d.add("coupler", link),
         rocker = d.add("rocker", link);
    ground(base);
    hinge(d, "p1", crank, base.child("J1"), up, z).torque = 0;
    hinge(d, "p2", coupler, crank.child, down, z).torque = 0;
    hinge(d, "p3", rocker, base.child("J2"), up, z).torque = 0;
    auto p4 = d.add("p4", Hinge{z});
    p4.torque = 0;
    mount(p4, rocker.child, down);
    weld(coupler.child, p4.child);
    const auto push = [&](const char* name, const DualPort<6>& at, const Vector3d& r, double in) {
      at.force.linear.along(r) += in * d.input(name);
      d.output(std::string("of ") + name) = in * at.accel.linear.along(r);
    };
    push("in plane", crank.child, y, 1);
    push("across", coupler.child, z, unit);
    push("across too", crank.child, z, unit);
    push("oblique", rocker.child, x + 0.5 * y + z, 1);
    const FullCertificate c = certify(compile(d), {.points = 8});
    CAPTURE(to_string(c));
    CHECK(c.passivity.structure);
    CHECK(c.passivity.least >= -1e-9);
    CHECK(c.reciprocity.structure);
    CHECK(c.reciprocity.forces == 4);
    CHECK(c.reciprocity.asymmetry <= 1e-10);
  }
}

TEST_CASE("nothing to check: said, with the reason") {
  Diagram d{"one"};
  auto a = d.add("a", SpringMass{.mass = 1, .stiffness = 4});
  ground(a);
  a.child.force += d.input("u");
  d.output("a") = a.child.accel;
  FullCertificate c = certify(compile(d));
  CHECK(!c.reciprocity.done);
  CHECK(c.reciprocity.forces == 1);
  const std::string single = c.reciprocity.why_not;
  CHECK(has_line(to_string(c), {single}));
  Diagram e{"unlike"};
  auto b = e.add("b", SpringMass{.mass = 1, .stiffness = 4});
  ground(b);
  b.child.force += e.input("u");
  e.output("x") = b.stretch;
  c = certify(compile(e));
  CHECK(!c.reciprocity.done);
  CHECK(c.reciprocity.forces == 0);
  CHECK(c.reciprocity.why_not != single);
  CHECK(has_line(to_string(c), {c.reciprocity.why_not}));
  Diagram modes{"modes only"};
  ground(modes.add("z", SpringMass{}));
  const FullCertificate none = certify(compile(modes));
  CHECK(!none.reciprocity.why_not.empty());
  CHECK(none.reciprocity.why_not == none.grid.why_not);
}
