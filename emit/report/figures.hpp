#pragma once

#include <optional>
#include <string>
#include <titop/analysis/control/margins.hpp>
#include <titop/analysis/shapes/mode_shapes.hpp>
#include <titop/emit/report/pairs.hpp>
#include <titop/emit/report/plot.hpp>
#include <titop/emit/report/plots.hpp>
#include <titop/emit/report/sweep.hpp>
#include <vector>

/// The figures of the section on responses: HTML, and one by one.
namespace titop::report {

/// Gains from vectors of inputs to vectors of outputs; empty if all are scalars or zero.
std::string singular_value_plots(const Sweep& sweep, const std::vector<UnitGroup>& outputs,
                                 const std::vector<UnitGroup>& inputs);

std::string bode_plots(const Subject& subject, const Sweep& sweep,
                       const std::vector<IoPair>& pairs);

/// Responses to unit steps, by `simulate`.
std::string step_plots(const Subject& subject, const std::vector<IoPair>& pairs);

/// One figure of these pairs, which share it (by_figure); of all singular values, none if all are
/// zero.
Plot bode_plot(const Subject& subject, const Sweep& sweep, const std::vector<IoPair>& pairs);
Plot step_plot(const Subject& subject, const std::vector<IoPair>& pairs);
/// L of each loop point with the others closed, at these frequencies [rad/s].
Plot nyquist_plot(const ControlLoop& loop, const Margins& margins,
                  const std::vector<double>& omega);
std::optional<Plot> sigma_plot(const Sweep& sweep, const std::vector<UnitGroup>& outputs,
                               const std::vector<UnitGroup>& inputs);
/// One of the modes, by its place in ModeShapes::modes. Throws bad_value for invalid options.
Plot mode_plot(const ModeShapes& shapes, std::size_t which, const ModePlotOptions& options);

}  // namespace titop::report
