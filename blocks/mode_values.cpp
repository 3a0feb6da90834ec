#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <titop/blocks/mode_values.hpp>

namespace titop::detail {
namespace {

using Eigen::VectorXd;
using Entry = ModeValues::Entry;

void check_mode(int mode, Eigen::Index modes) {
  if (mode < 1 || mode > modes)
    throw Error(Code::bad_modes, fmt::format("a value is given for mode {} of {}", mode, modes),
                "modes count from 1, as in eta1");
}

/// The numbers of all modes with these values in place.
VectorXd replaced(VectorXd numbers, const std::map<int, Value>& values, const NumberOf& number) {
  for (const auto& [mode, value] : values) {
    check_mode(mode, numbers.size());
    numbers(mode - 1) = number(value);
  }
  return numbers;
}

/// Throws for an entry that the matrix does not have, or that is given twice. name: "L_P".
void check_entries(const std::vector<Entry>& entries, const std::string& name, Eigen::Index modes) {
  std::set<std::pair<int, int>> given;
  for (const Entry& e : entries) {
    check_mode(e.mode, modes);
    if (e.component < 1 || e.component > 6)
      throw Error(Code::bad_modes,
                  fmt::format("a value is given for component {} of {}", e.component, name),
                  "components count from 1 to 6: x, y, z, rx, ry, rz");
    if (!given.emplace(e.mode, e.component).second)
      throw Error(Code::bad_modes,
                  fmt::format("two values are given for mode {}, component {} of {}", e.mode,
                              e.component, name),
                  "give one value per entry");
  }
}

/// A child of the data by its name.
ModalChild& child_of(ModalData& data, const std::string& name) {
  const auto found = std::ranges::find(data.children, name, &ModalChild::name);
  if (found != data.children.end()) return *found;
  std::string names;
  for (const ModalChild& c : data.children) names += (names.empty() ? "" : ", ") + c.name;
  throw Error(Code::unknown_name,
              fmt::format("values are given for Phi_C of {}, which is no child", name),
              names.empty() ? "this body has no child: give values of L_P, omega and xi only"
                            : "its children: " + names);
}

}  // namespace

std::vector<Value> list_of(const ModeValues& values) {
  std::vector<Value> all;
  for (const auto* list : {&values.omega, &values.xi})
    for (const auto& [mode, value] : *list) all.push_back(value);
  for (const Entry& e : values.L_P) all.push_back(e.value);
  for (const auto& [child, entries] : values.Phi_C)
    for (const Entry& e : entries) all.push_back(e.value);
  return all;
}

ModalParameters modes_with(const ModalData& data, const ModeValues& values,
                           const NumberOf& number) {
  ModalParameters m{replaced(data.omega, values.omega, number),
                    replaced(data.xi, values.xi, number)};
  check_modes(m);
  return m;
}

ModalData data_with(const ModalData& data, const ModeValues& values, const NumberOf& number) {
  ModalData result = data;
  ModalParameters m = modes_with(data, values, number);
  result.omega = std::move(m.omega);
  result.xi = std::move(m.xi);
  const Eigen::Index n = result.omega.size();
  check_entries(values.L_P, "L_P", n);
  for (const Entry& e : values.L_P) result.L_P(e.mode - 1, e.component - 1) = number(e.value);
  for (const auto& [name, entries] : values.Phi_C) {
    ModalChild& child = child_of(result, name);
    check_entries(entries, "Phi_C of " + name, n);
    for (const Entry& e : entries) child.Phi_C(e.component - 1, e.mode - 1) = number(e.value);
  }
  if (values.of_shapes()) check_modal_data(result);
  return result;
}

}  // namespace titop::detail
