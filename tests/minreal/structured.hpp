#pragma once

#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/structured_lti.hpp"

/// Orders of structured Lti against ranks without rounding.
namespace titop_test {

inline titop::Diagram diagram(const titop::Lti& lti) {
  titop::Diagram d{"structured"};
  auto u = d.input("u", static_cast<int>(lti.B.cols()));
  auto k = d.add("k", lti);
  k.in = u;
  d.output("y", static_cast<int>(lti.C.rows())) = k.out;
  return d;
}

/// The order lies in the verdict's interval. True if the model has it.
inline bool structured_order_holds(std::uint64_t seed, bool units) {
  const StructuredLti m = structured_lti(seed, units);
  const titop::System system = compile(diagram(m.lti));
  const titop::OrderVerdict verdict = system.order_verdict();
  CAPTURE(to_string(verdict));
  CHECK(verdict.lowest <= m.order);
  CHECK(verdict.highest >= m.order);
  return verdict.order == m.order;
}

}  // namespace titop_test
