#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/graph/linalg/eigen.hpp>
#include <titop/titop.hpp>

#include "distance.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

/// Frequencies, damping ratios and inertias as parameters: new values against a fresh compile, and
/// against M and K written out by hand.

using namespace titop;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using titop_test::error_of;
using titop_test::matrix_error;
using titop_test::says;

namespace {

struct Numbers {
  double omega = 7, xi = 0.01, spin = 4;
};

/// Two modes, one child.
ModalData modes() {
  ModalData data;
  data.omega = Eigen::Vector2d(5, 11);
  data.xi = Eigen::Vector2d(0.02, 0.03);
  data.L_P = MatrixXd::Zero(2, 6);
  data.L_P.row(0) << 0, 1.2, 0, 0, 0, 0.9;
  data.L_P.row(1) << 0, 0.4, 0.3, 0.1, -0.2, 0;
  data.D_P = rigid_mass(6, 4 * Matrix3d::Identity(), Eigen::Vector3d(-0.5, 0, 0));
  MatrixXd Phi = MatrixXd::Zero(6, 2);
  Phi.col(0) << 0, 0.8, 0, 0, 0, 0.5;
  Phi.col(1) << 0.1, -0.5, 0.3, 0.2, 0.1, -0.4;
  data.children = {{"C", {1.1, 0, 0}, Phi}};
  return data;
}

/// The data with the second frequency and the first damping ratio replaced.
ModalData replaced(const Numbers& n) {
  ModalData data = modes();
  data.omega(1) = n.omega;
  data.xi(0) = n.xi;
  return data;
}

const Eigen::Vector3d kPC(0.4, 0, 0.3);

/// A free hub with the body on it; its products of inertia stay, one moment is a parameter.
Diagram scene(const Numbers& n, bool parameters = true) {
  Diagram d{"modes"};
  auto U = d.input("U", 6);
  const Value w = parameters ? Value(d.param("w", n.omega)) : n.omega,
              z = parameters ? Value(0.5, d.param("z", 2 * n.xi)) : n.xi,
              J = parameters ? Value(d.param("J", n.spin)) : n.spin;
  auto hub = d.add(
      "hub", RigidBody{.mass = 10, .inertia = {3, 3.5, J, 0.1, 0, -0.2}, .children = {{"C", kPC}}});
  const FlexibleBody plain(parameters ? modes() : replaced(n));
  auto wing =
      d.add("wing", parameters ? FlexibleBody{plain, {.omega = {{2, w}}, .xi = {{1, z}}}} : plain);
  hub.parent.force = -U;
  mount(wing, hub.child);
  d.output("hub", 6) = hub.parent.accel;
  d.output("tip", 6) = wing.child.accel;
  return d;
}

/// The same in M, D, K: coordinates are the hub's motion and the modes relative to it.
MatrixXcd by_hand(const Numbers& n, std::complex<double> s) {
  const ModalData data = replaced(n);
  Matrix3d J;
  J << 3, 0.1, 0, 0.1, 3.5, -0.2, 0, -0.2, n.spin;
  const Matrix6 at_wing = tau(-kPC);
  MatrixXcd M = MatrixXcd::Zero(8, 8);
  M.topLeftCorner(6, 6) = (rigid_mass(10, J, {0, 0, 0}) + at_wing.transpose() * data.D_P * at_wing)
                              .cast<std::complex<double>>();
  M.bottomLeftCorner(2, 6) = (data.L_P * at_wing).cast<std::complex<double>>();
  M.topRightCorner(6, 2) = M.bottomLeftCorner(2, 6).transpose();
  for (Eigen::Index i = 0; i < 2; ++i)
    M(6 + i, 6 + i) =
        1.0 + (2 * data.xi(i) * data.omega(i) * s + data.omega(i) * data.omega(i)) / (s * s);
  MatrixXcd B = MatrixXcd::Zero(8, 6);
  B.topRows(6).setIdentity();
  MatrixXcd C = MatrixXcd::Zero(12, 8);
  C.topLeftCorner(6, 6).setIdentity();
  C.bottomLeftCorner(6, 6) = (tau(-data.children[0].PC) * at_wing).cast<std::complex<double>>();
  C.bottomRightCorner(6, 2) = data.children[0].Phi_C.cast<std::complex<double>>();
  return C * M.partialPivLu().solve(B);
}

double distance(const System& a, const System& b) {
  return titop_test::distance(a.state_space(), b.state_space());
}

}  // namespace

TEST_CASE("update: a frequency, a damping ratio, an inertia") {
  const System before = compile(scene({}));
  CHECK(distance(before, compile(scene({}, false))) == 0);
  const std::vector<std::pair<ParameterList, Numbers>> cases{
      {{}, {}},
      {{{"w", 9.0}}, {.omega = 9}},
      {{{"z", 0.3}}, {.xi = 0.15}},
      {{{"z", 0.0}}, {.xi = 0}},
      {{{"J", 5.5}}, {.spin = 5.5}},
      {{{"w", 300.0}, {"z", 0.01}, {"J", 3.0}}, {.omega = 300, .xi = 0.005, .spin = 3}}};
  for (const auto& [list, numbers] : cases) {
    CAPTURE(list.empty() ? "" : list.front().first);
    const System updated = before.update(list), fresh = compile(scene(numbers, false));
    CHECK(distance(updated, fresh) <= 1e-13);
    CHECK(updated.states() == fresh.states());
    for (const std::complex<double> s : {std::complex(0.3, 2.0), {0.0, 8.0}, {2.0, 40.0}}) {
      CHECK(matrix_error(updated.transfer(s), by_hand(numbers, s)) <= 1e-13);
      CHECK(matrix_error(updated.transfer(s), fresh.transfer(s)) <= 1e-13);
    }
    if (!list.empty()) CHECK(distance(updated, before) >= 1e-4);
  }
}

TEST_CASE("update: there and back with modes is the same to the last bit") {
  const System before = compile(scene({}));
  const System back = before.update({{"w", 6.0}, {"J", 5.0}}).update({{"w", 7.0}, {"J", 4.0}});
  CHECK(distance(back, before) == 0);
}

TEST_CASE("update: one frequency makes only the fronts up to the root again") {
  // A balanced tree of hubs: a wing is mounted on the last.
  Diagram d{"tree"};
  auto U = d.input("U", 6);
  const int n = 127;
  std::vector<RigidBody::Handle> hubs;
  for (int i = 0; i < n; ++i) {
    hubs.push_back(d.add(fmt::format("b{}", i + 1),
                         RigidBody{.mass = 2, .children = {{"L", {1, 0, 0}}, {"R", {0, 1, 0}}}}));
    if (i > 0)
      mount(hubs.back(), hubs[static_cast<std::size_t>((i - 1) / 2)].child(i % 2 ? "L" : "R"));
  }
  hubs[0].parent.force = -U;
  const FlexibleBody wing(modes());
  auto first = d.add("first", wing);
  auto last = d.add("last", FlexibleBody{wing, {.omega = {{1, d.param("w", 5.0)}}}});
  mount(first, hubs[static_cast<std::size_t>(n - 2)].child("L"));
  mount(last, hubs[static_cast<std::size_t>(n - 1)].child("L"));
  d.output("a", 6) = last.child.accel;
  const System before = compile(d), after = before.update({{"w", 6.0}});
  CHECK(after.certificate().fronts >= n);
  CHECK(after.certificate().fronts_made >= 1);
  CHECK(after.certificate().fronts_made <= 4 * 7 + 8);
  CHECK(after.certificate().residual <= 1e-13);
}

TEST_CASE("bodies of one set of modes share it, with and without parameters") {
  Diagram d{"shared"};
  const Param w = d.param("w", 5.0), other = d.param("other", 6.0);
  const FlexibleBody plain(modes()), one(plain, {.omega = {{1, w}}}),
      both(one, {.omega = {{2, other}}, .xi = {{1, 0.1}}});
  CHECK(&one.data() == &plain.data());
  CHECK(&both.data() == &plain.data());
  CHECK(as_block(plain)->dynamics({}) == as_block(plain)->dynamics({}));
  const std::vector<double> values{7.0, 9.0}, more{7.5, 9.0};
  const auto block = as_block(one);
  const auto made = block->dynamics(values);
  CHECK(block->dynamics(values) == made);
  CHECK(block->dynamics(more) != made);
  CHECK(both.nominal().omega == Eigen::Vector2d(5, 6));
  CHECK(both.nominal().xi == Eigen::Vector2d(0.1, 0.03));
  CHECK(one.nominal().L_P == plain.data().L_P);
  CHECK(as_block(both)->dynamics(values)->modal->stiffness == Eigen::Vector2d(49, 81));
  CHECK(as_block(both)->values().size() == 3);
}

TEST_CASE("values that make no modes and no inertia") {
  const FlexibleBody plain(modes());
  const auto refused = [&](auto make) {
    return error_of([&] {
      Diagram d{"d"};
      d.add("X", make(d));
    });
  };
  const auto wing = [&](const ModeValues& values) {
    return refused([&](Diagram&) { return FlexibleBody{plain, values}; });
  };
  CHECK(wing({.omega = {{1, 3.0}}, .xi = {{2, 0.0}}}).mistakes().empty());
  CHECK(says(wing({.omega = {{2, -3.0}}}), Code::bad_modes,
             {"X", "mode 2", "omega -3", "system/update_modes.cpp"}));
  CHECK(says(wing({.xi = {{1, -0.1}}}), Code::bad_modes, {"X", "mode 1", "-0.1"}));
  CHECK(says(wing({.xi = {{3, 0.1}}}), Code::bad_modes, {"X", "mode 3", "2"}));
  CHECK(says(wing({.omega = {{0, 2.0}}}), Code::bad_modes, {"X", "mode 0", "2", "1"}));
  CHECK(says(wing({.omega = {{1, HUGE_VAL}}}), Code::not_finite, {"X", "mode 1", "omega inf"}));
  CHECK(says(refused([](Diagram& d) {
               return RigidBody{.inertia = {1, 1, d.param("J", 3.0)}};
             }),
             Code::bad_inertia, {"X", "1", "3"}));
  const System s = compile(scene({}));
  CHECK(says(error_of([&] {
               s.update({{"w", -2.0}});
             }),
             Code::bad_modes, {"wing", "mode 2", "omega -2"}));
  CHECK(says(error_of([&] {
               s.update({{"z", -0.2}});
             }),
             Code::bad_modes, {"wing", "mode 1", "-0.1"}));
  // Principal moments of the hub: eigenvalues by 40 digits.
  CHECK(says(error_of([&] {
               s.update({{"J", 8.0}});
             }),
             Code::bad_inertia, {"hub", "2.98045", "3.51067", "8.00888"}));
  CHECK(says(error_of([&] {
               s.update({{"J", -1.0}});
             }),
             Code::bad_inertia, {"hub", "inertia", "-1.00888"}));
}

namespace {

/// A SpringMass that shows its modal form at some values only.
struct NowAndThen {
  titop::SpringMass spec;
  titop::Value shows;  ///< above 0
  using Handle = titop::SpringMass::Handle;
};

class NowAndThenBlock : public titop::Block {
 public:
  explicit NowAndThenBlock(const NowAndThen& n) : inner_(as_block(n.spec)), shows_(n.shows) {}
  std::string_view type() const override { return "NowAndThen"; }
  const titop::Interface& interface() const override { return inner_->interface(); }
  std::shared_ptr<const titop::Dynamics> dynamics(titop::ParameterValues v) const override {
    auto d = std::make_shared<titop::Dynamics>(*inner_->dynamics(v));
    if (shows_.at(v) <= 0) d->modal = nullptr;
    return d;
  }
  std::vector<titop::Value> values() const override { return {shows_}; }

 private:
  titop::BlockPtr inner_;
  titop::Value shows_;
};

titop::BlockPtr as_block(const NowAndThen& n) { return std::make_shared<NowAndThenBlock>(n); }

}  // namespace

TEST_CASE("update: a block that loses its modal form is written by its states, and back again") {
  const auto scene = [](double shows) {
    titop::Diagram d{"now and then"};
    const auto u = d.input("u");
    const auto p = d.param("shows", shows);
    auto z = d.add("z", NowAndThen{{.mass = 2.0, .stiffness = 3.0, .damping = 0.5}, p});
    auto last = d.add("last", titop::SpringMass{.mass = 1.0, .stiffness = 5.0});
    ground(z);
    mount(last, z.child);
    last.child.force = u;
    d.output("a") = last.child.accel;
    return titop::compile(d, {.minimize_up_to = 0});
  };
  for (const double first : {1.0, -1.0}) {
    const titop::System system = scene(first);
    titop::StateSpace before, after, fresh;
    system.write(before);
    system.update({{"shows", -first}}).write(after);
    scene(-first).write(fresh);
    CHECK((after.A == fresh.A && after.B == fresh.B && after.C == fresh.C && after.D == fresh.D));
    CHECK((after.A - before.A).norm() <= 1e-15 * before.A.norm());
    system.write(after);
    CHECK(after.A == before.A);
  }
}
