#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/emit/report/subject.hpp>

namespace titop::report {
namespace {

std::string names(const std::vector<ScalarSignal>& list) {
  std::string text;
  for (std::size_t i = 0; i < list.size() && i < 20; ++i) text += (i ? ", " : "") + list[i].name;
  return list.empty() ? "none" : list.size() > 20 ? text + ", ..." : text;
}

/// Gives the unit to the scalars of this name; false if there are none.
bool set_unit(std::vector<ScalarSignal>& list, const std::string& name, const std::string& unit) {
  bool found = false;
  for (ScalarSignal& s : list)
    if (s.name == name || s.signal == name) s.unit = unit, found = true;
  return found;
}

void check_numbers(const ReportOptions& o) {
  const auto [low, high] = o.band_hz;
  const bool by_poles = low == 0 && high == 0;
  if (!by_poles && !(low > 0 && high > low && std::isfinite(high)))
    throw Error(Code::bad_value, fmt::format("ReportOptions::band_hz is {} to {} Hz", low, high),
                "give 0 < lowest < highest, or {0, 0} for the band of the poles");
  if (!(o.until >= 0) || !std::isfinite(o.until))
    throw Error(Code::bad_value, fmt::format("ReportOptions::until is {} s", o.until),
                "give a positive time, or 0 for the time of the poles");
}

}  // namespace

Subject subject(const System& system, const ReportOptions& options) {
  check_numbers(options);
  Subject s{system, options, scalar_inputs(system.stage()), scalar_outputs(system.stage()), {}};
  for (const auto& [name, unit] : options.units) {
    const bool in = set_unit(s.inputs, name, unit), out = set_unit(s.outputs, name, unit);
    if (!in && !out)
      throw Error(Code::unknown_name,
                  fmt::format("ReportOptions::units: \"{}\" is no input or output", name),
                  fmt::format("inputs: {}; outputs: {}", names(s.inputs), names(s.outputs)));
  }
  s.poles = system.poles();
  return s;
}

std::vector<UnitGroup> groups(const std::vector<ScalarSignal>& scalars) {
  std::vector<UnitGroup> list;
  for (const ScalarSignal& s : scalars) {
    const bool joins = !list.empty() && list.back().signal == s.signal &&
                       list.back().unit == s.unit && list.back().at.size() < 3;
    if (!joins) list.push_back({s.signal, s.unit, {}});
    list.back().at.push_back(s.index);
  }
  return list;
}

std::string or_users(const std::string& unit) { return unit.empty() ? "user's unit" : unit; }

std::string ratio(const std::string& output_unit, const std::string& input_unit) {
  if (output_unit.empty() && input_unit.empty()) return "user's units";
  const bool product = input_unit.find(' ') != std::string::npos;
  return fmt::format("{} / {}{}{}", or_users(output_unit), product ? "(" : "", or_users(input_unit),
                     product ? ")" : "");
}

}  // namespace titop::report
