#pragma once

#include <titop/titop.hpp>

/// Simulation of small models compared with the full system.
namespace titop_bench {

/// The small model as a controller or filter in a diagram: one block with the inputs and outputs of
/// `asked`, compiled.
titop::System in_its_place(const titop::ReducedSystem& small, const titop::Diagram& asked);

struct Run {
  double seconds = 0;  ///< processor time of all steps, start included
  double start = 0;    ///< processor time of the start
  titop::Trajectory trajectory;
};

/// 4000 steps (quick: 400), 200 to the period of the band's upper end, by the stepper that
/// `simulate` chooses. All inputs get the same pulse at once: a bell curve with 1e-12 of its
/// spectrum beyond the band, as a record at the steps, so that every rule has the same input.
/// Seconds are the least of three runs (quick: of one).
Run run(const titop::System& system, double band_hz, bool quick);

/// The same steps by the midpoint rule on a dense model, outputs x times: for comparison with a
/// large system, for which `simulate` chooses this rule; the remaining difference is the error of
/// the small model. (In `simulate` each step of that rule costs O(n^3) for a block of n states
/// without form.)
Eigen::MatrixXd by_midpoint(const titop::StateSpace& model, double band_hz, bool quick);

/// Largest difference of an output over its largest value in the second one.
double difference(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other);

}  // namespace titop_bench
