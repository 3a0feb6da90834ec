#pragma once

#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/analysis/reduction/scene.hpp>

namespace titop {

/// The error of a model with finitely many modes against one with distributed bodies (ExactBeam),
/// over Scene::band_hz: for each pair of an input and an output the largest difference of the
/// transfers, divided by the largest magnitude of the exact one, on the ray of
/// Scene::damping_floor; pairs that are nearly 0 as in Scene. It is the error against the partial
/// differential equations, not against a finer mesh.
///
/// An estimate: between samples the phase of the poles turns by 1 rad at most, and the largest
/// sample is divided by cos(1 / 2). These poles are those of the finite model up to twice the band,
/// each counted twice (for the pole of the exact one beside it), and ten more; the infinitely many
/// poles of the exact system are not computed. Accelerations of free bodies have a transfer at 0;
/// positions need a band that starts above 0. Each transfer is accurate to 1e-12.
///
/// Throws bad_value if the two have different inputs or outputs, or for a band, accuracy or damping
/// floor out of range; not_rational if `finite` has distributed bodies; the errors of transfer.
/// Cost: the poles of the finite model, O(n^3), and some hundred transfers of both.
///
///     const ErrorBound e = compare(compile(arm(8)), compile(arm_exact()), {.band_hz = {0, 50}});
ErrorBound compare(const System& finite, const System& exact, const Scene& scene);

/// The same for a reduced model, over the band of its scene. `exact` has the scene's inputs and
/// outputs.
ErrorBound compare(const ReducedSystem& reduced, const System& exact);

}  // namespace titop
