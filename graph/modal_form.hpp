#pragma once

#include <titop/graph/block.hpp>

/// Matrices derived from a body's modes.
namespace titop {

/// A, B, C, D of the states [eta; etad], with the modal form itself. D is as symmetric as `rigid`.
/// O(modes^2 + modes inputs^2).
std::shared_ptr<const Dynamics> modal_dynamics(Modal modal);

/// The body alone at s, O(modes inputs^2). Throws singular, with the mode and this type of block,
/// if s is a pole.
Block::Response modal_response(const Modal& modal, std::complex<double> s, std::string_view type);

}  // namespace titop
