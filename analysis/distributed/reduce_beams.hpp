#pragma once

#include <string>
#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/analysis/reduction/scene.hpp>
#include <vector>

namespace titop {

/// The finite body chosen for an ExactBeam.
struct FiniteBeam {
  std::string name;   ///< of its node
  int elements = 0;   ///< of equal length
  int modes = 0;      ///< kept, clamped at P
  int residuals = 0;  ///< residual vectors of C and P beside them; 0 if all modes are kept
};

/// A reduced model of a scene with distributed beams.
struct ReducedBeams {
  ReducedSystem system;           ///< system.full() has the beams of this list
  std::vector<FiniteBeam> beams;  ///< in the order of the diagram
  /// Of `system` against the distributed beams, over the band (compare): an estimate, at most
  /// Scene::accuracy. system.bound() is the part of the reduction alone.
  ErrorBound error;
  ErrorBound of_beams;  ///< of system.full(), before the reduction, likewise
};

/// The reduced model of a scene whose beams are distributed (ExactBeam), with as many elements and
/// modes of each beam as the accuracy needs, measured against the partial differential equations
/// and not against a mesh. A beam begins with the elements of which a bending wave at the band's
/// upper end has the relative error of a quarter of the accuracy, (k h)^4 / 720, and with its modes
/// up to twice that end; both are multiplied by 1.5 until `compare` finds no more than that
/// quarter. The scene is then reduced as by compile(diagram, scene), and modes and vectors that
/// later ones have made needless are removed. The result is compared again: first with the whole
/// accuracy left to the reduction, then, if both errors add, with the rest of it. The order is
/// within 1.3 of the least that a search finds, with the same reserve between samples, in each of
/// 300 random scenes (tests/long/distributed.cpp).
///
/// Throws the errors of compile(diagram, scene) and `compare`; bad_value for a diagram without a
/// distributed beam, and if the accuracy is not reached with 200 elements a beam, with the error
/// that is and the beams. Beams without a counterpart here are those of FlexibleBody: they keep
/// their own mesh. Cost: some compiles and reductions.
ReducedBeams reduce_beams(const Diagram& diagram, const Scene& scene, const Options& options = {});

/// One line per beam, then the error.
std::string to_string(const ReducedBeams& reduced);

}  // namespace titop
