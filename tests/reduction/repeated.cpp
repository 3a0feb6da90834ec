#include <doctest/doctest.h>

#include <set>
#include <titop/analysis/reduction/bodies.hpp>

#include "scenes.hpp"
#include "support/close.hpp"

/// Beams of square section: every bending mode twice, in two planes.
using namespace titop;
using namespace titop_test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kElements = 8;

FlexibleBody square_beam() {
  return Beam{.length = 2,
              .section = rectangle(0.05, 0.05),
              .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
              .elements = kElements};
}

/// Two of them in line, the second turned about their axis, where no direction is another;
/// clamped. Forces along the columns of `along` at the tip, accelerations there.
Diagram line(const MatrixXd& along) {
  Diagram d{"line"};
  auto U = d.input("U", static_cast<int>(along.cols()));
  auto b1 = d.add("b1", square_beam()), b2 = d.add("b2", square_beam());
  b1.parent.accel = 0;
  mount(b2, b1.child("C"), Rotation::about({1, 0, 0}, 0.3));
  b2.child("C").force = along * U;
  d.output("a", static_cast<int>(along.cols())) = along.transpose() * b2.child("C").accel;
  return d;
}

Truth line_by_hand(const MatrixXd& along) {
  Tree tree(false);
  const ModalData data = square_beam().data();
  const int b1 = tree.add(data);
  const int b2 = tree.add(data, b1, 0, Rotation::about({1, 0, 0}, 0.3).nominal());
  const MatrixXl tip = along.transpose().cast<long double>() * tree.motion(b2, 0);
  return truth_of(tree.structure(tip, tip));
}

/// Numbers of kept modes of the whole at each frequency.
std::vector<int> multiplicities(const ReducedSystem& r) {
  std::vector<int> counts;
  double last = 0;
  for (const KeptMode& m : r.modes()) {
    if (!m.exact) continue;
    if (last > 0 && relative(m.hertz, last) <= 1e-9)
      ++counts.back();
    else
      counts.push_back(1);
    last = m.hertz;
  }
  return counts;
}

}  // namespace

TEST_CASE("a body keeps both bending modes of a frequency, or none") {
  // Only one direction is used: each of the two has an effect of its own.
  const Diagram d = frame(square_beam());
  titop::Scene scene{.inputs = {"U(2)"}, .outputs = {"a(2)"}, .band_hz = {0, 60}};
  const Graph graph = detail::restricted(d.graph(), scene);
  const auto effects = detail::mode_effects(graph, scene, {});
  REQUIRE(effects.size() == 3);
  const std::vector<double> values = nominal_values(graph);
  const auto modal = [&](const Graph& g) {
    return g.nodes[static_cast<std::size_t>(effects[0].node)].block->dynamics(values)->modal;
  };
  const VectorXd all = modal(graph)->stiffness;
  // 2 x 2 of the 6 coordinates of each node bend.
  std::vector<std::pair<Index, Index>> pairs;
  for (Index i = 0; i < all.size(); ++i)
    for (Index j = i + 1; j < all.size(); ++j)
      if (relative(all(i), all(j)) <= 1e-9) pairs.emplace_back(i, j);
  REQUIRE(pairs.size() == 2 * kElements);
  std::set<std::size_t> counts;
  int apart = 0;  // single modes would differ by their own effects
  for (int k = 4; k <= 48; ++k) {
    const double share = std::pow(10, -0.25 * k);
    CAPTURE(share);
    const VectorXd few = modal(detail::smaller_bodies(graph, effects, share).graph)->stiffness;
    const auto stays = [&](Index j) { return (few.array() == all(j)).any(); };
    std::size_t kept = 0;
    for (const auto& [i, j] : pairs) {
      CHECK(stays(i) == stays(j));
      kept += stays(i);
    }
    counts.insert(kept);
  }
  CHECK(counts.size() >= 5);
  for (const auto& [i, j] : pairs)
    apart += relative(effects[0].corrected(i), effects[0].corrected(j)) > 0.1;
  CHECK(apart >= kElements);
}

TEST_CASE("smaller bodies with repeated modes: the bound holds against the whole by hand") {
  const Diagram d = frame(square_beam());
  const Truth truth = frame_by_hand(square_beam());
  for (const double accuracy : {1e-1, 1e-3, 1e-5}) {
    CAPTURE(accuracy);
    const titop::Scene scene{.band_hz = {0, 60}, .accuracy = accuracy, .whole_up_to = 120};
    const ReducedSystem r = compile(d, scene);
    CHECK(r.steps()[1].name == "bodies");
    check_beside(r, scene, truth);
  }
}

TEST_CASE("of two modes of one frequency one answers one force, whatever its direction") {
  MatrixXd skew = MatrixXd::Zero(6, 1);
  skew(1) = std::cos(0.4), skew(2) = std::sin(0.4);
  const titop::Scene scene{.band_hz = {0, 60}, .accuracy = 1e-6};
  const Truth truth = line_by_hand(skew);
  const auto below = std::count_if(truth.omegas.begin(), truth.omegas.end(),
                                   [](double w) { return w <= 2 * std::numbers::pi * 60; });
  CHECK(below == 6);  // 2.6, 16 and 45 Hz, in two planes each
  const ReducedSystem r = compile(line(skew), scene);
  CHECK(multiplicities(r) == std::vector<int>{1, 1, 1});
  check_beside(r, scene, truth);
}

TEST_CASE("all forces at the tip keep both modes of a frequency, or none") {
  const MatrixXd all = MatrixXd::Identity(6, 6);
  const Truth truth = line_by_hand(all);
  for (const double accuracy : {0.5, 1e-1, 1e-2, 1e-4, 3e-5}) {
    CAPTURE(accuracy);
    const titop::Scene scene{.band_hz = {0, 60}, .accuracy = accuracy};
    const ReducedSystem r = compile(line(all), scene);
    check_beside(r, scene, truth);
    const std::vector<int> counts = multiplicities(r);
    CHECK(counts == std::vector<int>(counts.size(), 2));
    CHECK(!counts.empty());
  }
}

TEST_CASE("two modes of one frequency keep their own damping") {
  const double m[] = {1, 4}, c[] = {0.02, 0.4}, k[] = {100, 400};
  Diagram d{"apart"};
  for (const int i : {0, 1}) {
    const std::string n = std::to_string(i + 1);
    auto U = d.input("U" + n);
    auto z = d.add("z" + n, SpringMass{.mass = m[i], .stiffness = k[i], .damping = c[i]});
    z.parent.accel = 0;
    z.child.force = U;
    d.output("x" + n) = z.stretch;
  }
  const titop::Scene scene{.band_hz = {0, 3}, .accuracy = 1e-3, .damping_floor = 1e-3};
  const auto truth = [&](std::complex<double> s) {
    Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(2, 2);
    for (const int i : {0, 1}) H(i, i) = 1.0 / (m[i] * s * s + c[i] * s + k[i]);
    return H;
  };
  const ReducedSystem r = compile(d, scene);
  CHECK(r.order() == 4);
  CHECK(beside(r, scene, {truth, {10}}, 2000).error <= 1e-9);
}
