#pragma once

#include <titop/titop.hpp>

#include "../by_hand/by_hand.hpp"

namespace scenes {

/// The satellite without a law, as M, D and K. Coordinates [P; theta; eta1; eta2], the first six
/// without stiffness: kinetic energy of hub and booms, a boom's own coordinates being the motion of
/// its root and its modes. Inputs W and tau_m, outputs as the diagram's: positions, of which the
/// first 18 are output as accelerations (times s^2).
by_hand::Structure satellite_by_hand(const titop::ModalData& boom);

}  // namespace scenes
