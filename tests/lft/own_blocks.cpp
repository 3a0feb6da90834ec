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

TEST_CASE("an own block in a loop: derivative in closed form, and what it is said to be") {
  Diagram d{"own"};
  const Param p = d.param("p", 0.7), k = d.param("k", 0.4);
  auto c = d.add("c", Curved{2 * p});
  c.in = d.input("u") - k * c.out;
  d.output("y") = c.out;
  const Derivatives g = derivatives(compile(d), {"k", "p"});
  CHECK(g.by_differences() == std::vector<std::string>{"p of c"});
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

TEST_CASE("an own block whose points move says how, or is refused") {
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
