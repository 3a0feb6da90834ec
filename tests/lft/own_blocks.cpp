#include <doctest/doctest.h>

#include <cmath>
#include <titop/graph/opened.hpp>
#include <titop/titop.hpp>
#include <tuple>

#include "support/mistakes.hpp"

/// Derivatives by parameters of blocks that do not open them: differences of the block's matrices.

using namespace titop;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::says;
using Complex = std::complex<double>;

namespace {

/// xdot = -p^2 x + e^p in, out = x / p + sin(p) in.
struct Curved {
  Value p = 1;
  using Handle = Lti::Handle;
};

class CurvedBlock : public Block {
 public:
  explicit CurvedBlock(Value p) : p_(p) {
    face_.inputs = {{"in", 1}};
    face_.outputs = {{"out", 1}};
    face_.states = {"x"};
  }
  std::string_view type() const override { return "Curved"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const double p = p_.at(values);
    const auto one = [](double x) { return MatrixXd::Constant(1, 1, x); };
    return std::make_shared<Dynamics>(
        Dynamics{one(-p * p), one(std::exp(p)), one(1 / p), one(std::sin(p))});
  }
  std::vector<Value> values() const override { return {p_}; }
  bool has_frame() const override { return false; }

 private:
  Interface face_;
  Value p_;
};

BlockPtr as_block(const Curved& spec) { return std::make_shared<CurvedBlock>(spec.p); }

/// A weightless lever, from its parent to a point at (reach, 0, 0), which may open its reach: the
/// accelerations and wrenches, and, if `moves`, also the place of its point.
struct Reach {
  Value reach;
  bool opens = false, moves = false;
  struct Handle {
    Handle(Graph* graph, int node)
        : parent(detail::channel<6>(graph, node, 1)), child(detail::channel<6>(graph, node, 0)) {}
    DualPort<6> parent, child;
  };
};

class ReachBlock : public Block {
 public:
  explicit ReachBlock(const Reach& spec) : spec_(spec) {
    face_.channels = {{.name = "child", .size = 6, .takes = Takes::force},
                      {.name = "parent", .size = 6, .takes = Takes::accel}};
  }
  std::string_view type() const override { return "Reach"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    auto d = std::make_shared<Dynamics>();
    d->A.resize(0, 0), d->B.resize(0, 12), d->C.resize(12, 0), d->D = MatrixXd::Zero(12, 12);
    d->D.topRightCorner(6, 6) = at(values);
    d->D.bottomLeftCorner(6, 6) = at(values).transpose();
    return d;
  }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    return Kinematics{.reference = 1,
                      .tau = {at(values), MatrixXd::Identity(6, 6)},
                      .Phi = {MatrixXd(6, 0), MatrixXd(6, 0)}};
  }
  std::vector<Value> values() const override { return {spec_.reach}; }
  std::optional<Opened> opened(ParameterValues values,
                               std::span<const int> parameters) const override {
    if (!spec_.opens) return std::nullopt;
    std::vector<OpenedPair> pairs;
    for (const auto& [linear, angular, sign] : {std::tuple(1, 5, 1.0), {2, 4, -1.0}}) {
      pairs.push_back({spec_.reach,
                       {},
                       Eigen::VectorXd::Unit(12, linear),
                       {},
                       sign * Eigen::RowVectorXd::Unit(12, 6 + angular)});
      if (spec_.moves) {
        pairs.back().moves = 0;
        pairs.back().moved_by = Vector6::Unit(linear);
        pairs.back().of_motion = sign * Vector6::Unit(angular).transpose();
      }
      pairs.push_back({spec_.reach,
                       {},
                       sign * Eigen::VectorXd::Unit(12, 6 + angular),
                       {},
                       Eigen::RowVectorXd::Unit(12, linear)});
    }
    return with_pairs(*dynamics(values), pairs, parameters);
  }

 private:
  MatrixXd at(ParameterValues values) const {
    MatrixXd t = MatrixXd::Identity(6, 6);
    t(1, 5) = spec_.reach.at(values), t(2, 4) = -spec_.reach.at(values);
    return t;
  }
  Interface face_;
  Reach spec_;
};

BlockPtr as_block(const Reach& spec) { return std::make_shared<ReachBlock>(spec); }

}  // namespace

TEST_CASE(
    "an own block in a loop: derivative in closed form, with a note that it is by differences") {
  Diagram d{"own"};
  const Param p = d.param("p", 0.7), k = d.param("k", 0.4);
  auto c = d.add("c", Curved{2 * p});
  c.in = d.input("u") - k * c.out;
  d.output("y") = c.out;
  const Derivatives g = derivatives(compile(d), {"k", "p"});
  CHECK(g.by_differences() == std::vector<std::string>{"p of c"});
  const std::vector<Note> notes = g.opened().notes();
  CHECK(std::count_if(notes.begin(), notes.end(), [](const Note& n) {
          return n.pass == "open" && titop_test::has_names(n.text, {"c", "p", "Curved"});
        }) == 1);
  const Certificate certificate = g.opened().certificate();
  CHECK(certificate.residual <= 1e-12);
  CHECK(certificate.by_differences == g.by_differences());
  CHECK(to_string(certificate).find("derivative by p of c") != std::string::npos);
  const System later = g.opened().update({{"p", 0.71}});
  CHECK(later.certificate().by_differences == g.by_differences());
  CHECK(later.log().find("Curved's matrices") != std::string::npos);
  CHECK(derivatives(compile(d), {"k"}).opened().certificate().by_differences.empty());
  // y = G / (1 + k G), G = e^q / (q (s + q^2)) + sin(q), q = 2 p
  const Complex s{0.3, 1.1};
  const double q = 1.4, e = std::exp(q);
  const Complex r = s + q * q, G = e / (q * r) + std::sin(q),
                dG = e / (q * r) - e / (q * q * r) - e * 2.0 / (r * r) + std::cos(q),
                all = 1.0 + 0.4 * G, want = 2.0 * dG / (all * all);
  CHECK(std::abs(g.transfer(s, "p")(0, 0) - want) <= 1e-11 * std::abs(want));
  CHECK(std::abs(g.transfer(s, "k")(0, 0) + G * G / (all * all)) <= 1e-14 * std::abs(G * G));
  CHECK(std::abs(g.transfers(s)[1](0, 0) - want) <= 1e-11 * std::abs(want));
  CHECK(says(error_of([&] { g.transfer(s, "p", "k"); }), Code::not_rational, {"p", "k", "c"}));
  const Complex twice = 2.0 * G * G * G / (all * all * all);
  CHECK(std::abs(g.transfer(s, "k", "k")(0, 0) - twice) <= 1e-13 * std::abs(twice));
  CHECK(error_of([&] { lft(compile(d), {{"p", percent(10)}}); }).has(Code::not_rational));
}

namespace {

/// xdot = -x + in, out = f(p) x, of which some values may be refused.
struct Shaped {
  Value p;
  double (*f)(double);
  using Handle = Lti::Handle;
};

class ShapedBlock : public Block {
 public:
  explicit ShapedBlock(const Shaped& spec) : spec_(spec) {
    face_.inputs = {{"in", 1}};
    face_.outputs = {{"out", 1}};
    face_.states = {"x"};
  }
  std::string_view type() const override { return "Shaped"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const auto one = [](double x) { return MatrixXd::Constant(1, 1, x); };
    return std::make_shared<Dynamics>(
        Dynamics{one(-1), one(1), one(spec_.f(spec_.p.at(values))), one(0)});
  }
  std::vector<Value> values() const override { return {spec_.p}; }
  bool has_frame() const override { return false; }

 private:
  Interface face_;
  Shaped spec_;
};

BlockPtr as_block(const Shaped& spec) { return std::make_shared<ShapedBlock>(spec); }

/// One of them, with its parameter at this value.
System shaped(double p, double (*f)(double)) {
  Diagram d{"shaped"};
  auto c = d.add("c", Shaped{d.param("p", p), f});
  c.in = d.input("u");
  d.output("y") = c.out;
  return compile(d);
}

}  // namespace

TEST_CASE("a derivative by differences that is 0") {
  const Complex s{0.3, 1.1};
  for (const auto& [p, f] :
       {std::pair<double, double (*)(double)>{0, [](double x) { return 1 - x * x; }},
        {0.7, [](double) { return 2.0; }}}) {
    const Derivatives g = derivatives(shaped(p, f), {"p"});
    CHECK(g.by_differences() == std::vector<std::string>{"p of c"});
    CHECK(g.transfer(s, "p").isZero(0));
    CHECK(g.poles()[0].slopes[0].isZero(0));
    CHECK(g.peak().slopes(0) == 0);
  }
}

TEST_CASE("differences that do not converge, and values that the block refuses") {
  const auto error = [](double p, double (*f)(double)) {
    return error_of([&] { derivatives(shaped(p, f), {"p"}); });
  };
  const auto kink = [](double x) { return std::abs(x - 1.001); };
  CHECK(says(error(1, kink), Code::not_rational, {"c", "Shaped", "p", "0.00391"}));
  const auto wave = [](double x) { return std::sin(200 * x); };  // 0.8 rad per step
  CHECK(says(error(1, wave), Code::not_rational, {"c", "Shaped", "p", "0.00391"}));
  const auto short_of = [](double x) {
    if (x > 1.001) throw Error(Code::bad_value, "the reach is at most 1.001", "take a shorter one");
    return x;
  };
  CHECK(says(error(1, short_of), Code::not_rational,
             {"c", "Shaped", "p", "the reach is at most 1.001", "take a shorter one"}));
  // Of a large number with a small part that changes only the rounding of the number is lost.
  const auto small_part = [](double x) { return 1e4 + std::exp(x); };
  const Eigen::MatrixXcd dH = derivatives(shaped(1, small_part), {"p"}).transfer(1, "p");
  CHECK(std::abs(dH(0, 0) - std::exp(1) / 2) <= 1e-11 * 1e4);
}

namespace {

/// A lever between two bodies, beyond which a rate and a position are read.
System with_lever(bool opens, bool moves) {
  Diagram d{"reach"};
  auto hub = d.add("hub", RigidBody{.mass = 3, .children = {{"C", {1, 0, 0}}}});
  auto lever = d.add("lever", Reach{d.param("p", 0.5), opens, moves});
  auto tip = d.add("tip", RigidBody{.mass = 2, .PA = {0.1, 0.2, 0.3}});
  hub.parent.force = -d.input("U", 6);
  mount(lever, hub.child, Rotation());
  mount(tip, lever.child, Rotation());
  d.output("y", 6) = hub.parent.accel;
  d.output("rate", 6) = tip.parent.rate;
  d.output("place", 6) = tip.parent.position;
  return compile(d);
}

}  // namespace

TEST_CASE("an own block that moves points by a parameter is refused unless it opens the motion") {
  for (const bool opens : {false, true}) {
    CAPTURE(opens);
    const System system = with_lever(opens, false);
    CHECK(says(error_of([&] { derivatives(system, {"p"}); }), Code::not_rational,
               {"lever", "Reach", "p"}));
    CHECK(says(error_of([&] {
                 lft(system, {{"p", percent(50)}});
               }),
               Code::not_rational, {"lever", "Reach", "p"}));
  }
  const System system = with_lever(true, true);
  const Lft f = lft(system, {{"p", percent(90)}});
  for (const double p : {0.1, 0.9}) {
    const Eigen::MatrixXcd G = system.update({{"p", p}}).transfer({0.3, 1}, Precision::digits50);
    CHECK((f.at({{"p", p}}).transfer({0.3, 1}) - G).norm() <= 1e-12 * G.norm());
  }
}

TEST_CASE("opened blocks and blocks by differences in one scene, with a parameter in both") {
  // m xdd + c xd + k x = u - G(s) x: the controller's parameter p is also the spring's stiffness.
  Diagram d{"mix"};
  const Param p = d.param("p", 0.7), m = d.param("m", 2), q = d.param("q", 0.3);
  auto z = d.add("z", SpringMass{.mass = m, .stiffness = 5 * p, .damping = 0.2});
  auto c = d.add("c", Curved{p});
  auto e = d.add("e", Curved{q});
  ground(z);
  c.in = z.stretch;
  e.in = c.out;
  z.child.force = d.input("u") - e.out;
  d.output("x") = z.stretch;
  const Derivatives g = derivatives(compile(d), {"p", "m", "q"});
  CHECK(g.by_differences() == std::vector<std::string>{"p of c", "q of e"});
  const Complex s{0.3, 1.1};
  const auto G = [&](double v) { return std::exp(v) / (v * (s + v * v)) + std::sin(v); };
  const auto dG = [&](double v) {
    const Complex r = s + v * v;
    return std::exp(v) * (1.0 / (v * r) - 1.0 / (v * v * r) - 2.0 / (r * r)) + std::cos(v);
  };
  const Complex H = 1.0 / (2.0 * s * s + 0.2 * s + 3.5 + G(0.7) * G(0.3));
  const auto off = [&](const char* name, Complex by) {
    const Complex want = -H * H * by;
    return std::abs(g.transfer(s, name)(0, 0) - want) / std::abs(want);
  };
  CHECK(off("p", 5.0 + dG(0.7) * G(0.3)) <= 1e-11);
  CHECK(off("q", G(0.7) * dG(0.3)) <= 1e-11);
  CHECK(off("m", s * s) <= 1e-13);
  CHECK(error_of([&] { g.transfer(s, "m", "p"); }).has(Code::not_rational));
  CHECK(std::abs(g.transfer(s, "m", "m")(0, 0) - 2.0 * H * H * H * s * s * s * s) <=
        1e-12 * std::abs(H * H * H * s * s * s * s));
}
