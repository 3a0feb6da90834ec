#include <doctest/doctest.h>

#include <cmath>

#include "support/lossy_links.hpp"
#include "support/lossy_row.hpp"

/// Lossy rows of any length on the whole right half-plane: the product of what elimination does on
/// each front is neither lost nor grows.

using titop_test::LossyLinks;
using titop_test::LossyRow;
using Count = titop_test::LossyRowCount;

namespace {

constexpr double kDampings[] = {0, 0.1, 20, 1e3};

/// Point i of n, from 1e-3 to 1e3 rad/s.
double spaced(int i, int n) { return std::pow(10, -3 + 6.0 * i / (n - 1)); }

void check(const Count& count) {
  MESSAGE(count.tried, " tried, ", count.wrong, " wrong, ", count.refused, " refused");
  CHECK(count.wrong == 0);
  CHECK(count.refused == 0);
}

}  // namespace

TEST_CASE("rows up to 1,000 masses at 40 x 40 points of the axis and the right half-plane") {
  Count count;
  for (const int n : {10, 100, 1000})
    for (const double damping : kDampings)
      for (const LossyRow& row : titop_test::lossy_rows(n, damping)) {
        const titop::System system = titop::compile(row.diagram());
        for (int i = 0; i < 40; ++i)
          for (int j = 0; j < 40; ++j)
            count.ask(system, row, {i > 0 ? spaced(i - 1, 39) : 0, spaced(j, 40)});
      }
  CHECK(count.tried == 3 * 4 * 4 * 1600);
  check(count);
}

TEST_CASE("rows of 10,000 and 100,000 masses at 20 points") {
  Count count;
  for (const int n : {10'000, 100'000})
    for (const double damping : kDampings)
      for (const LossyRow& row : titop_test::lossy_rows(n, damping)) {
        const titop::System system = titop::compile(row.diagram());
        for (int i = 0; i < 20; ++i)
          count.ask(system, row, {i % 2 == 0 ? 0 : spaced(i, 20), spaced((7 * i) % 20, 20)});
      }
  check(count);
}

TEST_CASE("rows of 300 and 1,000 bodies on bushings and of beams clamped on each other") {
  for (const int n : {300, 1000})
    for (const auto joint : {LossyLinks::Joint::bushing, LossyLinks::Joint::clamp})
      for (const auto base : {LossyLinks::Base::held, LossyLinks::Base::free})
        for (const auto tip : {LossyLinks::Tip::force, LossyLinks::Tip::motion})
          for (const double damping : {0.0, 0.3, joint == LossyLinks::Joint::clamp ? 0.9 : 30.0}) {
            const LossyLinks links{
                .n = n, .joint = joint, .damping = damping, .base = base, .tip = tip};
            const titop::System system = titop::compile(links.diagram());
            for (const std::complex<double> s :
                 {std::complex<double>(0, 0.1), {0, 4.6}, {0, 1000}, {11, 14}}) {
              CAPTURE(n);
              CAPTURE(damping);
              CAPTURE(s);
              CHECK(titop_test::worst_block(system.transfer(s), links.exact(s), 0) <= 1e-8);
            }
          }
}
