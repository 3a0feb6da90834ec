// Outputs that are 0 but for rounding, in comparisons with distributed beams.
#include <doctest/doctest.h>

#include <cmath>
#include <titop/analysis/distributed/compare.hpp>
#include <titop/analysis/distributed/reduce_beams.hpp>

#include "reduction/free_hinge.hpp"

using namespace titop;
using namespace titop_test;
using Eigen::MatrixXd;

namespace {

ErrorBound error_of_six(const MatrixXd& reads) {
  const FlexibleBody finite{with_elements(kBoom, 6)};
  return compare(compile(hinged_load(finite, reads)), compile(hinged_load(kBoom, reads)),
                 kHingeScene);
}

}  // namespace

TEST_CASE("compare: an output that is 0 leaves the other pairs as they are without it") {
  const ErrorBound all = error_of_six(whole_reaction()), rest = error_of_six(other_components());
  CHECK(alike(without_zero(all.pairs), rest.pairs, 1e-6));
  CHECK(alike(without_zero(all.peak), rest.peak, 1e-6));
  CHECK(std::abs(all.worst / rest.worst - 1) <= 1e-6);
  CHECK(all.output == rest.output);
  CHECK(all.pairs.row(kAboutAxis).maxCoeff() <= 1e-9);
}

TEST_CASE("compare: a small pair that is no rounding has its own size") {
  const ErrorBound one = error_of_six(other_components()),
                   small = error_of_six(scaled_torque(5e-9));
  CHECK(alike(small.pairs, one.pairs, 1e-6));
  CHECK(alike(small.peak.row(3), 5e-9 * one.peak.row(3), 1e-6));
}

TEST_CASE("reduce_beams: an output that is 0 changes neither order nor error") {
  const auto reduced = [](const MatrixXd& reads) {
    return reduce_beams(hinged_load(kBoom, reads), kHingeScene);
  };
  const ReducedBeams all = reduced(whole_reaction()), rest = reduced(other_components());
  CHECK(all.system.order() == rest.system.order());
  CHECK(std::abs(all.error.worst / rest.error.worst - 1) <= 1e-6);
}
