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
/// and not against a mesh. The first mesh of a beam is that for which a bending wave at the band's
/// upper end has half the accuracy as its relative error, (k h)^4 / 720, with the modes up to twice
/// that frequency; both numbers grow by 1.5 until the error by `compare` is at most half the
/// accuracy. The scene is then reduced as by compile(diagram, scene), and compared again. Beams of
/// a FlexibleBody keep their mesh.
///
/// Throws the errors of compile(diagram, scene) and `compare`; bad_value, with the error reached,
/// if 200 elements a beam do not suffice. Cost: some compiles and reductions.
ReducedBeams reduce_beams(const Diagram& diagram, const Scene& scene, const Options& options = {});

/// One line per beam, then the error.
std::string to_string(const ReducedBeams& reduced);

}  // namespace titop
