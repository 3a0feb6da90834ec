#pragma once

#include <titop/graph/diagram.hpp>

namespace titop {

/// Spring-mass on one axis, Z_i(m, k) and with a parent mass 𝒵(m0, k, m). [Alazard 2015] eqs
/// (3)-(6).
///
///        m0           m
///     P [==]--/\/\--[====] C        f_P: force of the block on its parent at P [N]
///             k, c                  f_C: force of the child on the block at C [N]
///
/// States: stretch δx = x_C − x_P [m] and its rate [m/s]. With δ̈x = ẍ_C − ẍ_P:
///
///     m ẍ_C = f_C − k δx − c δẋ
///     f_P   = k δx + c δẋ − m0 ẍ_P
///
/// Port order: y = [ẍ_C; f_P], u = [f_C; ẍ_P]. Every number may be a parameter.
/// mass > 0, stiffness and damping >= 0, parent_mass >= 0, checked by `add`, and by `update` for
/// new values (bad_inertia, bad_value). With parent_mass = 0 no force can be imposed at P
/// (improper).
struct SpringMass {
  Value mass = 1;         ///< m [kg]
  Value stiffness = 1;    ///< k [N/m]
  Value damping = 0;      ///< c [N s/m]
  Value parent_mass = 0;  ///< m0 [kg]

  struct Handle {
    Handle(Graph* graph, int node)
        : child(graph, node),
          parent(detail::channel<1>(graph, node, 1)),
          stretch(graph, detail::port_signal(*graph, node, "stretch")),
          position(child.position) {}
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    Children<1> child;   ///< C, on the mass
    DualPort<1> parent;  ///< P, on the other end of the spring
    Reading stretch;     ///< x_C − x_P [m]
    Reading position;    ///< x_C [m], if the chain to ground determines it
  };
};
BlockPtr as_block(const SpringMass& spec);

}  // namespace titop
