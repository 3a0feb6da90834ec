#pragma once

#include <map>
#include <titop/compiler/passes/stage.hpp>

namespace titop::passes {

/// Pairs for the rates and positions that are read beyond an opened rotation or gain
/// (compiler/passes/open): in the equation of the acceleration R u + G w of a point, the rate is R
/// (rate of u) + G w', with w' an input of its own and z' as z, of rates in place of accelerations.
/// Likewise beyond a point of a body whose place is opened (Kinematics::opened). Only for those
/// that the terms of the graph read. Nothing if no parameter is opened.
void open_motions(Stage& stage, Graph& graph);

/// The signal of the input w' of the rate (or position) that belongs to this w; -1 if there is
/// none.
int opened_motion(const Graph& graph, int w, bool position);

/// The motions of `Kinematics::opened` by the port that has their w, in the order of its entries:
/// w' has an entry for each of them.
std::map<int, std::vector<const OpenedMotion*>> opened_ports_of(const Kinematics& kinematics);

/// The input w that drives this one-way input port of an opened node.
int opened_input(const Graph& graph, const Node& node, int port);

}  // namespace titop::passes
