#pragma once

#include <array>
#include <string>
#include <titop/compiler/system.hpp>
#include <vector>

namespace titop {

/// What an error bound is worth.
enum class BoundKind {
  estimate,  ///< poles up to twice the band's upper end count one by one, the rest as ten more
  theorem    ///< every pole of both models counts: up to rounding no peak can hide between samples
};

/// The question: from these inputs to these outputs, over this band, this well.
///
/// The error of a pair (input, output) is the largest difference of the transfer over the band,
/// over the largest magnitude of the pair itself there. Pairs that are nearly zero, by symmetry
/// say, are compared with 1e-6 of what they would be if input and output saw all modes alike: units
/// cancel. Both are taken on the ray s = (zeta + j sqrt(1 - zeta^2)) omega, zeta the damping floor,
/// since an undamped peak has no finite height; there a mode looks as it would with damping zeta
/// more.
struct Scene {
  /// "W", or one of its scalars, "W(3)"; empty: all. The order is the diagram's, whatever the order
  /// here. Inputs that are left out are held at 0: an acceleration that is prescribed by one locks
  /// its point or its joint.
  std::vector<std::string> inputs = {};
  std::vector<std::string> outputs = {};  ///< likewise, in the diagram's order
  /// Lower and upper end [Hz]; {0, 0}: static gain only. From 0 on only what has a gain there:
  /// positions and rates of motions without stiffness (free bodies, free hinges) are refused.
  std::array<double, 2> band_hz = {0, 0};
  /// Largest error of any pair, between 2e-12 and 1. Rounding ends above 1e-12, and on resonances
  /// above 4e-16 over their damping on the ray.
  double accuracy = 1e-3;
  double damping_floor = 0.002;  ///< zeta, between 1e-6 and 0.5
  /// A theorem costs many times the samples, and where damping couples modes one eigenproblem of
  /// O(8 n^3) for their poles.
  BoundKind bound = BoundKind::estimate;
  /// Up to this many coordinates the whole is reduced, by one symmetric eigenproblem of O(n^3). Of
  /// more, bodies lose modes first, those that do least to the assembled transfer; static vectors
  /// of their loaded ports take their place. What that costs is measured, and the bound is an
  /// estimate, checked against the full system as always. Refused where too many are left.
  int whole_up_to = 2000;
  /// Passive structures stay M, D, K. False: their states are balanced as where there is no such
  /// form; where damping is heavy fewer may do.
  bool keep_structure = true;
  /// Up to this many states are balanced, at O(100 n^3); of more, bodies lose modes first.
  int balance_up_to = 800;
};

namespace detail {

/// Throws bad_value for a band, accuracy or damping floor out of range, all together.
void check(const Scene& scene);

/// The graph with these inputs and outputs only; single scalars become inputs and outputs of their
/// own. Throws unknown_name with the names there are. O(graph).
Graph restricted(const Graph& graph, const Scene& scene);

}  // namespace detail
}  // namespace titop
