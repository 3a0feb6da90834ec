#pragma once

#include <optional>
#include <titop/graph/state_space.hpp>
#include <vector>

namespace titop {

/// Positions of a model's states, inputs and outputs in natural order of their names. Computations
/// in this order give the same bits for any order of declaration in the diagram.
struct NameOrder {
  std::vector<int> states, inputs, outputs;
};

/// The names at these places, if there are any.
std::vector<std::string> names_at(const std::vector<std::string>& names,
                                  const std::vector<int>& places);

/// None if the names of rows or of columns are not unique. O(n log n).
std::optional<NameOrder> name_order(const StateSpace& model);

/// The model in that order.
StateSpace by_name(const StateSpace& model, const NameOrder& order);

/// The model with its states in that order, if their names are unique.
StateSpace states_by_name(const StateSpace& model);

/// Inverse of the reordering: `states` are the names before; those that `model` lacks are omitted.
StateSpace as_before(const StateSpace& model, const std::vector<std::string>& states,
                     const NameOrder& order);

}  // namespace titop
