// A user's block whose matrices do not fit its interface, or have numbers that are not finite, is
// reported with its node, its type and the matrix, before any pass works with it.
#include <doctest/doctest.h>

#include <cmath>
#include <titop/titop.hpp>

#include "support/mistakes.hpp"

using namespace titop;
using Eigen::MatrixXd;
using titop_test::compile_error;
using titop_test::error_of;
using titop_test::next_line;
using titop_test::says;

namespace {

/// A wheel of momentum h about z, otherwise without mass: states are the rates of its point.
struct Wheel {
  Value momentum = 1;
  void (*spoil)(Interface&, Dynamics&) = [](Interface&, Dynamics&) {};

  struct Handle {
    Handle(Graph* graph, int node) : parent(detail::channel<6>(graph, node, 0)) {}
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    DualPort<6> parent;
  };
};

class WheelBlock : public Block {
 public:
  explicit WheelBlock(const Wheel& spec) : spec_(spec) {
    face_.channels = {{.name = "parent", .size = 6, .takes = Takes::accel}};
    face_.states = {"wx", "wy", "wz"};
    Dynamics of_others;
    spec_.spoil(face_, of_others);
  }
  std::string_view type() const override { return "Wheel"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues values) const override {
    const double h = spec_.momentum.at(values);
    auto d = std::make_shared<Dynamics>();
    d->A = MatrixXd::Zero(3, 3);
    d->B = MatrixXd::Zero(3, 6);
    d->B.rightCols(3).setIdentity();
    d->C = MatrixXd::Zero(6, 3);
    d->C(3, 1) = -h;
    d->C(4, 0) = h;
    d->D = MatrixXd::Zero(6, 6);
    Interface of_others;
    spec_.spoil(of_others, *d);
    return d;
  }
  std::vector<Value> values() const override { return {spec_.momentum}; }

 private:
  Wheel spec_;
  Interface face_;
};

BlockPtr as_block(const Wheel& spec) { return std::make_shared<WheelBlock>(spec); }

Diagram on_hub(const Wheel& wheel) {
  Diagram d{"hub"};
  auto hub = d.add("hub", RigidBody{.children = {{"C"}}});
  auto w = d.add("wheel", wheel);
  mount(w, hub.child);
  hub.parent.force = -d.input("u", 6);
  d.output("rate", 3) = hub.parent.rate.angular();
  return d;
}

Error spoilt(void (*how)(Interface&, Dynamics&)) { return compile_error(on_hub({.spoil = how})); }

}  // namespace

TEST_CASE("own block: the wheel itself compiles, with one mode of precession") {
  CHECK(compile_error(on_hub({})).mistakes().empty());
}

TEST_CASE("own block: sizes that are not those of the interface") {
  CHECK(says(spoilt([](Interface&, Dynamics& d) { d.B.resize(3, 0); }), Code::size,
             {"wheel", "B", "Wheel", "3 x 0", "3 x 6", "errors/own_block.cpp"}));
  CHECK(says(spoilt([](Interface&, Dynamics& d) { d.D = MatrixXd::Zero(5, 6); }), Code::size,
             {"wheel", "D", "Wheel", "5 x 6", "6 x 6"}));
  // Two names for three states: either may be wrong, so all differences are reported.
  const Error e = spoilt([](Interface& f, Dynamics&) {
    if (!f.states.empty()) f.states.pop_back();
  });
  CHECK(e.mistakes().size() == 3);
  CHECK(says(e, Code::size, {"wheel", "A", "Wheel", "3 x 3", "2 x 2"}));
  CHECK(says(e, Code::size, {"wheel", "C", "Wheel", "6 x 3", "6 x 2"}));
}

TEST_CASE("own block: entries that are no numbers, states of one name") {
  CHECK(says(spoilt([](Interface&, Dynamics& d) {
               if (d.C.size()) d.C(3, 1) = std::nan("");
             }),
             Code::not_finite, {"wheel", "C(3, 1)", "Wheel", "nan"}));
  CHECK(says(spoilt([](Interface& f, Dynamics&) {
               if (!f.states.empty()) f.states[1] = "wx";
             }),
             Code::duplicate_name, {"wheel", "Wheel", "wx"}));
}

TEST_CASE("own block: rates that are no rates") {
  CHECK(says(spoilt([](Interface& f, Dynamics&) {
               if (!f.states.empty()) f.rates = {1, -1, -1};
             }),
             Code::bad_value, {"wheel", "wx", "Wheel", "more than its rate wy"}));
  CHECK(says(spoilt([](Interface& f, Dynamics& d) {
               if (!f.states.empty()) f.rates = {1, -1, -1};
               if (d.A.size()) d.A(0, 1) = 1, d.B(0, 2) = 1;
             }),
             Code::bad_value, {"wx", "Wheel", "wy"}));
  for (const std::vector<int>& none : {std::vector<int>{1}, {1, -1, 3}, {-2, -1, -1}}) {
    Interface face{.channels = {}, .inputs = {}, .outputs = {}, .states = {"a", "b", "c"}};
    face.rates = none;
    CHECK(says(Error(mistakes_of(face, "Wheel")), Code::bad_value, {"Wheel", "3 states"}));
  }
  Interface face{.channels = {}, .inputs = {}, .outputs = {}, .states = {"a", "b", "c"}};
  face.rates = {1, -1, -1};
  CHECK(mistakes_of(face, "Wheel").empty());
}

TEST_CASE("own block: of a modal form, the modes are looked at") {
  const auto modal = [](void (*change)(Modal&)) {
    Modal m{.W = MatrixXd::Ones(1, 6),
            .rigid = MatrixXd::Zero(6, 6),
            .stiffness = Eigen::VectorXd::Ones(1),
            .damping = Eigen::VectorXd::Zero(1)};
    change(m);
    Dynamics d{MatrixXd::Zero(2, 2), MatrixXd::Zero(2, 6), MatrixXd::Zero(6, 2),
               MatrixXd::Zero(6, 6)};
    d.modal = std::make_shared<const Modal>(m);
    const WheelBlock two({.spoil = [](Interface& f, Dynamics&) { f.states = {"eta", "rate"}; }});
    return Error(mistakes_of(two, d));
  };
  CHECK(modal([](Modal&) {}).mistakes().empty());
  CHECK(says(modal([](Modal& m) { m.stiffness(0) = HUGE_VAL; }), Code::not_finite,
             {"stiffness(0, 0)", "Wheel", "inf"}));
  CHECK(says(modal([](Modal& m) { m.W = MatrixXd::Ones(1, 5); }), Code::size,
             {"W", "Wheel", "1 x 5", "1 x 6"}));
}

TEST_CASE("own block: new values of its parameters") {
  Diagram d{"hub"};
  auto hub = d.add("hub", RigidBody{.children = {{"C"}}});
  auto w = d.add("wheel", Wheel{.momentum = d.param("h", 2), .spoil = [](Interface&, Dynamics& m) {
                                  if (m.C.size() && m.C(4, 0) > 3) m.C(4, 0) = HUGE_VAL;
                                }});
  mount(w, hub.child);
  hub.parent.force = -d.input("u", 6);
  d.output("rate", 3) = hub.parent.rate.angular();
  const System system = compile(d);
  CHECK(error_of([&] { system.update({{"h", 3.0}}); }).mistakes().empty());
  CHECK(says(error_of([&] {
               system.update({{"h", 4.0}});
             }),
             Code::not_finite, {"wheel", "C(4, 0)", "Wheel", "inf"}));
}
