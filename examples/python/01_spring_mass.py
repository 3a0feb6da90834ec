"""A spring-mass is a block with two ports; which side of each port is the cause is free: the same
block gives four causalities, and the free-free structure G(s). As examples/01_spring_mass.cpp."""
import titop

m, k, m0 = 2, 50, 4  # [kg], [N/m], [kg]


def two_port(model):
    """Without the stretch reading: [xdd_C; f_P] from [f_C; xdd_P]."""
    return titop.StateSpace(model.A, model.B, model.C[:2], model.D[:2], states=model.states,
                            inputs=model.inputs, outputs=model.outputs[:2])


def free_free():
    """Forces u1 on the mass m and u2 on m0, their accelerations."""
    d = titop.Diagram("free-free")
    u1 = d.input("u1")
    u2 = d.input("u2")
    z = d.add("z", titop.SpringMass(mass=m, stiffness=k, parent_mass=m0))
    z.child.force = u1
    z.parent.force = -u2  # imposing a force at P inverts that channel
    d.output["xdd_C"] = z.child.accel
    d.output["xdd_P"] = z.parent.accel
    return d


spec = titop.SpringMass(mass=m, stiffness=k, parent_mass=m0)
print(f"Z(m0 = {m0}, k = {k}, m = {m})\n{two_port(titop.model_of(spec))}")
print("inverted at its parent: forces in, accelerations out")
print(two_port(titop.invert(spec, ["parent"])))
free = titop.compile(free_free())
print(f"order {free.state_space().order}, poles:\n{free.poles()}", end="")
