#pragma once

#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "support/planted.hpp"
#include "support/transfer_error.hpp"

namespace titop_test {

/// The verdict's interval contains the planted order, the model has it if it is decided, its
/// transfer is the factors'; exact arithmetic agrees. True if it is decided.
inline bool planted_order_holds(std::uint64_t seed, bool exactly) {
  const Planted p = planted(seed);
  const titop::System system = titop::compile(p.diagram);
  CHECK(system.order() == p.order + p.planted);
  const titop::OrderVerdict& v = system.order_verdict();
  CAPTURE(to_string(v));
  CHECK(v.lowest <= p.order);
  CHECK(v.highest >= p.order);
  CHECK(v.order == system.state_space().order());
  if (v.decided()) CHECK(v.order == p.order);
  if (exactly) {
    const titop::ExactOrder exact = exact_order(p.diagram.graph());
    CHECK(exact.decided);
    CHECK(exact.order == p.order);
  }
  std::vector<Eigen::MatrixXcd> minimal, factored;
  for (const std::complex<double> s : {std::complex<double>{0.2, 1}, {0.5, 5}, {2, 20}}) {
    minimal.push_back(system.state_space().transfer(s));
    factored.push_back(system.transfer(s));
  }
  const auto ones = [](std::size_t n) { return std::vector<Eigen::Index>(n, 1); };
  CHECK(transfer_error(minimal, factored, ones(system.outputs().size()),
                       ones(system.inputs().size())) <= 1e-9);
  return v.decided();
}

}  // namespace titop_test
