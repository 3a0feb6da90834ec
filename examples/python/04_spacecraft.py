"""A spacecraft is written as it is built: add the bodies, mount them, declare inputs and outputs.
The bus, free under U, gets its parent channel inverted by that alone. As
examples/04_spacecraft.cpp."""
from math import pi

import titop


def spacecraft(bus, wing, T_ba1, T_ba2):
    d = titop.Diagram("spacecraft")
    U = d.input("U", 6)  # wrench on B at P, in frame b [N; N m]
    B = d.add("B", bus)
    A1 = d.add("A1", wing)
    A2 = d.add("A2", wing)
    B.parent.force = -U  # P is free: this channel gets inverted
    titop.mount(A1, B.child["C1"], T_ba1)  # same motion there, wrench back here
    titop.mount(A2, B.child["C2"], T_ba2)
    d.output["xdd_P"] = B.parent.accel
    d.output["xdd_F1"] = A1.child["F"].accel
    d.output["xdd_F2"] = A2.child["F"].accel
    return d


def make_wing():
    """Tube of aluminium, 3 m long, two elements, all its twelve modes."""
    data = titop.fe.modal_data(
        titop.Beam(length=3, section=titop.tube(0.05, 0.045),
                   material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=2))
    end = data.children[0]
    end.name = "F"  # its free end
    data.children = [end]
    return titop.FlexibleBody(data)


def make_bus(PA, C1, C2):
    """A flexible body without modes."""
    return titop.FlexibleBody(
        titop.RigidBody(mass=120, inertia=[20, 25, 30], PA=PA,  # [kg], [kg m^2], [m]
                        children={"C1": C1, "C2": C2}))


about = titop.Rotation.about
wing = make_wing()
skew = titop.compile(spacecraft(make_bus([0.1, -0.05, 0.2], [0.5, 0.3, -0.1], [-0.4, 0.2, 0.3]),
                                wing, about([0, 0, 1], 0.4), about([1, 2, -1], 2.5)))
order = skew.state_space().order
print(f"two rotations: order {order}, from M and K {order}")
print("  lowest frequencies [Hz]:", *(f"{p.hertz:.5f}" for p in skew.poles()[:6]))

# Mounted symmetrically. Stretching and twisting in opposite phase leave the bus at rest, and only
# those: opposite bending turns it. No input moves them, so they are not in the model.
symmetric = titop.compile(spacecraft(make_bus([0, 0, 0], [0.5, 0, 0], [-0.5, 0, 0]), wing,
                                     titop.Rotation(), about([0, 0, 1], pi)))
order = symmetric.state_space().order
print(f"\nsymmetric: order {order} of {symmetric.order}, from M and K {order}")
