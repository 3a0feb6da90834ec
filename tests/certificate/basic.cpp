#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "simulate/scenes.hpp"

/// The certificate that every compile makes: no warning where nothing is wrong.

using namespace titop;

namespace {

bool warns(const System& system) {
  for (const Note& note : system.notes())
    if (note.kind == Note::Kind::warning) return true;
  return false;
}

/// Four beams in a row, free, data and model in this unit of length.
System beams(double length) {
  const FlexibleBody beam(
      titop::scaled(titop::modal_data(Beam{.length = 2.0,
                                           .section = rectangle(0.06, 0.04),
                                           .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                                           .elements = 4,
                                           .modes = {.kept = 6, .xi = {0.005}}}),
                    {.length = length}));
  Diagram d{"beams"};
  auto U = d.input("U", 6);
  std::vector<FlexibleBody::Handle> b;
  b.reserve(4);
  for (std::size_t i = 0; i < 4; ++i) {
    b.push_back(d.add(fmt::format("b{}", i + 1), beam));
    if (i > 0)
      mount(b[i], b[i - 1].child, Rotation::about({1, 2, 3}, 0.7 * static_cast<double>(i)));
  }
  b.front().parent.force = -U;
  d.output("a", 6) = b.back().child.accel;
  return compile(d, {.minimize_up_to = 0});
}

}  // namespace

TEST_CASE("a force that dies away along 3000 masses to less than the smallest double is no fault") {
  const std::vector<double> m(3000, 1.3), k(3000, 107);
  const System system = compile(simulate_test::row_of_masses(m, k, 0.1), {.minimize_up_to = 0});
  CHECK(system.certificate().residual <= 1e-12);
  CHECK(!warns(system));
}

TEST_CASE("margin and warnings do not depend on the unit of length, 1 nm to 1 Gm") {
  const double margin = beams(1).certificate().margin;
  CHECK(margin < 1e4);
  for (const double length : {1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9}) {
    CAPTURE(length);
    const System system = beams(length);
    CHECK(std::abs(system.certificate().margin / margin - 1) <= 0.01);
    CHECK(!warns(system));
  }
}
