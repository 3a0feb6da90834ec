#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <titop/graph/graph.hpp>
#include <utility>
#include <vector>

/// Springs and dampers written as equations: `h.torque = k * h.angle + c * h.rate`.
namespace titop::passes {

/// gain * the position (or rate) of a channel.
struct OfMotion {
  Term::Of of;  ///< position or rate
  int channel;
  Eigen::MatrixXd gain;
};

/// A term as a sum of such: of a port's position or rate, or of a one-way output that is the
/// position or rate of points whose accelerations its block takes (a joint's angle, a bushing's
/// displacement; by its matrices). Empty if it is anything else.
std::vector<OfMotion> of_motions(const Graph& graph, const Term& term, ParameterValues values);

/// Gains from motions to forces, by the channels (force, motion), in the signs of work: of the
/// wrench that works against the structure.
using ForceGains = std::map<std::pair<int, int>, Eigen::MatrixXd>;

/// Checks that forces by positions and rates are those of springs, dampers and gyroscopes: the
/// gains from all positions to all forces, in the signs of work, are symmetric and positive
/// semidefinite, and so is the symmetric part of those from rates. To 1e-12 of their diagonal, in
/// all units. Empty if they are, else the first force of those that are not. O(terms), and m^3 for
/// m degrees of freedom that such springs tie together.
std::string why_no_springs(const Graph& graph, ParameterValues values);

/// Gains from rates to forces. O(terms).
ForceGains rate_gains(const Graph& graph, ParameterValues values);

/// The antisymmetric part of the gains from rates to forces: gyroscopic terms, which do no work.
/// Empty if there is none, beyond 1e-12 of the gains. O(terms).
ForceGains gyroscopic_gains(const Graph& graph, ParameterValues values);

/// The ports with gyroscopic terms, "w1.parent", and the momentum there [N m s]; 0 if the terms are
/// not torques by angular rates of the same port. O(terms).
std::vector<std::pair<std::string, double>> gyroscopic_points(const Graph& graph,
                                                              ParameterValues values);
/// "40 N m s at w1.parent, ...".
std::string momenta_text(const std::vector<std::pair<std::string, double>>& gyroscopic_points);

}  // namespace titop::passes
