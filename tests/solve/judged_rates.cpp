#include <doctest/doctest.h>

#include <titop/compiler/system/system_data.hpp>
#include <titop/titop.hpp>

#include "generate/diagrams/timed.hpp"
#include "support/rng.hpp"

/// Rates and outputs of given states and inputs, by factors with a planted mistake: right, or
/// refused.

using namespace titop;
using generate::Case;
using titop_test::Rng;

namespace {

/// The system with the factors of another one of the same plan.
std::unique_ptr<detail::SystemData> with_factors_of(const System& other, const System& system) {
  const detail::SystemData& d = detail::data_of(system);
  auto result = std::make_unique<detail::SystemData>();
  result->skeleton = d.skeleton;
  result->numbers = d.numbers;
  result->states = d.states;
  result->factors = std::make_unique<const solve::Factors<double>>(
      d.skeleton->joint.plan, detail::real_rows(*d.skeleton, detail::data_of(other).numbers));
  return result;
}

double difference(const solve::RowMatrix<double>& a, const solve::RowMatrix<double>& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("rates by factors with a planted mistake are right or refused") {
  int large = 0, refused = 0;  // mistakes
  for (const Case c : {Case::BL, Case::C, Case::D, Case::T})
    for (const int n : {3, 10, 30})
      for (const double p : {1.0, 1 + 1e-12, 1.001, 1.5, 3.0, 100.0}) {
        CAPTURE(generate::name_of(c));
        CAPTURE(n);
        CAPTURE(p);
        const System right = compile(
            generate::case_diagram(c, n, {.varies = generate::Varies::one}), {.minimize_up_to = 0});
        const auto mistaken = with_factors_of(right.update({{"p", p}}), right);
        Rng rng(static_cast<std::uint64_t>(n));
        const Eigen::Index known = right.order() + static_cast<Eigen::Index>(right.inputs().size());
        const solve::RowMatrix<double> x = rng.matrix(known, 2);
        const detail::RateColumns exact = detail::rates(detail::data_of(right), x);
        try {
          const detail::RateColumns found = detail::rates(*mistaken, x);
          CHECK(difference(found.xdot, exact.xdot) <= 1e-11);
          CHECK(difference(found.y, exact.y) <= 1e-11);
        } catch (const Error& error) {
          CHECK(error.has(Code::singular));
          CHECK(p > 1.001);
          if (p >= 3) ++refused;
        }
        if (p >= 3) ++large;
      }
  CHECK(2 * refused >= large);
}
