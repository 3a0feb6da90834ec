#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <titop/analysis/control/loop.hpp>
#include <titop/compiler/system/system.hpp>

/// Plots one by one, as SVG files by themselves, drawn as those of the report.
namespace titop {

/// Options of the plots.
struct PlotOptions {
  std::string title = {};                  ///< empty: the names of the signals
  std::array<double, 2> band_hz = {0, 0};  ///< [Hz]; {0, 0}: by the poles
  double until = 0;                        ///< end of a step response [s]; 0: by the poles
};

/// Magnitude and phase of one output for one input, by their names. Throws unknown_name,
/// bad_value for an invalid band. O(bodies) per frequency, some 500 of them.
///
///     write_plot(plot_bode(system, "angle", "T(3)"), "bode.svg");
std::string plot_bode(const System& system, const std::string& output, const std::string& input,
                      const PlotOptions& options = {});

/// Response of one output to a unit step of one input, by `simulate` and with its errors. Throws
/// unknown_name, bad_value for an invalid end.
std::string plot_step(const System& system, const std::string& output, const std::string& input,
                      const PlotOptions& options = {});

/// Singular values of the whole transfer. Throws bad_value if it is 0.
std::string plot_sigma(const System& system, const PlotOptions& options = {});

/// L(j omega) of each loop point with the others closed, the point -1 and the unit circle, in the
/// square from -3 to 3; the curve leaves it where L is large. The caption gives the nearest point
/// to -1, or that the loop is not stable. Cost: that of `margins`.
std::string plot_nyquist(const ControlLoop& loop, const PlotOptions& options = {});

/// Poles (crosses) and transmission zeros (circles) of state_space() up to the band's highest
/// frequency. O(n^3).
std::string plot_poles(const System& system, const PlotOptions& options = {});

/// Options of plot_mode.
struct ModePlotOptions {
  std::string title = {};  ///< empty: the frequency
  /// Direction of the viewer, z being up [deg]: 0, 0 looks along -x, 0, 90 from above.
  double azimuth = -60, elevation = 30;
  double amplitude = 0.15;  ///< largest displacement as drawn, relative to the structure's size
};

/// The structure in a mode, given by its index in system.poles(): the ports of its bodies at rest
/// and displaced (`mode_shapes`), lines between the ports of each body. The caption has frequency,
/// damping, and the blocks without a position. Throws the errors of mode_shapes, and bad_value for
/// options that are not finite or an amplitude that is not positive. Cost: that of mode_shapes.
std::string plot_mode(const System& system, int pole, const ModePlotOptions& options = {});

/// Writes a plot to a file. Throws bad_file.
void write_plot(const std::string& svg, const std::filesystem::path& file);

}  // namespace titop
