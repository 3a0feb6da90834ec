"""Blocks joined by equations: a scene without inputs still has its modes; with an actuator, the
model of x_3 has the ten states that the transfer needs, and eight if two masses have the same
motion. As examples/02_five_masses.cpp."""
import titop

PLAIN = [5, 4, 3, 2, 1], [500, 300, 450, 260, 170]  # [kg], [N/m]
TWINS = [5, 4, 3, 2, 1], [500, 300, 450, 260, 130]  # k4/m4 = k5/m5


def masses(d, numbers):
    return [d.add(f"z{i + 1}", titop.SpringMass(mass=m, stiffness=k))
            for i, (m, k) in enumerate(zip(*numbers))]


def five_masses(numbers, actuator):
    d = titop.Diagram("five masses")
    z1, z2, z3, z4, z5 = masses(d, numbers)

    z1.parent.accel = 0  # the wall
    z2.parent.accel = z1.child.accel
    z3.parent.accel = z1.child.accel
    z4.parent.accel = z2.child.accel
    z5.parent.accel = z2.child.accel
    z1.child.force += z2.parent.force + z3.parent.force
    z2.child.force += z4.parent.force + z5.parent.force
    if not actuator:
        return d

    u = d.input("u")  # an actuator between masses 1 and 2 [N]
    z1.child.force += -u
    z2.child.force += u
    d.output["x1"] = z1.position  # [m]
    d.output["x2"] = z2.position
    d.output["x3"] = z1.stretch + z3.stretch  # the same as z3.position
    d.output["x4"] = z4.position
    d.output["x5"] = z5.position
    d.output["xdd3"] = z3.child.accel  # [m/s^2]
    return d


def only_x3(numbers):
    d = titop.Diagram("x3 alone")
    u = d.input("u")
    z1, z2, z3, z4, z5 = masses(d, numbers)
    titop.ground(z1)
    titop.mount(z2, z1.child)  # the two equations of a joint in one word
    titop.mount(z3, z1.child)
    titop.mount(z4, z2.child)
    titop.mount(z5, z2.child)
    z1.child.force += -u
    z2.child.force += u
    d.output["x3"] = z3.position
    return d


fig1 = titop.compile(five_masses(PLAIN, actuator=False))
print(f"Fig. 1, no inputs: order {fig1.state_space().order}\n{fig1.poles()}", end="")

fig8 = titop.compile(five_masses(PLAIN, actuator=True))
print(f"\nFig. 8: order {fig8.state_space().order}")
print(f"xdd_3 / u at 3 rad/s: {fig8.transfer(3j)[fig8.output('xdd3'), fig8.input('u')].real:.12f}")
rest = fig8.static_gain()
print("x at rest under 1 N:", *(f"{round(x, 7) + 0.0:.7f}" for x in rest[:5, 0]), "m")

print("\nu to x_3 alone")
for name, numbers in ("general", PLAIN), ("k4/m4 = k5/m5", TWINS):
    x3 = titop.compile(only_x3(numbers), exact_up_to=10)
    order = x3.state_space().order
    print(f"  {name:14} order {order}, from M and K {order}")
    print(f"  {'':14} {titop.exact_order(only_x3(numbers))}")

full = titop.certify(fig8)
print(f"\nFig. 8 certified in full: {full.poles_measured} of {full.poles_count} poles measured, "
      f"order {'decided' if full.order.decided else 'undecided'}, "
      f"{'no fault found' if full.holds else full.faults[0]}")
