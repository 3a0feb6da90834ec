#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/definition/transfer.hpp>
#include <titop/titop.hpp>

#include "support/close.hpp"

/// A block of a user's whose geometry is a parameter: new values that bring in other motions.

using namespace titop;
using Eigen::MatrixXd;
using titop_test::matrix_error;

namespace {

/// A rigid body of 5 kg and unit inertia with one child point at (reach, 0, 0) from P, which is its
/// centre of mass.
struct Slider {
  Value reach;

  struct Handle {
    Handle(Graph* graph, int node)
        : parent(detail::channel<6>(graph, node, 1)), child(detail::channel<6>(graph, node, 0)) {}
    DualPort<6> parent, child;
  };
};

class SliderBlock : public Block {
 public:
  explicit SliderBlock(const Slider& s) : reach_(s.reach) {
    face_.channels = {{.name = "child", .size = 6, .takes = Takes::force},
                      {.name = "parent", .size = 6, .takes = Takes::accel}};
  }
  std::string_view type() const override { return "Slider"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const MatrixXd t = tau(values);
    auto d = std::make_shared<Dynamics>();
    d->A = MatrixXd(0, 0), d->B = MatrixXd(0, 12), d->C = MatrixXd(12, 0);
    d->D = MatrixXd::Zero(12, 12);
    d->D.topRightCorner(6, 6) = t;
    d->D.bottomLeftCorner(6, 6) = t.transpose();
    d->D.diagonal().tail(6) << -5, -5, -5, -1, -1, -1;
    return d;
  }
  std::optional<Kinematics> kinematics(ParameterValues values) const override {
    return Kinematics{.reference = 1,
                      .tau = {tau(values), MatrixXd::Identity(6, 6)},
                      .Phi = {MatrixXd(6, 0), MatrixXd(6, 0)}};
  }
  std::vector<Value> values() const override { return {reach_}; }

 private:
  /// a_C = a_P + alpha x r
  MatrixXd tau(ParameterValues values) const {
    MatrixXd t = MatrixXd::Identity(6, 6);
    t(1, 5) = reach_.at(values);
    t(2, 4) = -reach_.at(values);
    return t;
  }
  Value reach_;
  Interface face_;
};

BlockPtr as_block(const Slider& spec) { return std::make_shared<SliderBlock>(spec); }

template <class Body>
void wire(Diagram& d, const Body& arm, const DualPort<6>& child) {
  arm.parent.force = -d.input("W", 6);
  child.force = d.input("F", 6);
  d.output("x", 3) = child.position.linear();
}

/// A parallel spring whose two ends are dependent in a closed chain: its states are listed again,
/// too.
void with_chain(Diagram& d) {
  auto u = d.input("u");
  auto a = d.add("z_a", SpringMass{.mass = 1, .stiffness = 4});
  auto b = d.add("z_b", SpringMass{.mass = 2, .stiffness = 9});
  ground(a), ground(b);
  b.child.accel = a.child.accel;
  a.child.force = u - b.child.force;
  d.output("stretch") = a.stretch;
}

/// True if the log says that all is compiled again for this value: the value is the only number of
/// the line, as no fronts are counted.
bool compiled_again(const System& system, const std::string& value) {
  return std::ranges::any_of(system.notes(), [&](const Note& n) {
    std::string rest = n.text;
    const auto at = rest.find(value);
    if (n.pass != "update" || n.kind != Note::Kind::info || at == std::string::npos) return false;
    return rest.erase(at, value.size()).find_first_of("0123456789") == std::string::npos;
  });
}

}  // namespace

TEST_CASE("update: terms of a body's own geometry in a position are not left out") {
  const std::complex<double> s{0.4, 1.7};
  for (const bool chain : {false, true})
    for (const double reach : {1.0, -0.3}) {
      CAPTURE(chain);
      CAPTURE(reach);
      Diagram home{"slider"}, out{"body"};
      auto arm = home.add("arm", Slider{home.param("reach", 0.0)});
      wire(home, arm, arm.child);
      auto body = out.add(
          "arm",
          RigidBody{.mass = 5, .inertia = {1, 1, 1}, .children = {{"child", {reach, 0, 0}}}});
      wire(out, body, body.child("child"));
      if (chain) with_chain(home), with_chain(out);
      const System before = compile(home), after = before.update({{"reach", reach}});
      const auto right = compile(out).transfer(s);
      CHECK(matrix_error(after.transfer(s), right) <= 1e-13);
      CHECK(matrix_error(after.state_space().transfer(s), right) <= 1e-13);
      CHECK(matrix_error(before.transfer(s), right) >= 1e-3);
      CHECK(after.order() == compile(out).order());
      CHECK(compiled_again(after, fmt::format("reach = {:.6g}", reach)));
    }
}
