#pragma once

#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/analysis/reduction/scene.hpp>

namespace titop {

/// How far a model of finitely many modes is from one with distributed bodies (ExactBeam), over
/// Scene::band_hz: per pair of an input and an output the largest difference of the transfers over
/// the largest magnitude of the exact one, on the ray of Scene::damping_floor; pairs that are
/// nearly 0 as in Scene. This is the error against the partial differential equations, and not
/// against a finer mesh.
///
/// An estimate: the difference is sampled where the finite model's poles up to twice the band, each
/// counted twice for the exact one beside it, and ten more turn the phase by 1 at most, and the
/// largest sample is divided by cos(1 / 2). The exact system has infinitely many poles, none of
/// which is computed. Samples at 0 are taken at 1e-6 of the slowest pole. Each transfer is accurate
/// to 1e-12.
///
/// Throws bad_value if the two have other inputs or outputs, or none, for a band, accuracy or
/// damping floor out of range, and for a band from 0 if an output has no gain there (positions and
/// rates of free bodies); not_rational if `finite` has distributed bodies; the errors of transfer.
/// Cost: the poles of the finite model, O(n^3), and some hundred transfers of both.
///
///     const ErrorBound e = compare(compile(arm(8)), compile(arm_exact()), {.band_hz = {0, 50}});
ErrorBound compare(const System& finite, const System& exact, const Scene& scene);

/// The same of a reduced model, over the band of its scene. `exact` has the scene's inputs and
/// outputs.
ErrorBound compare(const ReducedSystem& reduced, const System& exact);

}  // namespace titop
