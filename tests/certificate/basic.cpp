#include <doctest/doctest.h>

#include "simulate/scenes.hpp"

/// The certificate that every compile makes: no warning where nothing is wrong.

using namespace titop;

namespace {

bool warns(const System& system) {
  for (const Note& note : system.notes())
    if (note.kind == Note::Kind::warning) return true;
  return false;
}

}  // namespace

TEST_CASE("a force that dies away along 3000 masses to less than the smallest double is no fault") {
  const std::vector<double> m(3000, 1.3), k(3000, 107);
  const System system = compile(simulate_test::row_of_masses(m, k, 0.1), {.minimize_up_to = 0});
  CHECK(system.certificate().residual <= 1e-12);
  CHECK(!warns(system));
}
