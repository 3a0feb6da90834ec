#pragma once

#include <string>
#include <titop/graph/diagram.hpp>
#include <titop/graph/state_space.hpp>
#include <vector>

/// Channel inversion of a single block: the paper's Z^-1u, Z^-1l, Z^-1 and G^-1p. Scenes do not
/// need it: the compiler inverts their channels.
namespace titop {

/// A block alone, by its ports' names: inputs "child.force", "parent.accel(3)", ... at the nominal
/// parameter values. O(size^2).
StateSpace model_of(const BlockPtr& block);

/// The block with input and output exchanged in some channels: "parent" (all of it), "C1.angular",
/// "C1.linear", "parent(3)" (one degree of freedom, 1 to 6), "" (a hinge's own axis). Every
/// exchanged input keeps its place and gets the output's name, and vice versa; states stay.
/// Inverting twice gives the same model again. Throws unknown_name, and improper, with the rank, if
/// the direct term of the exchanged channels is singular. O(size^3).
StateSpace invert(const BlockPtr& block, const std::vector<std::string>& channels);

/// The same for a model: pairs {input, output}, counted from 0, each number once. Throws size
/// for matrices or names that do not fit, bad_value for a number out of range or named twice,
/// and improper, with the rank, if D is singular there or below 1e-14 of its other entries.
/// O(n^2 + pairs^3).
StateSpace invert(const StateSpace& model, const std::vector<std::pair<int, int>>& pairs);

template <BlockSpec Spec>
StateSpace model_of(const Spec& spec) {
  return model_of(as_block(spec));
}
template <BlockSpec Spec>
StateSpace invert(const Spec& spec, const std::vector<std::string>& channels) {
  return invert(as_block(spec), channels);
}

}  // namespace titop
