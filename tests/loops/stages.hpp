#pragma once

// Stages after some passes.

#include <titop/compiler/passes/passes.hpp>
#include <titop/titop.hpp>

namespace loops_test {

using namespace titop;

inline Stage until_chains(const Diagram& d) {
  Stage stage = as_written(d.graph());
  for (const auto pass : {passes::check, passes::lower, passes::split, passes::chains})
    stage = pass(std::move(stage));
  return stage;
}

inline Stage until_close(const Diagram& d) {
  Stage stage = until_chains(d);
  for (const auto pass : {passes::match, passes::order, passes::close})
    stage = pass(std::move(stage));
  return stage;
}

/// Entries of the map from the states that stay.
inline double entries(const Diagram& diagram) {
  double count = 0;
  for (const Dependent& d : until_close(diagram).dependents)
    count += static_cast<double>(d.of.size());
  return count;
}

}  // namespace loops_test
