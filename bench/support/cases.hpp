#pragma once

#include <algorithm>
#include <cmath>
#include <titop/titop.hpp>
#include <vector>

#include "generate/diagrams/timed.hpp"

/// The timed diagrams under the names by which the benchmarks call them.
namespace titop_bench {

using titop::generate::Case;
using titop::generate::case_diagram;
using titop::generate::case_of;
using titop::generate::name_of;
using titop::generate::Varies;

/// Points of responses: so many frequencies [rad/s], logarithmic, from 0.11 to 1100.
inline std::vector<double> frequencies(int count) {
  std::vector<double> omega;
  for (int k = 0; k < count; ++k)
    omega.push_back(0.11 * std::pow(1e4, k / std::max(1.0, count - 1.0)));
  return omega;
}

}  // namespace titop_bench
