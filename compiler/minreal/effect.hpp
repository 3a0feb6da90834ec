#pragma once

#include <complex>
#include <titop/compiler/minreal/minimize.hpp>
#include <vector>

/// Measures the effect of removed modes on the transfer.
namespace titop::minreal {

/// `minimize` (compiler/minreal/minimize.hpp) except for the measurement, for callers that measure
/// against more than the model.
Minimized minimize_unmeasured(const StateSpace& model, const MinimizeOptions& options);

/// Points at which removed modes would be missed first: near the slowest, a middle and the fastest
/// of them, and the most visible one; for integrators, at `s` and far below.
std::vector<std::complex<double>> near_modes(std::vector<JudgedMode> modes, std::complex<double> s);

/// Measures the change of the transfer from `whole`, entry by entry
/// (compiler/definition/compare.hpp).
void measure_change(const StateSpace& whole, Minimized& m);

/// If the removal changed the transfer by more than 1e-8 and ten times the resolution, all modes
/// are restored: true, with the verdict and then the reason as notes. A mode of visibility v
/// changes the transfer by up to 10 v at the points of `near_modes`: if some modes judged
/// negligible changed it more, no lower end of the order is certain, and the verdict keeps the
/// measured change, although nothing is removed: the full certificate calls it a fault. `lost` is
/// the error of the smaller model, also by more cancellation than in `whole` (nearly equal poles
/// whose modes are nearly parallel): an error as large as that also restores all.
bool put_back(const StateSpace& whole, double resolution, double lost, Minimized& m);

}  // namespace titop::minreal
