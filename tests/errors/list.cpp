// docs/errors.md has every code, and its quotations are the library's messages.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <titop/titop.hpp>

#include "support/refused.hpp"

using namespace titop;

namespace {

RigidBody brick() { return {.children = {{"C", {1, 0, 0}}}}; }

/// A spring-mass on the ground, in a diagram of its own, with one thing done to it.
Diagram spring(const std::function<void(Diagram&, SpringMass::Handle&)>& mistake) {
  Diagram d{"scene"};
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 5});
  mistake(d, z);
  return d;
}

/// Two bodies, the second to be hung on the first.
Diagram bodies(const std::function<void(Diagram&, BodyHandle&, BodyHandle&)>& mistake) {
  Diagram d{"scene"};
  auto B = d.add("B", brick()), A = d.add("A", brick());
  mistake(d, B, A);
  return d;
}

ModalData heavy_modes() {
  ModalData data;
  data.omega = Eigen::VectorXd::Constant(1, 3.0);
  data.xi = Eigen::VectorXd::Zero(1);
  data.L_P = Eigen::MatrixXd::Constant(1, 6, 2.0);
  data.D_P = Matrix6::Identity();
  return data;
}

void undriven() {
  compile(bodies([](Diagram& d, BodyHandle& B, BodyHandle& A) {
    B.parent.accel = 0;
    d.output("y", 6) = A.child.accel;
  }));
}

void driven_twice() {
  compile(spring([](Diagram&, SpringMass::Handle& z) {
    z.parent.accel = 0;
    z.parent.force = 0;
  }));
}

void sizes() {
  compile(bodies([](Diagram& d, BodyHandle& B, BodyHandle& A) {
    ground(A), release(B);
    B.child.force = d.input("u", 3);
  }));
}

void quantities() {
  compile(spring([](Diagram& d, SpringMass::Handle& z) {
    ground(z);
    z.child.force = z.child.accel;
    d.output("x") = z.stretch;
  }));
}

void frames() {
  compile(bodies([](Diagram&, BodyHandle& B, BodyHandle& A) {
    B.parent.accel = 0;
    A.parent.accel = B.child.accel;
  }));
}

void unknown() {
  compile(bodies([](Diagram&, BodyHandle& B, BodyHandle& A) {
    B.parent.accel = 0;
    mount(A, B.child("tip"));
  }));
}

void same_names() {
  compile(spring([](Diagram& d, SpringMass::Handle& z) {
    ground(z);
    ground(d.add("z", SpringMass{}));
  }));
}

void held_twice() {
  compile(bodies([](Diagram& d, BodyHandle& B, BodyHandle& A) {
    release(B);
    A.parent.accel = d.input("u", 6);
    A.child.accel = d.input("v", 6);
    d.output("y", 6) = A.child.force;
  }));
}

void round_and_round() {
  Diagram d{"loop"};
  auto u = d.input("u");
  auto there = d.add("there", Gain{.gain = 4}), back = d.add("back", Gain{.gain = 0.25});
  there.in = back.out + u;
  back.in = there.out;
  d.output("y") = there.out;
  compile(d);
}

void massless_point() {
  compile(spring([](Diagram& d, SpringMass::Handle& z) {
    z.parent.force = -d.input("u");
    d.output("a") = z.parent.accel;
  }));
}

void open_chain() {
  compile(bodies([](Diagram& d, BodyHandle& B, BodyHandle& A) {
    B.parent.force = -d.input("u", 6);
    mount(A, B.child, Rotation::about({0, 0, 1}, std::numbers::pi + 1e-3));
    A.child.accel = Rotation::about({0, 0, 1}, std::numbers::pi) * B.parent.accel;
    d.output("y", 6) = B.parent.accel;
  }));
}

void at_a_pole() {
  compile(spring([](Diagram& d, SpringMass::Handle& z) {
    release(z);
    z.child.force = d.input("u");
    auto rate = d.add("rate", Integrator{});
    rate.in = d.input("v");
    d.output("y") = rate.out;
  })).static_gain();
}

void half_of_a_parameter() {
  Diagram d{"d"};
  auto B = d.add("B", brick()), A = d.add("A", brick());
  const Param tilt = d.param("tilt", 0.2);
  B.parent.force = -d.input("u", 6);
  mount(A, B.child, Rotation::about({1, 0, 0}, 0.5 * tilt));
  d.output("y", 6) = B.parent.accel;
  lft(compile(d), {{"tilt", between(-1, 1)}});
}

struct Case {
  Code code;
  void (*provoke)();
};
const Case kCases[] = {
    {Code::no_equation, undriven},
    {Code::two_equations, driven_twice},
    {Code::size, sizes},
    {Code::quantity, quantities},
    {Code::frame, frames},
    {Code::unknown_name, unknown},
    {Code::duplicate_name, same_names},
    {Code::not_finite, [] { Diagram("d").add("z", SpringMass{.mass = HUGE_VAL}); }},
    {Code::not_a_rotation, [] { Rotation::matrix(2 * Matrix3d::Identity()); }},
    {Code::structure, held_twice},
    {Code::ill_posed, round_and_round},
    {Code::improper, massless_point},
    {Code::kinematic_loop, open_chain},
    {Code::bad_inertia, [] { Diagram("d").add("A", RigidBody{.mass = -4}); }},
    {Code::bad_modes, [] { FlexibleBody{heavy_modes()}; }},
    {Code::bad_file,
     [] { parse_diagram(R"({"name": "s", "format": "titop scene 9"})", "scene.json"); }},
    {Code::bad_value, [] { Diagram("d").add("z", SpringMass{.stiffness = -3}); }},
    {Code::singular, at_a_pole},
    {Code::not_rational, half_of_a_parameter}};

/// The section of this code, "" if there is none.
std::string section(const std::string& page, std::string_view code) {
  const auto from = page.find(fmt::format("\n## `{}`\n", code));
  if (from == std::string::npos) return {};
  return page.substr(from, page.find("\n## ", from + 1) - from);
}

}  // namespace

TEST_CASE("docs/errors.md lists every code with the library's message and the way out") {
  std::ifstream file(TITOP_SOURCE_DIR "/docs/errors.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  std::size_t codes = 0;
  while (to_string(static_cast<Code>(codes)) != "unknown") ++codes;
  REQUIRE(codes == std::size(kCases));
  for (const Case& c : kCases) {
    const std::string said = titop_test::message_of(c.provoke),
                      text = section(page, to_string(c.code));
    INFO(said);
    CHECK(said.starts_with(fmt::format("error[{}]: ", to_string(c.code))));
    CHECK(text.find("\n" + said.substr(0, said.find('\n')) + "\n") != std::string::npos);
    CHECK(text.find("Correction: ") != std::string::npos);
  }
}
