#pragma once

#include <string>
#include <titop/blocks/inertia.hpp>
#include <titop/blocks/position.hpp>
#include <titop/graph/diagram.hpp>
#include <titop/graph/linalg/kinematics.hpp>
#include <vector>

namespace titop {

/// A point of a body at which a child may be mounted.
struct ChildPoint {
  std::string name;
  Position PC = {};  ///< from the parent point P to C, in the body's frame [m]
};

/// Ports of a body: one parent point P, any number of child points by name.
struct BodyHandle {
  BodyHandle(Graph* graph, int node);
  BodyHandle(const BodyHandle&) = default;
  BodyHandle& operator=(const BodyHandle& other) { return detail::rebind(*this, other); }
  Children<6> child;   ///< child("C1"); also the only child point, if there is just one
  DualPort<6> parent;  ///< P
};

/// Rigid body, [Alazard 2015] eq. (9) without modes: with D_P = tau_AP' diag(m I, I_A) tau_AP,
///
///     xdd_C = tau_CP xdd_P
///     F_P   = sum over C of tau_CP' F_C - D_P xdd_P
///
/// No states. Port order: children in the order given, then the parent. Frame: the node's own.
/// Every number may be a parameter. `add`, and `update` for new values, throw bad_inertia or
/// not_finite for a negative mass and for an inertia that is not symmetric, not positive, or
/// violates the triangle inequality; `add` throws duplicate_name for two child points of one name.
/// A mass or inertia of 0 is allowed: a massless link; its motion when freed is undetermined, and
/// `compile` throws improper if an output or another block depends on it.
struct RigidBody {
  Value mass = 1;                          ///< [kg]
  Inertia inertia = Matrix3d::Identity();  ///< about the centre of mass A [kg m^2]
  Position PA = {};                        ///< from P to the centre of mass [m]
  std::vector<ChildPoint> children = {};

  using Handle = BodyHandle;
};
BlockPtr as_block(const RigidBody& spec);

/// Throws bad_inertia or not_finite unless some rigid body has this mass and inertia (about its
/// centre of mass), to 1e-9 of its largest entry or principal moment.
void check_inertia(double mass, const Matrix3d& inertia);

}  // namespace titop
