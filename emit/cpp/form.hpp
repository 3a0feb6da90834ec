#pragma once

#include <Eigen/Core>
#include <complex>
#include <titop/analysis/certify/faults.hpp>
#include <titop/compiler/system/system.hpp>
#include <vector>

/// Coordinates in which generated code computes, and their accuracy.
namespace titop::emit {

/// The model's matrices in its own states, or in modes: x = to_states z, z = from_states x, with A
/// in 1 x 1 and 2 x 2 blocks along its diagonal.
struct ModelForm {
  bool modal = false;
  Eigen::MatrixXd A, B, C, D;
  Eigen::MatrixXd A_h, B_h;                 ///< held over a sample time; empty without one
  Eigen::MatrixXd to_states, from_states;   ///< n x n; empty unless modal
  double error = 0;                         ///< of its transfer, see response_error
  double static_error = 0, step_error = 0;  ///< of its static gain, of its trajectory
};

/// Largest accepted error of a model, or of a check of it: tolerances are 1e-6 at most,
/// and another machine may round a little worse.
constexpr double kProvable = certification::kDenseHolds;
/// Of the terms that cancel in an entry of a transfer: a smaller difference is none.
constexpr double kOfCancelled = 1e-6;
inline bool is_provable(double error) { return error <= kProvable; }

/// Points of comparison, and the factored system's transfers there.
struct Points {
  std::vector<std::complex<double>> s;
  std::vector<Eigen::MatrixXcd> exact;
  /// Outputs and inputs whose transfer is at rounding level at all points (checked in 50 digits):
  /// exact zeros, without a scale for a comparison.
  std::vector<Eigen::Index> silent_outputs, silent_inputs;
};

/// Eight points near the poles (damping 0.1), from below the slowest to above the fastest. One of
/// them is also evaluated in 50 digits; all, if a row or a column is lost in rounding there.
Points response_points(const System& system, const std::vector<Pole>& poles);

/// C X + D against the exact transfer at one point, without the silent rows and columns. Each entry
/// is relative to the geometric mean of the largest entries of its row and column, or, if larger
/// (zero by symmetry), to kOfCancelled of the terms that cancel in it, |C| |X| + |D|.
struct TransferDifference {
  double worst = 0;
  double rounding = 0;  ///< possible difference by rounding of the terms on another machine
};
TransferDifference difference(const ModelForm& form, const Eigen::MatrixXcd& X,
                              const Eigen::MatrixXcd& exact, const Points& points);

/// The worst difference of C (s - A)^-1 B + D over all points; HUGE_VAL if s - A is singular in
/// double.
double response_error(const ModelForm& form, const Points& points);
/// The points' silent outputs and inputs, and those that are 0 by nature at rest, such as rates.
Points at_rest(const Points& points, const Eigen::MatrixXd& static_gain);

/// The difference at s = 0, without rows and columns that are silent at rest.
double static_error(const ModelForm& form, const Eigen::MatrixXd& exact, const Points& points);

/// The same for a trajectory: largest difference of y(k) from x(0) = 0 to `exact` (ny x steps),
/// each output relative to the largest |C| |x| + |D| |u| that it had.
double step_error(const ModelForm& form, const Eigen::MatrixXd& inputs,
                  const Eigen::MatrixXd& exact, const Points& points);

/// Worst `off` relative to `size`, by outputs, without the silent.
double worst_output(const Eigen::VectorXd& off, const Eigen::VectorXd& size, const Points& points);

/// Inputs of the trajectory, nu x steps: numbers from -1 to 1 without rounding.
Eigen::MatrixXd trajectory_inputs(Eigen::Index inputs, Eigen::Index steps);

/// The matrices unchanged.
ModelForm own_form(const StateSpace& model);

/// Modes of the second-order form if damping is proportional, of A otherwise. Its error determines
/// whether it may be used: it is large if A is defective (free rigid motion and modes).
ModelForm modal_form(const StateSpace& model);

/// Adds A_h, B_h.
void add_hold(ModelForm& form, double sample_time);

}  // namespace titop::emit
