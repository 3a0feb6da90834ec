#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/close.hpp"
#include "support/mistakes.hpp"
#include "support/notes.hpp"

/// Chains that are open by some distance, in metres: through a bushing, which constrains nothing,
/// and welded.

using namespace titop;
using titop_test::compile_error;
using titop_test::noted;
using titop_test::says;

namespace {

enum class Far { bushing, weld };

/// A plate on a hinge at one corner of a hub; its far corner `gap` beside the hub's.
Diagram plate(double gap, Far far) {
  Diagram d{"plate"};
  auto hub = d.add("hub", RigidBody{.mass = 10,
                                    .inertia = {2, 3, 4},
                                    .children = {{"near", {0.1, 0, 0}}, {"far", {0.1, 0.2, 0}}}});
  auto plate = d.add(
      "plate",
      RigidBody{.mass = 1, .inertia = {0.1, 0.2, 0.3}, .children = {{"far", {0, 0.2 + gap, 0}}}});
  hub.parent.force = -d.input("W", 6);
  if (far == Far::bushing) {
    auto pin = hinge(d, "pin", plate, hub.child("near"), Rotation{}, {0, 1, 0});
    pin.torque = 0;
    bushing(d, "rubber", plate.child("far"), hub.child("far"), Rotation{},
            {.stiffness = {4e4, 5e4, 9e4, 900, 700, 300}});
  } else {
    mount(plate, hub.child("near"));
    weld(plate.child("far"), hub.child("far"));
  }
  d.output("a", 6) = hub.parent.accel;
  d.output("p", 6) = plate.child("far").accel;
  return d;
}

}  // namespace

TEST_CASE("a bushing between points 4e-7 m apart is the one between coinciding points") {
  const System exact = compile(plate(0, Far::bushing)), off = compile(plate(4e-7, Far::bushing));
  CHECK(off.order() == exact.order());
  CHECK(exact.order() == 2);  // the hinge's angle; the bushing's six follow from it
  for (const double omega : {1.0, 100.0, 1000.0}) {
    const Eigen::MatrixXcd a = off.transfer({0, omega}), b = exact.transfer({0, omega});
    CHECK((a - b).cwiseAbs().maxCoeff() <= 1e-5 * b.cwiseAbs().maxCoeff());
  }
  CHECK(noted(off, Note::Kind::warning, "chains", {"4.0e-07 m"}));
  // A gap of a hundredth of a millimetre, of 0.2 m or so, is a mistake.
  CHECK(says(compile_error(plate(1e-5, Far::bushing)), Code::kinematic_loop, {"1.0e-05 m"}));
}

TEST_CASE("a weld across the same gap is refused in metres, with the limit") {
  CHECK(says(compile_error(plate(4e-7, Far::weld)), Code::kinematic_loop,
             {"4.0e-07 m", "2.0e-07 m", "far"}));
}
