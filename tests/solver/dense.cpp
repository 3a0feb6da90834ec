#include <doctest/doctest.h>
#include <fmt/format.h>

#include <titop/compiler/system.hpp>
#include <titop/graph/mount.hpp>

#include "support/random_scene.hpp"

/// What writing the dense model down costs: said beforehand, found when it is tried.

using namespace titop;
using titop_test::Rng;

namespace {

/// Ten flexible bodies, every second one `ratio` times heavier.
System chain(double ratio) {
  Rng rng(3);
  Diagram d{"chain"};
  const auto U = d.input("U", 6);
  std::vector<BodyHandle> body;
  for (int i = 0; i < 10; ++i)
    body.push_back(
        d.add(fmt::format("b{}", i + 1),
              FlexibleBody(titop_test::scaled(titop_test::random_modes(rng, 6, {"C"}, true),
                                              {.mass = i % 2 ? ratio : 1}))));
  body.front().parent.force = -U;
  for (std::size_t i = 1; i < body.size(); ++i)
    mount(body[i], body[i - 1].child, Rotation::matrix(rng.rotation()));
  d.output("tip", 6) = body.back().child.accel;
  return compile(d, {.minimize_up_to = 0});
}

/// The error of the dense model for all inputs, at the s where the certificate says it is largest.
double tried(const System& system) {
  const std::complex<double> s = system.certificate().dense_error_s;
  const Eigen::MatrixXcd exact = system.transfer(s, Precision::digits50);
  return (system.state_space().transfer(s) - exact).cwiseAbs().maxCoeff() /
         exact.cwiseAbs().maxCoeff();
}

bool warns(const System& system) {
  return system.log().find("the model keeps") != std::string::npos;
}

}  // namespace

TEST_CASE("dense export: harmless where the bodies are alike") {
  const System system = chain(1);
  system.state_space();
  CHECK(system.certificate().dense_error >= 0);
  CHECK(system.certificate().dense_error <= 1e-11);
  CHECK(system.certificate().dense_against_factors <= 1e-13);
  CHECK(!warns(system));
}

TEST_CASE("dense export: what it costs at mass ratios is said, and so it is") {
  for (const double ratio : {1e6, 1e9, 1e12}) {
    const System system = chain(ratio);
    CHECK(system.certificate().dense_error < 0);
    system.state_space();
    const double said = system.certificate().dense_error, found = tried(system);
    MESSAGE(fmt::format("ratio {:.0e}: said {:.1e}, found {:.1e}", ratio, said, found));
    CAPTURE(ratio);
    // The dense solution that `tried` needs has rounding of its own, of the same size.
    CHECK(found <= 100 * said);
    CHECK(said <= 100 * found);
    CHECK(warns(system) == (said > 1e-9));
  }
}
