#pragma once

#include <array>
#include <string>
#include <titop/compiler/system/system.hpp>
#include <vector>

namespace titop {

/// Kind of an error bound.
enum class BoundKind {
  estimate,  ///< samples are spaced for the poles up to twice the band's upper end and ten more
  theorem    ///< spaced for every pole of both models: up to rounding no peak is between samples
};

/// Requirements on a reduced model: inputs, outputs, band and accuracy.
///
/// The error of a pair (input, output) is the largest difference of the transfer over the band,
/// over the largest magnitude of the pair itself there. Pairs that are nearly zero, as by
/// symmetry, are scaled by 1e-6 of the size that they would have if input and output were coupled
/// equally to all modes, independent of units. A pair below 1e-12 of its port's largest at every
/// frequency is rounding of a 0: outputs of very different size need ports of their own. Both are
/// taken on the ray s = (zeta + j sqrt(1 - zeta^2)) omega, zeta the damping floor, since an
/// undamped peak has no finite height; on it every mode has the additional damping zeta.
struct Scene {
  /// "W", or one of its scalars, "W(3)"; empty: all. The order is the diagram's, not the order
  /// here. Other inputs are held at 0: a point or joint whose acceleration is one of them is
  /// locked.
  std::vector<std::string> inputs = {};
  std::vector<std::string> outputs = {};  ///< likewise, in the diagram's order
  /// Lower and upper end [Hz]; {0, 0}: static gain only. A band from 0 requires a gain at 0:
  /// positions and rates of motions without stiffness (free bodies, free hinges) are refused.
  std::array<double, 2> band_hz = {0, 0};
  /// Largest error of any pair, between 2e-12 and 1. The limits by rounding are 1e-12 and, on
  /// resonances, 4e-16 over their damping on the ray.
  double accuracy = 1e-3;
  double damping_floor = 0.002;  ///< zeta, between 1e-6 and 0.5
  /// BoundKind::theorem takes many times the samples and, if damping couples modes, one
  /// eigenproblem of O(8 n^3) for their poles.
  BoundKind bound = BoundKind::estimate;
  /// Up to this many coordinates the assembled model is reduced, by one symmetric eigenproblem of
  /// O(n^3). In larger models bodies, and Lti of modal blocks, lose modes first, those with the
  /// least effect on the assembled transfer; static vectors of their loaded ports replace these.
  /// The error is measured, and the bound is an estimate, checked against the full system as
  /// always. Refused if too many remain.
  int whole_up_to = 2000;
  /// Passive structures keep M, D, K, unless these would have more states than the minimal model
  /// (checked up to Options::minimize_up_to states). False: their
  /// states are balanced, which may need fewer states at heavy damping.
  bool keep_structure = true;
  /// Largest number of states that are balanced, at O(100 n^3); in larger models bodies, and Lti of
  /// modal blocks, lose modes first.
  int balance_up_to = 800;
};

namespace detail {

/// Throws bad_value for a band, accuracy or damping floor out of range, all together.
void check(const Scene& scene);

/// The graph with these inputs and outputs only; single scalars become inputs and outputs of their
/// own. Throws unknown_name with the valid names. O(graph).
Graph restricted(const Graph& graph, const Scene& scene);

}  // namespace detail
}  // namespace titop
