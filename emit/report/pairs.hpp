#pragma once

#include <string>
#include <titop/emit/report/sweep.hpp>
#include <vector>

/// Selection of responses and their grouping in figures.
namespace titop::report {

constexpr std::size_t kFigures = 12;  ///< of one kind; more are counted
constexpr std::size_t kCurves = 4;    ///< in one frame

/// For every pair of groups the entry with the highest peak over the sweep, if it is not zero to
/// rounding.
std::vector<IoPair> strongest(const Subject& subject, const Sweep& sweep,
                              const std::vector<UnitGroup>& outputs,
                              const std::vector<UnitGroup>& inputs);

/// Those of ReportOptions::pairs. Throws unknown_name with the names there are.
std::vector<IoPair> asked(const Subject& s, const std::vector<UnitGroup>& outputs,
                          const std::vector<UnitGroup>& inputs);

/// Pairs that share a figure: the same group of inputs, outputs of the same unit; as many in each
/// if they need several.
std::vector<std::vector<IoPair>> by_figure(const Subject& s, const std::vector<IoPair>& pairs);

/// A sentence on omitted figures, beyond kFigures; empty if there are none.
std::string left_out(std::size_t figures, const char* way_out);

}  // namespace titop::report
