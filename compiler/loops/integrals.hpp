#pragma once

#include <optional>
#include <titop/compiler/loops/lines.hpp>
#include <titop/compiler/loops/motion.hpp>

namespace titop::loops {

/// The displacement that an Integrator integrates: its output is the displacement's rate (level 1)
/// or the displacement itself (level 2).
struct Integral {
  int node = -1, level = 1;
  Form form;
};

/// All Integrators whose input has one level: accelerations (level 1), or rates and Integrators of
/// accelerations (level 2). A signal that is neither has the level of the other terms; an input of
/// mixed levels, or a position, is not listed and keeps its states.
std::vector<Integral> integrals(const Graph& graph, const Motion& motion, const SumExpander& sums,
                                const StateRates& coordinates, ParameterValues values);

}  // namespace titop::loops
