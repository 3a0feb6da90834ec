"""One plan, many values: a boom of which the tip mass and the spring at its root are parameters.
`update` gives the system for other values; `sweep` does so on all cores. Then a wing with one
uncertain mode. As examples/10_parameters.cpp."""
import numpy as np
import titop

HUB, BOOM, SPRING, TIP = 50, 4, 300, 2


def scene():
    """Hub (free) - spring - boom - stiff spring - tip, on one axis."""
    d = titop.Diagram("boom")
    spring = d.param("spring", SPRING)  # [N/m]
    tip = d.param("tip", TIP)  # [kg]
    u = d.input("u")
    root = d.add("root", titop.SpringMass(mass=BOOM, stiffness=spring, parent_mass=HUB))
    end = d.add("end", titop.SpringMass(mass=tip, stiffness=5000))
    root.parent.force = -u
    titop.mount(end, root.child)
    d.output["hub"] = root.parent.accel
    d.output["tip"] = end.child.accel
    return d


def one_mode():
    """A wing along x of 12 kg and 16 kg m^2 about its root P, bending in y."""
    return titop.ModalData(omega=[3], xi=[0.005], L_P=[[0, 2.7, 0, 0, 0, 3.9]],
                           D_P=titop.rigid_mass(12, np.diag([0.0, 4, 4]), [-1, 0, 0]))


def winged():
    """Hub (free) and wing."""
    d = titop.Diagram("winged")
    omega, xi = d.param("omega", 3.0), d.param("xi", 0.005)  # [rad/s], [-]
    spin = d.param("spin", 9.0)  # about z [kg m^2]
    U = d.input("U", 6)
    hub = d.add("hub", titop.RigidBody(mass=HUB, inertia=[8, 8, spin], children={"root": None}))
    wing = d.add("wing", titop.FlexibleBody(titop.FlexibleBody(one_mode()), omega={1: omega},
                                            xi={1: xi}))
    hub.parent.force = -U
    titop.mount(wing, hub.child)
    d.output["hub"] = hub.parent.accel
    return d


system = titop.compile(scene())
heavy = system.update({"tip": 8.0})
print(f"{'slow mode [Hz]':22} {'tip 2 kg':>8} {'tip 8 kg':>8}")
print(f"{'':22} {system.poles()[0].hertz:8.4f} {heavy.poles()[0].hertz:8.4f}")

points = [{"spring": 100.0 * i, "tip": 0.5 * i} for i in range(1, 10)]
hertz = titop.sweep(system, points, lambda i, at: at.poles()[0].hertz)
print(f"\n{'spring [N/m]':>12} {'tip [kg]':>10} {'mode [Hz]':>12}")
for point, value in zip(points, hertz):
    print(f"{point['spring']:12.0f} {point['tip']:10.1f} {value:12.4f}")

wing = titop.compile(winged())
other = wing.update({"omega": 2.4, "xi": 0.02, "spin": 7.0})
print(f"\nwing at 3 rad/s: mode of {wing.poles()[-1].hertz:.4f} Hz, at 2.4 rad/s on a smaller hub: "
      f"{other.poles()[-1].hertz:.4f} Hz")

difference = system.transfer(7j) - system.transfer(7j, "twofold")
digits = np.linalg.norm(difference) / np.linalg.norm(system.transfer(7j))
print(f"\ntransfer in double against 32 digits: {'agrees' if digits <= 1e-14 else 'differs'}")
lost = heavy.certificate(heavy.write()).dense_error
print(f"written as A, B, C, D: {'12 digits or more' if lost <= 1e-12 else 'less'}")
