#pragma once

#include <string>
#include <titop/blocks/flexible_body.hpp>
#include <vector>

#include "generate/draws.hpp"

namespace titop::generate {

/// Modal data that some body could have: D_P of a rigid body, modes that carry at most 64 % of it,
/// frequencies between 1 and 128 rad/s, random Phi. Damping ratios 0 or about 0.01.
ModalData random_modes(Rng& rng, int modes, const std::vector<std::string>& children, bool damped);

struct ClusterOptions {
  int modes = 120;
  int points = 2;        ///< "C1", "C2", ..., with Phi_C in [-0.1, 0.1)
  double width = 0.02;   ///< of a cluster, relative to its centre
  bool carried = false;  ///< L_P in [-1, 1), else 0
};
/// Clamped modes in clusters of ten, every 0.8 Hz from 1 Hz on, damping 0.5 %.
ModalData clustered_modes(const ClusterOptions& options);

}  // namespace titop::generate
