#pragma once

#include <string>
#include <titop/graph/diagram.hpp>

/// The diagrams that bench/ times, each at any size. Random numbers come from a fixed seed.
namespace titop::generate {

enum class Case {
  A,   ///< chain of spring-masses on the ground
  BL,  ///< the same with each mass split between its two sides: a loop at every junction
  C,   ///< random tree of spring-masses on the ground
  D,   ///< chain of flexible bodies (6 modes), random rotations, free root
  F,   ///< [Alazard 2015] Fig. 17: one hub with n flexible appendages
  K,   ///< chain of flexible bodies with a hinge and a controller at every joint, free root
  T,   ///< balanced binary tree of flexible bodies, free root
  CB,  ///< comb: a chain of flexible bodies, one more at every joint of it, free root
  R,   ///< ring of flexible bodies, closed on itself, free (n >= 3)
  G,   ///< planar grid: n rigid nodes (rounded to a square), beams between neighbours, free
  SG,  ///< planar grid of n masses (rounded to a square), each on a spring on the ground and with
       ///< springs to its neighbours, which read positions
  SL,  ///< two rows of n/2 spring-masses on the ground, springs from mass to mass read positions
};

/// "A", "BL", ...
std::string name_of(Case c);
Case case_of(const std::string& name);

/// Use of the parameter "p": masses (A, BL, C, SG, SL) or mounting angles (D, F, K, T, CB).
enum class Varies {
  nothing,  ///< there is no parameter
  one,      ///< that of body n/2
  all,      ///< those of all bodies
};

struct CaseOptions {
  double ratio = 1;  ///< bodies are scaled by it and by 1/it in turn (A to D and K)
  Varies varies = Varies::nothing;
  double p = 1;  ///< nominal value of the parameter
};

/// The diagram of case c with n bodies (F: appendages). From the force at the last mass (A, BL, C,
/// SL; SG: at the first) or the wrench at the root (R: at the first joint) to the acceleration of
/// the last body (R: half way round). R and G have no parameter; R, G, SG and SL have no ratio.
Diagram case_diagram(Case c, int n, const CaseOptions& options = {});

}  // namespace titop::generate
