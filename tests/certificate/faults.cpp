#include <doctest/doctest.h>

#include <titop/compiler/certificate/residual.hpp>
#include <titop/compiler/solve/instant.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/titop.hpp>

#include "support/names.hpp"
#include "support/rng.hpp"

/// Faults that the default certificate must find: signals that break an equation, a block whose A,
/// B, C, D contradict its response at s.

using namespace titop;

namespace {

/// 1 / (s + 1) by its matrices; at s with this sign.
class Lag : public Block {
 public:
  explicit Lag(double sign) : sign_(sign) {
    face_.inputs = {{"in", 1}};
    face_.outputs = {{"out", 1, Quantity::plain}};
    face_.states = {"x"};
    matrices_->A = -Eigen::MatrixXd::Identity(1, 1);
    matrices_->B = matrices_->C = Eigen::MatrixXd::Identity(1, 1);
    matrices_->D = Eigen::MatrixXd::Zero(1, 1);
  }
  std::string_view type() const override { return "Lag"; }
  const Interface& interface() const override { return face_; }
  std::shared_ptr<const Dynamics> dynamics(ParameterValues) const override { return matrices_; }
  Response response(std::complex<double> s, ParameterValues) const override {
    const Eigen::MatrixXcd one = Eigen::MatrixXcd::Identity(1, 1);
    return {one / (s + 1.0), sign_ * one / (s + 1.0)};
  }

 private:
  double sign_;
  Interface face_;
  std::shared_ptr<Dynamics> matrices_ = std::make_shared<Dynamics>();
};

struct LagSpec {
  double sign = 1;
  using Handle = Lti::Handle;
};
BlockPtr as_block(const LagSpec& spec) { return std::make_shared<Lag>(spec.sign); }

System lag(double sign) {
  Diagram d{"lag"};
  auto block = d.add("L", LagSpec{sign});
  block.in = d.input("u");
  d.output("y") = block.out;
  return compile(d);
}

/// A hub, a boom on it, a spring-mass on the boom and a filter of its reading. `held_twice`: a
/// panel is welded to the hub at two points, and the filter's output is shown in two other units.
Diagram satellite(bool held_twice) {
  Diagram d{"satellite"};
  auto hub =
      d.add("hub", RigidBody{.mass = 50,
                             .inertia = Eigen::Vector3d(9, 8, 7).asDiagonal(),
                             .children = {{"C", {1, 0, 0.5}}, {"P", {0, 1, 0}}, {"Q", {0, 1, 1}}}});
  auto boom = d.add("boom", FlexibleBody{Beam{.length = 3,
                                              .section = rectangle(0.06, 0.04),
                                              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                              .elements = 3,
                                              .modes = {.kept = 4, .xi = {0.01}}}});
  auto z = d.add("z", SpringMass{.mass = 2, .stiffness = 300, .damping = 1, .parent_mass = 0.5});
  auto f = d.add("f", Lti{.A = Eigen::MatrixXd::Constant(1, 1, -4),
                          .B = Eigen::MatrixXd::Constant(1, 1, 2),
                          .C = Eigen::MatrixXd::Constant(1, 1, 3),
                          .D = Eigen::MatrixXd::Constant(1, 1, 0.5)});
  hub.parent.force = -d.input("U", 6);
  mount(boom, hub.child("C"), Rotation::about({1, 2, 3}, 0.7));
  mount(z, boom.child.along({0, 0.6, 0.8}));
  f.in = z.child.accel;
  z.child.force = f.out;
  d.output("a", 6) = boom.child.accel;
  if (!held_twice) return d;
  auto panel = d.add("panel", RigidBody{.mass = 2,
                                        .inertia = Eigen::Vector3d(0.3, 0.2, 0.1).asDiagonal(),
                                        .children = {{"far", {0, 0, 1}}}});
  mount(panel, hub.child("P"));
  weld(panel.child("far"), hub.child("Q"));
  for (const auto& [name, gain] : {std::pair("large", 1e12), {"small", 1e-9}}) {
    auto g = d.add(name, Lti{.D = Eigen::MatrixXd::Constant(1, 1, gain)});
    g.in = f.out;
    d.output(std::string("shown ") + name) = g.out;
  }
  return d;
}

}  // namespace

TEST_CASE("a block whose response at s is not that of its matrices is named") {
  CHECK(lag(1).certificate().residual <= 1e-15);
  const Certificate c = lag(-1).certificate();
  CHECK(c.residual >= 0.1);
  CHECK(titop_test::has_name(c.residual_where, "L"));
}

namespace {

/// Every signal that is not 0 up to rounding in turn is off by a millionth; how many were tried.
int put_off(const detail::SystemData& d, const detail::Signals& right,
            const solve::RowMatrix<double>& rounding) {
  int tried = 0;
  for (std::size_t i = 0; i < d.graph().signals.size(); ++i) {
    const Signal& s = d.graph().signals[i];
    if (!s.active || s.role == Signal::Role::state) continue;
    // The force of the panel's second weld is rounding of forces of some 1e4 N.
    const double size = right.values.middleRows(right.first[i], s.size).cwiseAbs().maxCoeff();
    if (s.channel >= 0 && size <= 1e-10) continue;
    detail::Signals off = right;
    off.values.middleRows(right.first[i], s.size) *= 1 + 1e-6;
    CAPTURE(name_of(d.graph(), static_cast<int>(i)));
    CHECK(detail::written_residual(d, off).worst >= 1e-8);
    off.rounding = rounding;
    CHECK(detail::written_residual(d, off).worst >= 1e-8);
    ++tried;
  }
  return tried;
}

}  // namespace

TEST_CASE("a signal that is off by a millionth breaks an equation, and rounding is no excuse") {
  for (const bool held_twice : {false, true}) {
    CAPTURE(held_twice);
    const Diagram d = satellite(held_twice);
    const auto data = detail::compile_graph(d.graph(), {});
    CHECK(data->skeleton->stage.released.empty() == !held_twice);
    titop_test::Rng rng(3);
    const auto& l = data->layout();
    const detail::Instant now(
        *data, rng.matrix(static_cast<Eigen::Index>(l.states.size() + l.inputs.size()), 1));
    detail::Signals right{detail::first_of_signals(data->graph())};
    right.values = now.values(right.first);
    right.unknowns = now.unknowns();
    CHECK(detail::written_residual(*data, right).worst <= 1e-12);
    const solve::RowMatrix<double> rounding = now.rounding().values(right.first);
    CHECK(rounding.cwiseAbs().maxCoeff() > 0);
    CHECK(put_off(*data, right, rounding) >= 12);
  }
}

TEST_CASE("the residual of an input is not hidden by stiff springs behind it") {
  // Each spring passes on k / (m s^2), some 3e5, of its displacement.
  Diagram d{"stack"};
  auto below = d.add("b0", RigidBody{.mass = 1, .children = {{"C", {0, 0, 0.1}}}});
  below.parent.force = 0;
  below.child("C").force += d.input("U", 6);  // in addition to the first spring
  for (int i = 1; i <= 3; ++i) {
    auto k = d.add("k" + std::to_string(i), Bushing{.stiffness = {1e5, 1e5, 1e5, 1e5, 1e5, 1e5}});
    auto body =
        d.add("b" + std::to_string(i), RigidBody{.mass = 1, .children = {{"C", {0, 0, 0.1}}}});
    mount(k, below.child("C"));
    mount(body, k.child);
    below = body;
  }
  d.output("a", 6) = below.parent.accel;
  const auto data =
      std::const_pointer_cast<detail::SystemData>(detail::compile_graph(d.graph(), {}));
  CHECK(data->checked().certificate.at_instant);
  CHECK(data->checked().certificate.residual <= 1e-13);
  // A wrench that acts by a thousandth more than is written. The spring parallel to it carries some
  // k / (m s^2) of it: s is about 0.6, so that the wrench has a share of some 4e-6 in the sum.
  int planted = 0;
  const Graph& g = data->graph();
  for (std::size_t e = 0; e < g.equations.size(); ++e)
    for (std::size_t k = 0; k < g.equations[e].terms.size(); ++k) {
      const int signal = g.equations[e].terms[k].signal;
      if (g.signals[static_cast<std::size_t>(signal)].role != Signal::Role::external) continue;
      auto& c = data->numbers.coefficients[static_cast<std::size_t>(
                                               data->skeleton->joint.equation_coefficient[e]) +
                                           k];
      c = std::make_shared<const solve::RowMatrix<double>>(1.001 * *c);
      ++planted;
    }
  CHECK(planted == 1);
  CHECK(detail::certify(*data).certificate.residual > detail::kWarn);
}
