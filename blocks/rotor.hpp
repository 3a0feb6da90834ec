#pragma once

#include <titop/blocks/inertia.hpp>
#include <titop/blocks/momentum.hpp>

namespace titop {

/// Rotor on a carrier: reaction wheel, momentum wheel, disk on a shaft; axisymmetric and balanced
/// about the unit vector a along `axis` through its centre of mass A. It spins at a constant speed
/// Omega relative to the carrier, with momentum = I_a Omega, plus a small change nu of that speed:
///
///     F_P = -D_P xdd_P - [0; a] I_a nud + [0; h a x omega_P]
///     C_m = -I_a (a' omegad_P + nud)                          the 7th pair of scalars
///
/// with D_P = tau_AP' diag(m I, I_t (I - a a') + I_a a a') tau_AP and h = momentum. The last term
/// of F_P is written by `add` as equations, if the momentum is a parameter or a number other than
/// 0: see `momentum`. States: the integral of nu, and nu; they are removed if no output and no
/// equation reads them.
///
/// Sign of the torque as with Hinge: C_m is the torque of the rotor ON its carrier about a, so a
/// motor that exerts tau on the rotor is `torque = -tau`, and friction is `torque = c * speed`.
/// Exactly one of `torque` and `accel` is driven: torque = 0 is a free rotor, accel = 0 one whose
/// speed is held. F_P is `parent.reaction`; `parent.force`, the block's own output, is without the
/// gyroscopic term. A control moment gyroscope is a rotor on a `hinge`.
///
/// The model is of constant coefficients only if the rotor is axisymmetric: bodies with unequal
/// transverse inertias, or flexible ones, cannot spin. All numbers but axis and PA may be
/// parameters. O(1) [Meirovitch 2001, ch. 3, for the gyroscopic torque]. Throws bad_inertia for a
/// negative mass or inertia and for axial > 2 transverse, which no body has; bad_value for an axis
/// without direction; not_finite.
///
///     auto wheel = d.add("wheel", Rotor{.mass = 6, .axial = 0.05, .transverse = 0.03,
///                                       .axis = {0, 1, 0}, .momentum = 20});
///     mount(wheel, hub.child("W"), T_wb);
///     wheel.torque = -d.input("motor");
///     d.output("speed") = wheel.speed;
struct Rotor {
  Value mass = 1;                     ///< [kg]
  Value axial = 1;                    ///< I_a about the spin axis [kg m^2]
  Value transverse = 1;               ///< I_t about the centre of mass, across the axis [kg m^2]
  Vector3d axis = Vector3d::UnitZ();  ///< a, any length but 0, in the rotor's frame
  Value momentum = 0;                 ///< h = I_a Omega [N m s]
  Vector3d PA = Vector3d::Zero();     ///< from P to the centre of mass [m]

  struct Handle {
    Handle(Graph* graph, int node);
    Handle(const Handle&) = default;
    Handle& operator=(const Handle& other) { return detail::rebind(*this, other); }
    DualPort<6> parent;           ///< P, on the carrier
    Port<1, Kind::accel> accel;   ///< nud, relative to the carrier [rad/s^2]
    Port<1, Kind::force> torque;  ///< C_m [N m]
    Reading angle;                ///< integral of nu [rad]
    Reading speed;                ///< nu, change of the speed [rad/s]
  };
  /// The gyroscopic term.
  void connect(const Handle& rotor, SourceLine at) const;
};
BlockPtr as_block(const Rotor& spec);

/// Static and dynamic imbalance of a rotor, both in one plane through the axis: masses m at e u +
/// z a from the centre of mass A, u a unit vector across the axis.
struct Imbalance {
  double static_kgm = 0;    ///< sum of m e [kg m]
  double dynamic_kgm2 = 0;  ///< sum of m e z: product of inertia about A [kg m^2]
};

/// Input `name` with the components cos(Omega t) and sin(Omega t) of an imbalance that turns with
/// the rotor at Omega = `speed` [rad/s], a number of its own beside the rotor's momentum: on the
/// rotor act the force static Omega^2 u at A and the torque dynamic Omega^2 a x u, with u = b cos +
/// c sin and the vectors b, c of `across(a)`. The vibration at that speed is G(j Omega) [1; -j], G
/// the transfer from this input: its amplitudes and phases. Throws unknown_name for a rotor of
/// another diagram, not_finite. O(1).
///
///     unbalance(d, wheel, "imbalance", {.static_kgm = 7e-6, .dynamic_kgm2 = 2e-7}, 300.0);
void unbalance(Diagram& d, const Rotor::Handle& rotor, std::string name, const Imbalance& imbalance,
               double speed, SourceLine at = std::source_location::current());

}  // namespace titop
