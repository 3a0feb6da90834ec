#pragma once

#include <titop/compiler/passes/stage.hpp>

namespace titop::passes {

/// Pairs for the rates and positions that are read beyond an opened rotation or gain
/// (compiler/passes/open): in the equation of the acceleration R u + G w of a point, the rate is R
/// (rate of u) + G w', with w' an input of its own and z' as z, of rates in place of accelerations.
/// Only for those that the terms of the graph read. Nothing if no parameter is opened.
void open_motions(Stage& stage, Graph& graph);

/// The signal of the input w' of the rate (or position) that belongs to this w; -1 if there is
/// none.
int opened_motion(const Graph& graph, int w, bool position);

}  // namespace titop::passes
