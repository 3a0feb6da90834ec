#pragma once

#include <complex>
#include <span>
#include <string>
#include <titop/compiler/system/system.hpp>
#include <vector>

/// Frequency responses in dB and degrees, and inputs, by names.
namespace titop {

/// 20 log10 of a gain.
double decibels(double gain);
/// An angle in degrees.
double degrees(double radians);

/// 20 log10 |G| of each value; minus infinity of 0.
std::vector<double> decibels(std::span<const std::complex<double>> values);

/// The angles of a response over ascending frequencies [deg], without jumps: each within 180 of the
/// one before, the first in (-270, 90]. Where it turns by 180 at once (an undamped mode), to the
/// angle that is nearer to -90, and from -90 to 90. Not a number for 0 and for values that are not
/// finite.
std::vector<double> degrees(std::span<const std::complex<double>> values);

/// One response over frequencies.
struct BodeResponse {
  std::vector<double> omega;  ///< [rad/s]
  std::vector<double> decibels, degrees;
};

/// The response of one output to one input by their names, "angle(3)", "T(3)", over ascending
/// frequencies [rad/s], of System::frequency_response. Throws unknown_name, and singular for a
/// frequency on an undamped pole. O(bodies) per frequency.
///
///     const BodeResponse r = bode(system, "angle", "T(3)", omega);
BodeResponse bode(const System& system, const std::string& output, const std::string& input,
                  std::span<const double> omega);

/// The input vector with these values in the order of System::inputs(), 0 elsewhere, for `apply`
/// and for `simulate`. Throws unknown_name with the valid names, duplicate_name for one given
/// twice.
///
///     simulate(system, Excitation::step(input_values(system, {{"T(3)", 0.1}})), {...});
Eigen::VectorXd input_values(const System& system, const ParameterList& values);

}  // namespace titop
