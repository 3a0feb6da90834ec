#pragma once

#include <complex>
#include <titop/compiler/minimize.hpp>
#include <vector>

/// What leaves a model is measured on its transfer: nothing is removed on trust.
namespace titop::modes {

/// `minimize` (compiler/minimize.hpp) but for the measurement, for those who measure against more
/// than the model.
Minimized minimize_unmeasured(const StateSpace& model, const MinimizeOptions& options);

/// Where modes that leave would be missed first: beside the slowest, a middle and the fastest of
/// them, and the most visible one; for integrators, at `s` and far below.
std::vector<std::complex<double>> near_modes(std::vector<JudgedMode> modes, std::complex<double> s);

/// Measures the change of the transfer from `whole`, entry by entry (compiler/compare.hpp).
void measure_change(const StateSpace& whole, Minimized& m);

/// If what left changed the transfer by more than 1e-8 and ten times the resolution, everything
/// stays after all: true, with the verdict and then the reason as notes. A mode of visibility v
/// changes the transfer by up to 10 v at the points of `near_modes`: where some that were judged
/// not to matter did more, no lower end of the order is certain, and the verdict keeps the change
/// that was measured, although nothing is removed: the full certificate calls it a fault. `lost` is
/// what the smaller model gets wrong, also by cancelling more than `whole` does (nearly equal poles
/// whose modes are nearly parallel): as much as that is reason enough for all to stay.
bool put_back(const StateSpace& whole, double resolution, double lost, Minimized& m);

}  // namespace titop::modes
