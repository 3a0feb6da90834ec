#include <doctest/doctest.h>

#include "free_hinge.hpp"

/// Outputs that are 0 but for rounding, in reduced models.
using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

ReducedSystem reduced(const MatrixXd& reads, bool keep_structure) {
  titop::Scene scene = kHingeScene;
  scene.keep_structure = keep_structure;
  return compile(hinged_load(FlexibleBody{with_elements(kBoom, 6)}, reads), scene);
}

}  // namespace

TEST_CASE("an output that is 0 leaves the reduced model as it is without it") {
  for (const bool keep : {true, false}) {
    CAPTURE(keep);
    const ReducedSystem all = reduced(whole_reaction(), keep),
                        rest = reduced(other_components(), keep);
    CHECK(all.order() == rest.order());
    CHECK(alike(without_zero(all.bound().pairs), rest.bound().pairs, 1e-3));
    CHECK(all.bound().pairs.row(kAboutAxis).maxCoeff() <= 1e-6);
  }
}

TEST_CASE("a small pair that is no rounding is reduced to its own size") {
  for (const bool keep : {true, false}) {
    CAPTURE(keep);
    const ReducedSystem one = reduced(scaled_torque(0.1), keep),
                        small = reduced(scaled_torque(5e-9), keep);
    CHECK(small.order() == one.order());
    CHECK(alike(small.bound().pairs, one.bound().pairs, 1e-3));
    CHECK(alike(small.bound().peak.row(3), 5e-8 * one.bound().peak.row(3), 1e-6));
  }
}
