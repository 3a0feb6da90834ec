#pragma once

#include <optional>
#include <titop/analysis/reduction/reduced_system.hpp>
#include <titop/analysis/reduction/small.hpp>
#include <titop/analysis/reduction/states.hpp>

/// The data of a ReducedSystem. For the library's own files only.
namespace titop::detail {

struct ReducedData {
  Scene scene;
  System full;
  Small small;
  ErrorBound bound;
  std::vector<Note> notes;
  std::vector<ReductionStep> steps;
  std::vector<KeptMode> modes;
  std::vector<std::pair<std::string, double>> seconds;
  std::optional<States> states = {};  ///< instead of `small`, if there is no second-order form
};

/// The coordinates of a small model, with the blocks that move in each.
std::vector<KeptMode> kept_modes(const Whole& whole, const Small& small);

}  // namespace titop::detail
