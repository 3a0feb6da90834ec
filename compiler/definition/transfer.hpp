#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/graph/graph.hpp>

namespace titop {

/// Definition of a graph's transfer: its matrix at one complex s, from all its equations at once.
///
/// Unknowns are all states and all port signals; rows are `(s I - A) x = B u` and `y = C x + D u`
/// of every block, and the user's equations. Per channel, with S the directions in which the
/// acceleration is driven and N their orthogonal complement:
///
///     S accel = right-hand sides,     N (force - all force equations and `+=` terms) = 0
///
/// Dense and without any compiler pass: the oracle that every pass is compared with.
///
/// @param s       Laplace variable [rad/s], no pole of the graph.
/// @param values  parameter values; nominal ones if empty.
/// @returns       outputs x inputs, in the graph's order.
/// @throws Error  singular, if the equations do not determine the outputs at s; no_equation, if
///                they are too few, two_equations, if they are too many; size, if terms do not fit;
///                mistakes in names and parameters that the graph has noted.
/// Cost O(n^3) in the number of signals: for tests and small graphs.
Eigen::MatrixXcd transfer(const Graph& graph, std::complex<double> s, ParameterValues values = {});

}  // namespace titop
