"""How to inspect the compiler: one Graphviz file for the diagram as written and one after each of
the seven graph passes, and the log of all passes. As examples/08_see_the_passes.cpp."""
import pathlib

import titop


def scene():
    """Something for every pass: a gain to lower, a part that nothing sees, a channel to invert, a
    loop between two bodies, a filter that drives nothing."""
    d = titop.Diagram("passes")
    u = d.input("u")
    cart = d.add("cart", titop.SpringMass(mass=2, stiffness=80, parent_mass=3))
    load = d.add("load", titop.SpringMass(mass=1, stiffness=40, damping=0.2, parent_mass=0.5))
    amplifier = d.add("amplifier", titop.Gain(gain=12))
    filter = d.add("filter", titop.Lti(A=[[-1]], B=[[1]], C=[[1]]))
    bell = d.add("bell", titop.SpringMass(mass=0.1, stiffness=900))
    amplifier.in_ = u
    cart.parent.force = -amplifier.out  # imposed where the block expects a motion: inverted
    titop.mount(load, cart.child)  # two masses at one point: an algebraic loop
    filter.in_ = load.stretch  # not read: removed
    titop.ground(bell)  # no input, no output: set aside
    d.output["x"] = load.stretch
    d.output["xdd"] = cart.parent.accel
    return d


system = titop.compile(scene(), dump_to="passes")
print(system.log())
for file in sorted(pathlib.Path("passes").iterdir()):
    print(f"passes/{file.name}")
print(f"\norder {system.state_space().order}")
