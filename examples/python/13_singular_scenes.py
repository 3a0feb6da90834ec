"""Points without mass: springs in series through a ring, a force on the ring; a plate whose motion
is prescribed at two points; a rod without mass between ball joints. Outputs that would need
derivatives of an input are refused by name. As examples/13_singular_scenes.cpp."""
import titop

k1, k2, k3, m2, m3 = 30, 50, 20, 2, 1.5  # [N/m], [kg]


def ring(ask_its_acceleration):
    """Three springs meet in a ring without mass: one from the wall, one to each of two masses."""
    d = titop.Diagram("ring")
    u = d.input("u")  # on the ring [N]
    z1 = d.add("z1", titop.SpringMass(mass=1, stiffness=k1))
    z2 = d.add("z2", titop.SpringMass(mass=m2, stiffness=k2))
    z3 = d.add("z3", titop.SpringMass(mass=m3, stiffness=k3))

    z1.child.accel = 0  # the wall
    z2.parent.accel = z1.parent.accel
    z3.parent.accel = z1.parent.accel
    z1.parent.force = -z2.parent.force - z3.parent.force - u  # nothing has mass there
    d.output["x_2"] = z2.stretch - z1.stretch  # [m]
    d.output["x_ring"] = -1.0 * z1.stretch
    if ask_its_acceleration:
        d.output["xdd_ring"] = z1.parent.accel
    return d


def shaker(one_command):
    """A plate on a shaker that moves it at two points; a spring-mass is mounted on it."""
    d = titop.Diagram("shaker")
    u, v = d.input("u", 6), d.input("v", 6)
    plate = d.add("plate", titop.RigidBody(mass=4, children={"far": [1, 0, 0]}))
    z = d.add("z", titop.SpringMass(mass=m2, stiffness=k2))
    plate.parent.accel = u
    if one_command:
        plate.child.accel = titop.tau([-1, 0, 0]) @ u  # motion of the far point due to u
    else:
        plate.child.accel = v
    titop.mount(z, plate.child.along([0, 1, 0]))
    d.output["xdd"] = z.child.accel
    d.output["unused"] = v
    return d


def tow(ask_how_the_rod_turns):
    """A ship tows a load by a rod without mass, a ball joint at both ends."""
    d = titop.Diagram("tow")
    U = d.input("U", 6)  # on the ship [N, N m]
    ship = d.add("ship", titop.RigidBody(mass=900, children={"stern": [-2, 0, 0.5]}))
    rod = d.add("rod", titop.RigidBody(mass=0, inertia=[0, 0, 0], children={"end": [-1.5, 0, 0]}))
    load = d.add("load", titop.RigidBody(mass=300, PA=[-0.4, 0.1, 0]))
    ship.parent.force = -U
    titop.joint(d, "hook", rod, ship.child, titop.Rotation(), titop.ball())
    titop.joint(d, "eye", load, rod.child, titop.Rotation(), titop.ball())
    d.output["xdd"] = load.parent.accel
    if ask_how_the_rod_turns:
        d.output["turn"] = rod.child.accel
    return d


def print_refusal(d):
    try:
        titop.compile(d)
    except titop.Error as error:
        print(error)


system = titop.compile(ring(False))
print(system.log(), end="")
print(f"order {system.state_space().order}, poles:\n{system.poles()}", end="")

print("\nthe ring's acceleration:")
print_refusal(ring(True))
print(f"\none command at two points: order {titop.compile(shaker(True)).order}")
print("\ntwo commands at two points of a rigid plate:")
print_refusal(shaker(False))

towing = titop.compile(tow(False))
print("\na rod without mass between ball joints:")
for note in towing.notes:
    if note.pass_ == "reduce":
        print(note.text)
print("\nhow it turns:")
print_refusal(tow(True))
