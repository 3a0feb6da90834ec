#include <doctest/doctest.h>

#include "scenes.hpp"
#include "support/close.hpp"
#include "support/mistakes.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

/// A beam with a rigid body at its tip of so many times its mass; wrench and acceleration there.
Diagram loaded(const FlexibleBody& beam, double times) {
  Diagram d{"loaded"};
  auto U = d.input("U", 6);
  const double m = times * beam.data().D_P(0, 0);
  auto b = d.add("beam", beam);
  auto tip = d.add("tip", RigidBody{.mass = m,
                                    .inertia = Vector3d(0.02, 0.03, 0.04).asDiagonal() * m,
                                    .PA = {0.05, 0.02, 0.01}});
  b.parent.accel = 0;
  mount(tip, b.child("C"), Rotation{});
  b.child("C").force += U;
  d.output("a", 6) = tip.parent.accel;
  return d;
}

/// A free hub with two beams that turning by pi about z exchanges; forces on the hub.
Diagram twins(const FlexibleBody& beam, double off = 0) {
  Diagram d{"twins"};
  auto U = d.input("U", 6);
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Vector3d(1, 2, 3).asDiagonal(),
                                    .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3 + off, 0, 0}}}});
  auto left = d.add("left", beam), right = d.add("right", beam);
  hub.parent.force = -U;
  const Matrix3d turn = Vector3d(-1, -1, 1).asDiagonal();
  mount(left, hub.child("C1"), Rotation{});
  mount(right, hub.child("C2"), Rotation::matrix(turn));
  d.output("a", 6) = hub.parent.accel;
  d.output("tips", 3) = left.child("C").accel.linear;
  return d;
}

/// The same by hand: wrench and acceleration at the tip's P.
Truth loaded_by_hand(const FlexibleBody& beam, double times) {
  const double m = times * beam.data().D_P(0, 0);
  Tree tree(false);
  const int b = tree.add(beam.data());
  tree.add(RigidBody{.mass = m,
                     .inertia = Vector3d(0.02, 0.03, 0.04).asDiagonal() * m,
                     .PA = {0.05, 0.02, 0.01}},
           b);
  return truth_of(tree.structure(tree.motion(b, 0), tree.motion(b, 0)));
}

/// The twins' hub, moved along z by a force along z.
Truth twins_by_hand(const FlexibleBody& beam) {
  Tree tree(true);
  const int hub = tree.add(RigidBody{.mass = 20,
                                     .inertia = Vector3d(1, 2, 3).asDiagonal(),
                                     .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3, 0, 0}}}});
  tree.add(beam.data(), hub, 0);
  tree.add(beam.data(), hub, 1, Vector3d(-1, -1, 1).asDiagonal());
  const MatrixXl z = tree.motion(hub).row(2);
  return truth_of(tree.structure(z, z), true);
}

}  // namespace

TEST_CASE("a cantilever whose tip carries 50 times its mass") {
  const Diagram d = loaded(slim_beam(8), 50);
  for (const double accuracy : {1e-2, 1e-5}) {
    const titop::Scene scene{.band_hz = {0, 60}, .accuracy = accuracy};
    const ReducedSystem r = compile(d, scene);
    check_beside(r, scene, loaded_by_hand(slim_beam(8), 50));
    CHECK(r.full().order() == 96);
    CHECK(r.order() >= 12);  // the six modes of a heavy body on a spring
    CHECK(r.order() <= 40);
  }
}

TEST_CASE("a free-free structure: rigid motion is in the static part, positions keep theirs") {
  const FlexibleBody beam = slim_beam(6);
  for (const bool positions : {false, true}) {
    Diagram d{"free"};
    auto U = d.input("U", 6);
    auto b1 = d.add("b1", beam), b2 = d.add("b2", beam);
    b1.parent.force = -U;
    mount(b2, b1.child("C"), Rotation::about({0, 1, 1}, 0.8));
    if (positions)
      d.output("x", 6) = b1.parent.position;
    else
      d.output("a", 6) = b2.child("C").accel;
    const titop::Scene scene{.band_hz = {positions ? 1.0 : 0.0, 50}, .accuracy = 1e-4};
    const ReducedSystem r = compile(d, scene);
    Tree tree(true);
    const int first = tree.add(beam.data());
    const int second = tree.add(beam.data(), first, 0, Rotation::about({0, 1, 1}, 0.8).nominal());
    const MatrixXl driven = tree.motion(first),
                   read = positions ? tree.motion(first) : tree.motion(second, 0);
    check_beside(r, scene, truth_of(tree.structure(driven, read), true, positions ? 0 : 2));
    CHECK(r.order() <= r.full().order() / 2);
    int rigid = 0;
    for (const KeptMode& m : r.modes()) rigid += m.hertz == 0;
    CHECK(rigid == (positions ? 6 : 0));
  }
}

TEST_CASE("symmetric appendages, common motion only: half their modes go exactly") {
  const FlexibleBody beam = slim_beam(6);  // 36 modes
  titop::Scene scene{.inputs = {"U(3)"}, .outputs = {"a(3)"}, .band_hz = {0, 60}, .accuracy = 1e-6};
  const ReducedSystem r = compile(twins(beam), scene);
  REQUIRE(r.steps().size() == 3);
  CHECK(r.steps()[1].name == "symmetry");
  double all = 0;  // the steps' seconds are reported
  for (const auto& [step, seconds] : r.seconds()) all += seconds;
  CHECK(r.seconds().front().first == "compile");
  CHECK(all > 0);
  CHECK(r.steps()[1].before == 72);
  CHECK(r.steps()[1].after == 36);
  CHECK(r.steps()[1].error == 0);
  check_beside(r, scene, twins_by_hand(beam));
  // One tip is read: both have the same motion, independent of the choice.
  scene.outputs = {"a", "tips"};
  CHECK(compile(twins(beam), scene).steps()[1].after == 36);
  scene.accuracy = 1e-4;
  // Inputs differ, or the places differ by a millimetre: nothing is removed.
  scene.inputs = {"U"};
  CHECK(compile(twins(beam), scene).steps().size() == 2);
  scene.inputs = {"U(3)"};
  CHECK(compile(twins(beam, 1e-3), scene).steps().size() == 2);
}

TEST_CASE("an output silenced by symmetry keeps its direct terms") {
  // The hub is shaken by A; both tips have the same motion, so that their difference is 0: plus A,
  // it is A.
  const FlexibleBody beam = slim_beam(6);
  Diagram d{"shaken"};
  auto A = d.input("A", 6);
  auto hub = d.add("hub", RigidBody{.mass = 20,
                                    .inertia = Vector3d(1, 2, 3).asDiagonal(),
                                    .children = {{"C1", {0.3, 0, 0}}, {"C2", {-0.3, 0, 0}}}});
  auto left = d.add("left", beam), right = d.add("right", beam);
  const Matrix3d turn = Vector3d(-1, -1, 1).asDiagonal();
  hub.parent.accel = A;
  mount(left, hub.child("C1"), Rotation{});
  mount(right, hub.child("C2"), Rotation::matrix(turn));
  MatrixXd z = MatrixXd::Zero(1, 6);
  z(0, 2) = 1;
  d.output("y") = z * left.child("C").accel - z * right.child("C").accel + z * A;
  d.output("tip") = z * left.child("C").accel;
  const titop::Scene scene{.inputs = {"A(3)"}, .band_hz = {0, 60}, .accuracy = 1e-5};
  const ReducedSystem r = compile(d, scene);
  CHECK(r.steps()[1].name == "symmetry");
  CHECK(relative(r.bound().peak(0, 0), 1.0) <= 1e-9);
  for (const double w : {1.0, 40.0, 300.0}) {
    CHECK(relative(r.transfer({0.002 * w, w})(0, 0), Complex(1)) <= 1e-5);
    CHECK(relative(r.full().transfer({0.002 * w, w})(0, 0), Complex(1)) <= 1e-9);
  }
}

TEST_CASE("kept coordinates are named in ascending order of frequency") {
  const ReducedSystem r =
      compile(frame(slim_beam(5)), titop::Scene{.band_hz = {0, 60}, .accuracy = 1e-4});
  const VectorXd k = r.second_order().K.diagonal();
  REQUIRE(k.size() >= 5);
  CHECK(std::is_sorted(k.begin(), k.end()));
}

TEST_CASE("a high mode of one body that another's lock brings down into the band is kept") {
  // The beam stretches at 637 Hz, c / (4 l) with c = sqrt(E / rho), twelve times the band's end.
  // The block at its tip, 100 times as heavy, stretches it at 40 Hz, and twists and bends it below
  // that: the modes that a rule by frequency keeps of the beam (up to twice the band) are another
  // structure.
  const FlexibleBody beam = slim_beam(8);
  const double m = 100 * beam.data().D_P(0, 0);
  const RigidBody heavy{.mass = m, .inertia = Matrix3d::Identity() * m};
  Diagram d{"locked"};
  auto U = d.input("U", 6);
  auto rail = d.add("rail", beam);
  auto block = d.add("block", heavy);
  rail.parent.accel = 0;
  mount(block, rail.child("C"), Rotation{});
  rail.child("C").force += U;
  d.output("a", 6) = block.parent.accel;
  const auto by_hand = [&](const ModalData& data) {
    Tree tree(false);
    const int root = tree.add(data);
    tree.add(heavy, root);
    return truth_of(tree.structure(tree.motion(root, 0), tree.motion(root, 0)));
  };
  const titop::Scene scene{.band_hz = {0, 50}, .accuracy = 1e-4};
  const Truth truth = by_hand(beam.data()), ruled = by_hand(scenes::up_to(beam.data(), 100));
  const auto in_band = [&](const Truth& t, double hertz) {
    const double end = 2 * std::numbers::pi * hertz;
    return std::count_if(t.omegas.begin(), t.omegas.end(), [&](double w) { return w <= end; });
  };
  CHECK(in_band(truth, 50) == 6);  // the block on its spring
  CHECK(in_band(ruled, 50) < 6);
  const auto points = fine_points(scene, truth.omegas, 1000);
  CHECK(compared(scene, points, truth, ruled.transfer).relative() > 0.5);
  const ReducedSystem r = compile(d, scene);
  check_beside(r, scene, truth);
  const auto stretched = std::find_if(r.modes().begin(), r.modes().end(),
                                      [](const KeptMode& k) { return k.exact && k.hertz > 35; });
  REQUIRE(stretched != r.modes().end());
  // sqrt(EA / l / m) of a massless beam; a third of its mass more.
  const double hertz =
      std::sqrt(70e9 * 0.06 * 0.04 / 2 / (m * (1 + 1 / 300.0))) / (2 * std::numbers::pi);
  CHECK(relative(stretched->hertz, hertz) <= 1e-3);
}

TEST_CASE("unreachable parts, and parts that only listen, are removed exactly") {
  // A boom that the scene needs. Another one that the scene's inputs do not move; one that is
  // shaken by the boom's tip without reaction; a filter of the tip's motion.
  const FlexibleBody beam = slim_beam(6);  // 36 modes
  Diagram d{"three"};
  auto U = d.input("U", 6);
  auto V = d.input("V", 6);
  auto boom = d.add("boom", beam), other = d.add("other", beam), shaken = d.add("shaken", beam);
  auto filter = d.add("filter", Lti{.A = -30 * MatrixXd::Identity(4, 4),
                                    .B = MatrixXd::Ones(4, 6),
                                    .C = MatrixXd::Ones(1, 4)});
  boom.parent.accel = 0;
  other.parent.accel = 0;
  boom.child("C").force = U;
  other.child("C").force = V;
  shaken.parent.accel = Rotation::about({0, 0, 1}, 0.2) * boom.child("C").accel;
  filter.in = boom.child("C").accel;
  d.output("a", 6) = boom.child("C").accel;
  d.output("b", 6) = other.child("C").accel;
  d.output("c", 6) = shaken.child("C").accel;
  d.output("y") = filter.out;
  Tree tree(false);
  const int root = tree.add(beam.data());
  const MatrixXl tip = tree.motion(root, 0);
  MatrixXl still = MatrixXl::Zero(12, tip.cols());
  still.topRows(6) = tip;
  for (const bool read : {false, true}) {
    titop::Scene scene{.inputs = {"U"}, .outputs = {"a"}, .band_hz = {0, 60}, .accuracy = 1e-4};
    if (read) scene.outputs.push_back("b");  // seen, and not reached
    const ReducedSystem r = compile(d, scene);
    CHECK(r.steps()[0].name == "structure");
    CHECK(r.steps()[0].before == 3 * 36 + 4 / 2);
    CHECK(r.steps()[0].after == 36);
    CHECK(r.steps()[0].error == 0);
    CHECK(r.full().order() == 72);
    check_beside(r, scene, truth_of(tree.structure(tip, read ? still : tip)));
    for (const KeptMode& m : r.modes())
      for (const auto& [name, share] : m.blocks) CHECK(name == "boom");
    if (read) CHECK(r.transfer({0.1, 50}).bottomRows(6).isZero(0));
  }
}

TEST_CASE("a mode far below the band's upper end is seen: the band is the one asked for") {
  // A spring of 2 mHz on a clamp: k / (m s^2 + k) has its peak, 1 / (2 zeta), at 2 mHz, and a
  // static gain of 1 / k. A model without its mode would be good from 6 mHz on.
  const double w = 2 * std::numbers::pi * 0.002, m = 3;
  Diagram d{"slow"};
  auto U = d.input("U");
  auto z = d.add("z", SpringMass{.mass = m, .stiffness = m * w * w});
  z.parent.accel = 0;
  z.child.force = U;
  d.output("x") = z.stretch;
  for (const double low : {1e-3, 0.0}) {
    const titop::Scene scene{.band_hz = {low, 60}, .accuracy = 1e-4};
    const ReducedSystem r = compile(d, scene);
    CHECK(r.order() == 2);
    const double peak = 1 / (m * w * w) / (2 * scene.damping_floor);
    CHECK(relative(r.bound().peak(0, 0), peak) <= 0.15);  // the grid's own factor is 1.14
    const auto by_hand = [&](Complex s) {
      return Eigen::MatrixXcd::Constant(1, 1, 1.0 / (m * (s * s + w * w)));
    };
    CHECK(beside(r, scene, {by_hand, {w}}).bound <= 1);
  }
}

TEST_CASE("positions and rates of a free body have no gain at 0: refused, output and input named") {
  Diagram d{"free"};
  auto U = d.input("U", 6);
  auto hub = d.add(
      "hub",
      RigidBody{.mass = 20, .inertia = Matrix3d::Identity(), .children = {{"C", {0.3, 0, 0}}}});
  auto beam = d.add("beam", slim_beam(4));
  hub.parent.force = -U;
  mount(beam, hub.child("C"), Rotation{});
  d.output("x", 6) = hub.parent.position;
  d.output("v", 6) = hub.parent.rate;
  d.output("a", 6) = hub.parent.accel;
  const auto refused = [&](const std::string& output, std::array<double, 2> band) {
    return error_of(
        [&] { compile(d, titop::Scene{.outputs = {output}, .band_hz = band, .accuracy = 1e-3}); });
  };
  CHECK(says(refused("x", {0, 0}), Code::bad_value, {"x(", "position", "U(", "Scene::band_hz"}));
  CHECK(says(refused("x", {0, 50}), Code::bad_value, {"x(", "position", "U(", "Scene::band_hz"}));
  CHECK(says(refused("v", {0, 50}), Code::bad_value, {"v(", "rate", "U(", "Scene::band_hz"}));
  CHECK(refused("x", {0.5, 50}).mistakes().empty());
  CHECK(refused("a", {0, 50}).mistakes().empty());
}

TEST_CASE("wrong scenes are refused by name") {
  const Diagram d = loaded(slim_beam(3), 1);
  const auto refused = [&](const titop::Scene& scene) {
    return error_of([&] { compile(d, scene); });
  };
  CHECK(says(refused({.band_hz = {5, 2}}), Code::bad_value, {"5", "2 Hz"}));
  CHECK(says(refused({.band_hz = {0, 9}, .accuracy = 0}), Code::bad_value, {"accuracy", "0"}));
  CHECK(says(refused({.band_hz = {0, 9}, .damping_floor = 0}), Code::bad_value,
             {"0", "1e-6", "0.5"}));
  CHECK(says(refused({.inputs = {"V"}, .band_hz = {0, 9}}), Code::unknown_name, {"V", "U"}));
  CHECK(says(refused({.outputs = {"a(7)"}, .band_hz = {0, 9}}), Code::unknown_name, {"a(7)"}));
  const Diagram damped = frame(slim_beam(5, 0.005));
  const Error error = error_of([&] {
    compile(damped, titop::Scene{.band_hz = {0, 30}, .accuracy = 2e-12});
  });
  CHECK(says(error, Code::bad_value, {"2.0e-12", "U("}));
}
