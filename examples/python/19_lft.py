"""Parameters taken out of a model: a satellite with two wings whose hub mass, tilt of the wings,
first frequency and damping are not fixed yet. One compile gives a linear fractional transformation
with the least number of occurrences of each, and exact derivatives. As examples/19_lft.cpp."""
from math import pi

import numpy as np
import titop


def wing():
    return titop.ModalData(
        omega=[1.57, 3.77, 6.91], xi=[0.005] * 3,  # [rad/s], [-]
        L_P=[[0, 0, 6.5, 0, -21, 0], [0, 5.8, 0, 0, 0, 19], [0, 0, 0, 3.9, 0, 0.5]],
        D_P=titop.rigid_mass(60, np.diag([20.0, 180, 200]), [-2.5, 0, 0]))


def satellite():
    d = titop.Diagram("satellite")
    m, tilt = d.param("m", 1000), d.param("tilt", 0.4)  # [kg], [rad]
    w1, xi = d.param("w1", 1.57), d.param("xi", 0.005)  # [rad/s], [-]
    U = d.input("U", 3)  # torque on the hub [N m]
    hub = d.add("hub", titop.RigidBody(mass=m, inertia=[400, 500, 600],
                                       children={"L": [0, 1, 0.2], "R": [0, -1, 0.2]}))
    hub.parent.force.linear = 0
    hub.parent.force.angular = -U
    panel = titop.FlexibleBody(titop.FlexibleBody(wing()), omega={1: w1}, xi={1: xi})
    left, right = d.add("left", panel), d.add("right", panel)
    about = titop.Rotation.about
    tilted = about([1, 0, 0], tilt)
    titop.mount(left, hub.child["L"], about([0, 0, 1], pi / 2) * tilted)
    titop.mount(right, hub.child["R"], about([0, 0, 1], -pi / 2) * tilted)
    d.output["turn"] = hub.parent.accel.angular  # [rad/s^2]
    return d


system = titop.compile(satellite())
f = titop.lft(system, {"m": titop.percent(20), "tilt": titop.between(-1.2, 1.9),
                       "w1": titop.percent(30), "xi": titop.between(0.001, 0.02)})
print(f, end="")

# Which way each parameter moves the modes.
g = titop.derivatives(system, ["m", "tilt", "w1", "xi"])
print(f"\n{'mode [rad/s]':>12} {'by m':>12} {'by tilt':>12} {'by w1':>12}   [rad/s per unit]")
for p in g.poles():
    print(f"{p.s.imag:12.5f}", *(f"{p.slopes[i][0].imag:12.4g}" for i in range(3)))

print(f"\nleast numbers of occurrences: {'proven' if all(d.minimal for d in f.deltas) else 'NO'}")
