#pragma once

#include <titop/analysis/simulation/simulate.hpp>

/// The discrete law of Excitation::sampled in one simulation. For the library's own files.
namespace titop::detail {

/// States and outputs of the law from sample to sample; without a law the inputs are 0. It is
/// linear: for deviations of y it has the deviations of the inputs.
class HeldLaw {
 public:
  /// Throws unknown_name for inputs and outputs of the law that the system does not have,
  /// bad_value for a period that is not a whole number of steps.
  HeldLaw(const System& system, const Excitation& excitation, double step);
  /// A sample at the beginning of this step?
  bool samples_at(Eigen::Index step) const { return law_ && step % every_ == 0; }
  /// Takes the outputs of the system just before the sample; `inputs` are then those after it.
  void sample(const Eigen::VectorXd& y);
  /// Inputs of the system, until the next sample.
  const Eigen::VectorXd& inputs() const { return inputs_; }
  /// Adds them to both ends of a step, the second one if it is there; nothing without a law.
  void add_to(Excitation::Ends& ends) const;

 private:
  const StateSpace* law_ = nullptr;
  Eigen::Index every_ = 1;        ///< steps of a period
  std::vector<int> reads_ = {};   ///< per input of the law: output of the system
  std::vector<int> drives_ = {};  ///< per output of the law: input of the system
  Eigen::VectorXd x_;             ///< states of the law
  Eigen::VectorXd inputs_;
};

}  // namespace titop::detail
