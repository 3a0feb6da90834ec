"""Liquid in a tank under constant thrust, in two equivalent models: a mass on springs across the
thrust axis, and a pendulum. As examples/26_sloshing.cpp."""
from math import sqrt

import titop

m, g, l = 60, 0.05, 0.3  # [kg], [m/s^2], [m]
k, xi = m * g / l, 0.005  # [N/m]
c = 2 * xi * sqrt(k * m)  # [N s/m]
liquid_at = [0.1, 0, -0.4]  # centre of the liquid at rest


def pendulum(d, site):
    """Hangs from `site`, a length l ahead of the liquid."""
    bob = d.add("bob", titop.RigidBody(mass=m, inertia=[0, 0, 0], PA=[0, 0, -l]))
    pivot = titop.joint(d, "pivot", bob, site, titop.Rotation(),
                        [titop.about([1, 0, 0], "x"), titop.about([0, 1, 0], "y")])
    for name in "x", "y":
        axis = pivot.axis(name)
        axis.force = k * l * l * axis.position + c * l * l * axis.rate


def satellite(model):
    d = titop.Diagram("satellite")
    U = d.input("U", 6)
    hub = d.add("hub", titop.RigidBody(
        mass=500, inertia=[400, 420, 300],
        children={"liquid": liquid_at, "pivot": [0.1, 0, liquid_at[2] + l]}))
    hub.parent.force = -U
    if model == "springs":
        titop.slosh(d, "liquid", hub.child["liquid"], titop.Slosh(mass=m, stiffness=k, damping=c))
    else:
        pendulum(d, hub.child["pivot"])
    d.output["accel"] = hub.parent.accel
    return d


print(f"liquid in a tank at rest: {sqrt(g / l):.4f} rad/s")
for model in "springs", "pendulum":
    system = titop.compile(satellite(model))
    print(f"{model}: order {system.state_space().order}, with the free satellite",
          *(f"{p.omega:.4f}" for p in system.poles()), "rad/s")
