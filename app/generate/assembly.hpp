#pragma once

#include "generate/plan.hpp"
#include "generate/table.hpp"

/// The equations of motion of a plan, assembled by hand: coordinates of the tree, Lagrange's
/// equations, null space of the closures, controllers around it. This is the oracle of the random
/// scenes; it uses neither the library nor the diagram file.
namespace titop::generate {

/// xdot = A x + B u, y = C x + D u; not minimal.
template <class S>
struct FirstOrder {
  Table<S> A, B, C, D;
};

/// Throws std::domain_error if the mass matrix or an algebraic loop is singular, and if an output
/// is a reaction that the motion does not determine.
template <class S>
FirstOrder<S> assemble(const ScenePlan& plan);

/// Its reachable and observable part, by Krylov subspaces.
template <class S>
FirstOrder<S> minimal(const FirstOrder<S>& model);

/// True if the closures are independent, so that their reactions are determined.
bool closures_independent(const ScenePlan& plan);

}  // namespace titop::generate
