#pragma once

#include <titop/blocks/rigid_body.hpp>

namespace titop {

/// Block::opened of a rigid body whose matrices at `values` are `dynamics`. With a component of a
/// position moved by d along e, tau becomes tau + d G F, F the two angular accelerations across e
/// and G their effect across e; F_P has the transposed: 4 pairs. Mass: z = the three linear
/// accelerations of A. Entry ij of the inertia: z = the angular accelerations i and j, w the
/// torques about j and i; one of them if i = j.
Opened opened_rigid_body(const RigidBody& spec, const Dynamics& dynamics, ParameterValues values,
                         std::span<const int> parameters);

}  // namespace titop
