#include <doctest/doctest.h>

#include <fstream>
#include <string>
#include <titop/graph/linalg/eigen.hpp>

#include "by_hand.hpp"

/// Boundary conditions by the scene's imposed signals: clamped, pinned, free; frequencies against
/// the finite-element program, the same M and K, and the textbook.

using namespace scenes_test;
using namespace titop;

namespace {

const FlexibleBody& calculix_beam() {
  static const FlexibleBody body = fe::modal_data(
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"),
                        {{"P", 900001}, {"C", 900003}}),
      "P", {"C"});
  return body;
}

/// Relative distance of the nearest pole.
double distance(const std::vector<Pole>& poles, double omega) {
  double best = 1;
  for (const Pole& p : poles) best = std::min(best, std::abs(p.s - Complex(0, omega)) / omega);
  return best;
}

const Tube kTube{2, 0.05, 0.04, 20};

/// Frequency of the uniform beam in bending for this root.
double bending(double beta_L) {
  const by_hand::Beam b = kTube.numbers();
  return std::pow(beta_L / b.length, 2) * std::sqrt(b.EI / b.mass);
}

/// First term of the relative error of cubic elements with consistent mass.
double cubic_error(double beta_L) { return std::pow(beta_L / kTube.elements, 4) / 1440; }

}  // namespace

TEST_CASE("CalculiX beam clamped in a scene: the program's own frequencies") {
  Diagram d{"clamped"};
  auto b = d.add("beam", calculix_beam());
  ground(b);
  const auto poles = compile(d).poles();
  REQUIRE(poles.size() == 342);
  std::ifstream file(TITOP_DATA_DIR "/calculix_beam/expected_clamped_free.csv");
  std::string line;
  std::getline(file, line);
  std::size_t k = 0;
  for (; std::getline(file, line); ++k) {
    const double expected = std::stod(line.substr(line.rfind(',') + 1));
    INFO("mode ", k + 1);
    CHECK(std::abs(poles[k].omega / expected - 1) <= 1e-8);
    CHECK(poles[k].s.real() == 0);
  }
  CHECK(k == 20);
}

TEST_CASE("CalculiX beam released in a scene: the eigenvalues of the same M and K") {
  Diagram d{"free"};
  auto b = d.add("beam", calculix_beam());
  release(b);
  const auto poles = compile(d).poles();
  REQUIRE(poles.size() == 342);  // accelerations only: rigid motion has no state
  const fe::Mesh mesh =
      fe::read_calculix(fe::calculix_files(TITOP_DATA_DIR "/calculix_beam/beam_free_mat"), {});
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(mesh.K, mesh.M,
                                                                 Eigen::EigenvaluesOnly);
  double worst = 0;
  for (Index i = 0; i < 342; ++i)
    worst = std::max(worst, std::abs(poles[static_cast<std::size_t>(i)].omega /
                                         std::sqrt(modes.eigenvalues()(i + 6)) -
                                     1));
  CHECK(worst <= 1e-8);
}

TEST_CASE("beam in a scene: the textbook's roots") {
  const FlexibleBody body = kTube.beam();
  struct Case {
    const char* name;
    std::vector<double> roots;
  };
  for (const Case& c : {Case{"clamped", {1.8751040687, 4.6940911330, 7.8547574382}},
                        Case{"pinned", {3.9266023120, 7.0685827456, 10.2101761228}},
                        Case{"free", {4.7300407449, 7.8532046241, 10.9956078380}}}) {
    Diagram d{c.name};
    auto b = d.add("beam", body);
    if (std::string(c.name) == "clamped") {
      ground(b);
    } else {
      if (std::string(c.name) == "pinned") b.parent.accel.linear = 0;
      release(b);
    }
    const auto poles = compile(d, {.minimize_up_to = 0}).poles();
    for (const double root : c.roots) {
      INFO(c.name, " ", root);
      const double error = distance(poles, bending(root));
      CHECK(error <= 1.05 * cubic_error(root) + 1e-8);
      CHECK(error >= 0.9 * cubic_error(root) - 1e-8);
    }
  }
}

TEST_CASE("two half beams end to end are the whole beam") {
  const Tube half{1, 0.05, 0.04, 4}, whole{2, 0.05, 0.04, 8};
  Diagram one{"whole"}, two{"halves"};
  const FlexibleBody piece = half.beam();
  auto a = one.add("whole", FlexibleBody{whole.beam()});
  a.parent.force = -one.input("W", 6);
  a.child.force = one.input("F", 6);
  one.output("P", 6) = a.parent.accel;
  one.output("C", 6) = a.child.accel;
  auto left = two.add("left", piece), right = two.add("right", piece);
  mount(right, left.child);
  left.parent.force = -two.input("W", 6);
  right.child.force = two.input("F", 6);
  two.output("P", 6) = left.parent.accel;
  two.output("C", 6) = right.child.accel;
  const System first = compile(one), second = compile(two);
  const auto s = points({10, 100, 500, 2000, 10000});
  const auto exact = responses(first, s);
  CHECK(error_3(responses(second, s), exact) <= 1e-10);
  CHECK(first.state_space().order() == second.state_space().order());
  CHECK(error_3(responses(second.state_space(), s), exact) <= 1e-10);
  CHECK(by_hand::pole_error(by_hand::moving(second.poles()), by_hand::moving(first.poles())) <=
        1e-10);
}
