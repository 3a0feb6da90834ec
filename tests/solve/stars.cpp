#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/rng.hpp"

/// A hub with very many appendages, and sums of very many terms: rows over all of them become
/// partial sums, and the work stays linear in their number.

using namespace titop;
using titop_test::matrix_error;

namespace {

Diagram star(int n, double mass = 100) {
  Diagram d{"star"};
  RigidBody hub{.mass = d.param("mass", mass), .inertia = 40 * Eigen::Matrix3d::Identity()};
  for (int i = 0; i < n; ++i)
    hub.children.push_back({fmt::format("C{}", i + 1), {std::cos(i), std::sin(i), 0.1 * i}});
  const FlexibleBody wing = Beam{.length = 2.0,
                                 .section = rectangle(0.06, 0.04),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 2,
                                 .modes = {.kept = 3, .xi = {0.005}}};
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  const Eigen::MatrixXd sensor{{0.5, 0, 0, 0, 0.2, 0}};
  Expr sum;
  for (int i = 0; i < n; ++i) {
    auto A = d.add(fmt::format("A{}", i + 1), wing);
    mount(A, B.child(fmt::format("C{}", i + 1)), Rotation::about({0, 0, 1}, 0.1 * i));
    const Expr one = sensor * A.child.accel;
    sum = i == 0 ? one : sum + one;
  }
  d.output("hub", 6) = B.parent.accel;
  d.output("sum") = sum;
  return d;
}

/// A hub of 40 points whose free parent has no mass at all: nothing else is mounted there.
Diagram bare_hub(double mass) {
  Diagram d{"bare"};
  RigidBody hub{.mass = mass};
  for (int i = 0; i < 40; ++i) hub.children.push_back({fmt::format("C{}", i + 1), {0.1 * i, 0, 0}});
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  d.output("a", 6) = B.child("C40").accel;
  for (int i = 0; i < 40; ++i) B.child(fmt::format("C{}", i + 1)).force = 0;
  return d;
}

std::vector<Note> notes_of(const Diagram& d) { return compile(d, {.minimize_up_to = 0}).notes(); }

/// Number of fronts of the elimination.
int fronts(int n) { return compile(star(n), {.minimize_up_to = 0}).certificate().fronts; }

}  // namespace

TEST_CASE("star: the same transfer as all equations solved together") {
  for (const int n : {3, 14, 40}) {
    const Diagram d = star(n);
    const System system = compile(d, {.minimize_up_to = 0});
    CAPTURE(n);
    CHECK(system.certificate().residual <= 1e-12);
    const std::complex<double> s{0.7, 9};
    CHECK(matrix_error(system.transfer(s), transfer(d.graph(), s)) <= 1e-11);
    StateSpace m;
    system.write(m);
    CHECK(matrix_error(m.transfer(s), system.transfer(s)) <= 1e-10);
  }
}

namespace {

/// A hub with 100 booms at random points, one in three turned almost about a single axis. Per boom
/// the acceleration of its root, and how far it is from the hub's there.
Diagram oblique(std::uint64_t seed, int n) {
  const FlexibleBody boom = Beam{.length = 2,
                                 .section = rectangle(0.06, 0.04),
                                 .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                 .elements = 4,
                                 .modes = {.kept = 6}};
  titop_test::Rng rng(seed);
  RigidBody hub{.mass = 1000, .inertia = 300 * Eigen::Matrix3d::Identity()};
  for (int i = 0; i < n; ++i)
    hub.children.push_back({fmt::format("C{}", i), Eigen::Vector3d(rng.matrix(3, 1))});
  Diagram d{"oblique"};
  auto U = d.input("U", 6);
  auto B = d.add("B", hub);
  B.parent.force = -U;
  for (int i = 0; i < n; ++i) {
    auto A = d.add(fmt::format("A{}", i), boom);
    Eigen::Vector3d axis = rng.matrix(3, 1);
    if (i % 3 == 1) axis.x() *= 0.01, axis.z() *= 0.01;
    const Rotation T = Rotation::about(axis, rng.between(0, 6));
    const auto point = B.child(fmt::format("C{}", i));
    mount(A, point, T);
    d.output(fmt::format("a{}", i), 6) = A.parent.accel;
    d.output(fmt::format("off{}", i), 6) = A.parent.accel - T.inverse() * point.accel;
  }
  return d;
}

}  // namespace

// The direct term of a slender beam is its residual mass after six modes: hardly any about its
// cross axes. Used as a pivot it loses digits of the boom's acceleration; with the hub's columns
// scaled one by one, entries that are nearly 0 in such an orientation made it look as good as the
// mount.
TEST_CASE("star: accelerations of slender booms, mounted obliquely, follow the hub's") {
  for (const std::uint64_t seed : {4U, 5U, 7U, 11U}) {
    const int n = 100;
    const System system = compile(oblique(seed, n), {.minimize_up_to = 0});
    titop_test::Rng rng(seed);
    const Eigen::VectorXd x = 1e-3 * rng.matrix(system.order(), 1), u = rng.matrix(6, 1);
    const Eigen::VectorXd y = system.apply(x, u).y;
    REQUIRE(y.allFinite());
    double worst = 0;
    for (int i = 0; i < n; ++i)
      worst = std::max(worst, y.segment<6>(12 * i + 6).lpNorm<Eigen::Infinity>() /
                                  y.segment<6>(12 * i).lpNorm<Eigen::Infinity>());
    CAPTURE(seed);
    CHECK(worst <= 3e-12);
  }
}

TEST_CASE("star: fronts and entries grow linearly") {
  const auto entries = [](int n) {
    return compile(star(n), {.minimize_up_to = 0}).descriptor().A.nonZeros();
  };
  const auto a = entries(40), b = entries(80), c = entries(160);
  CHECK(double(c - b) <= 2.2 * double(b - a));
  CHECK(fronts(160) <= 5 * fronts(40));
}

TEST_CASE("star: a new mass of the hub on the old plan") {
  const System changed = compile(star(14)).update({{"mass", 37}});
  const std::complex<double> s{0.7, 9};
  CHECK(matrix_error(changed.transfer(s), transfer(star(14, 37).graph(), s)) <= 1e-11);
}

TEST_CASE("star: its one inversion is the hub's parent, as with few appendages") {
  for (const int n : {3, 14}) {
    std::vector<std::string> inverted;
    for (const Note& note : notes_of(star(n)))
      if (note.kind == Note::Kind::inverted) inverted.push_back(note.text);
    REQUIRE(inverted.size() == 1);
    CHECK(titop_test::has_names(inverted[0], {"B.parent", "B.parent.force", "B.parent.accel"}));
  }
}

TEST_CASE("star: a hub of many points without mass is named") {
  CHECK(titop_test::says(titop_test::compile_error(bare_hub(0)), Code::improper,
                         {"B.parent.force", "B", "0", "RigidBody{.mass"}));
}

TEST_CASE("star: a child point is found by its name, an unknown one is refused") {
  Diagram d = bare_hub(3);
  RigidBody hub{.mass = 3};
  for (int i = 0; i < 40; ++i) hub.children.push_back({fmt::format("C{}", i + 1), {0.1 * i, 0, 0}});
  auto B = d.add("B2", hub);
  const Error wrong = titop_test::error_of([&] {
    ground(B.child("C41"));
    compile(d);
  });
  CHECK(titop_test::says(wrong, Code::unknown_name, {"B2", "C41"}));
}
