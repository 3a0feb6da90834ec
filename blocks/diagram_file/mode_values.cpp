#include <titop/blocks/diagram_file/mode_values.hpp>

namespace titop::diagram_file {
namespace {

/// Values of some modes, by their numbers.
Json modes_json(const std::map<int, Value>& modes, const WriteValue& value) {
  Json result = Json::array();
  for (const auto& [mode, of] : modes) result.push_back({{"mode", mode}, {"value", value(of)}});
  return result;
}

std::map<int, Value> read_modes(const JsonPlace& p, const char* key, const ReadValue& value) {
  std::map<int, Value> modes;
  if (!p.has(key)) return modes;
  const JsonPlace list = p.at(key);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonPlace item = list.item(i);
    item.only({"mode", "value"});
    if (!modes.emplace(item.at("mode").integer(), value(item.at("value"))).second)
      item.at("mode").refuse("a mode that no value before is for");
  }
  return modes;
}

/// Entries of L_P, or of the Phi_C of a child.
Json entries_json(const std::vector<ModeValues::Entry>& entries, const WriteValue& value) {
  Json result = Json::array();
  for (const ModeValues::Entry& e : entries)
    result.push_back({{"mode", e.mode}, {"component", e.component}, {"value", value(e.value)}});
  return result;
}

std::vector<ModeValues::Entry> read_entries(const JsonPlace& list, const ReadValue& value) {
  std::vector<ModeValues::Entry> entries;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonPlace item = list.item(i);
    item.only({"mode", "component", "value"});
    entries.push_back(
        {item.at("mode").integer(), item.at("component").integer(), value(item.at("value"))});
  }
  return entries;
}

/// By child.
Json shapes_json(const ModeValues& values, const WriteValue& value) {
  Json result = Json::array();
  for (const auto& [child, entries] : values.Phi_C)
    result.push_back({{"child", child}, {"entries", entries_json(entries, value)}});
  return result;
}

}  // namespace

void write_mode_values(const ModeValues& values, const WriteValue& value, Json& j) {
  if (!values.omega.empty()) j["omega"] = modes_json(values.omega, value);
  if (!values.xi.empty()) j["xi"] = modes_json(values.xi, value);
  if (!values.L_P.empty()) j["L_P"] = entries_json(values.L_P, value);
  if (!values.Phi_C.empty()) j["Phi_C"] = shapes_json(values, value);
}

ModeValues read_mode_values(const JsonPlace& p, const ReadValue& value) {
  ModeValues values{.omega = read_modes(p, "omega", value), .xi = read_modes(p, "xi", value)};
  if (p.has("L_P")) values.L_P = read_entries(p.at("L_P"), value);
  if (!p.has("Phi_C")) return values;
  const JsonPlace list = p.at("Phi_C");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonPlace item = list.item(i);
    item.only({"child", "entries"});
    if (!values.Phi_C.emplace(item.at("child").text(), read_entries(item.at("entries"), value))
             .second)
      item.at("child").refuse("a child that no entries before are for");
  }
  return values;
}

}  // namespace titop::diagram_file
