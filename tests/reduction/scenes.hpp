#pragma once

#include <doctest/doctest.h>

#include <titop/titop.hpp>

#include "../../examples/scenes/frame.hpp"
#include "tree.hpp"

/// Scenes of the tests of model reduction, and measurements on them.
namespace titop_test {

using titop::Diagram;
using titop::ReducedSystem;

/// An aluminium beam of 2 m with 6 * elements modes.
inline titop::FlexibleBody slim_beam(int elements = 8, double xi = 0) {
  titop::Beam beam{.length = 2,
                   .section = titop::rectangle(0.06, 0.04),
                   .material = {.E = 70e9, .nu = 0.33, .rho = 2700},
                   .elements = elements};
  if (xi > 0) beam.modes.xi = {xi};
  return beam;
}

using scenes::frame;

/// The frame by hand: its tree, driven and read at the tip.
inline Assembled frame_by_hand(const titop::ModalData& beam) {
  Tree tree(false);
  const int b1 = tree.add(beam);
  const int b2 = tree.add(beam, b1, 0, titop::Rotation::about({1, 2, 3}, 0.7).nominal());
  const int b3 = tree.add(beam, b2, 0, titop::Rotation::about({3, -1, 1}, -1.1).nominal());
  const MatrixXl tip = tree.motion(b3, 0);
  return tree.structure(tip, tip);
}
inline Truth frame_by_hand(const titop::FlexibleBody& beam) {
  return truth_of(frame_by_hand(beam.data()));
}

/// Required of every reduced system, with peaks and errors from the reference. Largest errors over
/// true peaks stay below the accuracy, too, since no sample is above the true peak.
inline Beside check_beside(const ReducedSystem& r, const titop::Scene& scene, const Truth& truth,
                           int steps = 0) {
  const Beside by_hand = beside(r, scene, truth, steps);
  CHECK(r.bound().worst <= scene.accuracy);
  CHECK(by_hand.bound <= 1);
  CHECK(by_hand.error <= 1.01 * scene.accuracy);
  CHECK(by_hand.peak_low >= 0.87);  // the phase grid promises cos(1 / 2) = 0.877
  CHECK(by_hand.peak_high <= 1.01);
  return by_hand;
}

}  // namespace titop_test
