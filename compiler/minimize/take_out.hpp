#pragma once

#include <string>
#include <titop/compiler/minimize/judge.hpp>
#include <titop/compiler/minimize/modes.hpp>
#include <vector>

/// Modes that leave a model, as relations between its states: the rest keep name and meaning.
namespace titop::modes {

/// Takes out the modes that the verdicts drop; one note for states that now follow from the others,
/// one for those that the others are taken relative to. O(n^2) per mode.
void take_out(const Symmetric& s, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes);
void take_out(const General& g, const std::vector<Verdict>& verdicts, StateSpace& model,
              std::vector<std::string>& notes);

}  // namespace titop::modes
