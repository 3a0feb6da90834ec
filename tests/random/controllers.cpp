#include <doctest/doctest.h>

#include <titop/compiler/system/system.hpp>
#include <titop/graph/error.hpp>

#include "support/dense_truth.hpp"
#include "support/random_checks.hpp"
#include "support/transfer_error.hpp"

/// Random scenes with dense controllers of 3 to 12 states around them, of every kind of
/// random_lti.hpp, against all equations at once in 100 digits.

using namespace titop::generate;
using namespace titop_test;

namespace {

constexpr std::uint64_t kScenes = 60;

RandomOptions options_of(std::uint64_t seed) {
  RandomOptions options = random_options(seed);
  options.bodies = 1 + static_cast<int>(seed % 3);
  options.assemblies = 1;
  options.incomplete = false;
  options.large_controllers = 1 + static_cast<int>(seed % 2);
  return options;
}

}  // namespace

TEST_CASE("random graphs with controllers of 3 to 12 states: transfers and dense model to 1e-9") {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    const RandomDiagram scene = random_diagram(options_of(seed));
    const titop::Diagram diagram = scene.build();
    const titop::System system = titop::compile(diagram, {.minimize_up_to = 0});
    CHECK(system.certificate().residual <= 1e-9);
    const std::complex<double> s = points(seed, 1).front();
    const auto rows = RandomDiagram::blocks(scene.outputs),
               cols = RandomDiagram::blocks(scene.inputs);
    const std::vector<Eigen::MatrixXcd> exact{
        as_declared(diagram.graph(), dense_truth(diagram.graph(), s).transfer)};
    const auto error = [&](const Eigen::MatrixXcd& y) {
      return transfer_error<Eigen::MatrixXcd>({y}, exact, rows, cols);
    };
    CHECK(error(system.transfer(s)) <= 1e-9);
    CHECK(error(system.transfer(s, titop::Precision::digits50)) <= 1e-9);
    CHECK(error(system.state_space().transfer(s)) <= 1e-9);
  }
}

TEST_CASE("random graphs with controllers of 3 to 12 states: every pass keeps the transfer") {
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    PassError error{1, "threw"};
    CHECK_NOTHROW(error = pass_error(random_diagram(options_of(seed))));
    CAPTURE(error.pass);
    CHECK(error.worst <= 1e-9);
  }
}

TEST_CASE("random graphs with controllers of 3 to 12 states: the same in other units") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    CHECK(units_error(random_diagram(options_of(seed)),
                      {.length = 1e3, .mass = 1e-3, .time = 10}) <= 1e-9);
  }
}

TEST_CASE("random graphs with controllers of 3 to 12 states: in and out of loops, all sizes") {
  std::vector<int> of_order(13);
  int in_loops = 0, direct = 0, wide = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    const titop::System system =
        titop::compile(random_diagram(options_of(seed)).build(), {.minimize_up_to = 0});
    const titop::Graph& g = system.stage().now();
    for (const titop::Node& node : g.nodes) {
      if (node.block->type() != "Lti") continue;
      const auto d = node.block->dynamics(titop::nominal_values(g));
      const auto n = d->A.rows();
      if (n < 3) continue;
      ++of_order[static_cast<std::size_t>(n)];
      direct += !d->D.isZero(0), wide += d->B.cols() > 1 && d->C.rows() > 1;
    }
    for (const titop::Loop& loop : system.stage().loops) in_loops += loop.signals.size() > 1;
  }
  for (std::size_t n = 3; n <= 12; ++n) CHECK(of_order[n] >= 2);
  CHECK(in_loops >= 10);
  CHECK(direct >= 20);
  CHECK(wide >= 20);
}
