"""Forces and motions may be imposed at either end of a chain: mass 0 is free under a force, mass 2
is locked, and the blocks invert the two channels by themselves. As examples/03_locked_mass.cpp."""
import titop

m0, k1, m1, k2, m2 = 2, 50, 3, 80, 1.5  # [kg], [N/m]


def locked_mass():
    d = titop.Diagram("locked mass")
    u = d.input("u")  # [N]
    z1 = d.add("z1", titop.SpringMass(mass=m1, stiffness=k1, parent_mass=m0))
    z2 = d.add("z2", titop.SpringMass(mass=m2, stiffness=k2))

    z1.parent.force = -u  # m0 is free: its acceleration is an output
    titop.mount(z2, z1.child)
    z2.child.accel = 0  # m2 is locked: the force that holds it is an output
    d.output["xdd_0"] = z1.parent.accel
    d.output["xdd_1"] = z1.child.accel
    d.output["f_lock"] = z2.child.force  # f_{3/2}, by the lock on m2
    return d


system = titop.compile(locked_mass())
print(system.log(), end="")
print(f"\norder {system.state_space().order}, poles:\n{system.poles()}", end="")
at_3 = system.transfer(3j).real[:, 0]
print(f"at 3 rad/s: xdd_0 {at_3[0]:.12f}, xdd_1 {at_3[1]:.12f}, f_lock {at_3[2]:.12f}")
