"""A solar array drive: a stepper motor on the hub turns three hinged panels through a gear. The
motor's detent is a spring to the commanded angle; a turn of the hub turns the motor, too. As
examples/25_solar_array_drive.cpp."""
from math import pi

import numpy as np
import titop

panel_mass, width, length = 8, 1.6, 1.2  # [kg], [m]: along y, x
panel_k, panel_c = 1500, 1.5  # hinges of the panels, [N m/rad], [N m s/rad]
detent_k, detent_c = 0.8, 2e-4  # of the motor, [N m/rad], [N m s/rad]
step = 1.8 * pi / 180  # of the motor [rad]


def panel_inertia():
    """A plate in the x-y plane about its centre."""
    x, y = length * length / 12, width * width / 12
    return [panel_mass * y, panel_mass * x, panel_mass * (x + y)]


def satellite():
    """Turned about y by the tilt; the panels bend about their hinges along x."""
    d = titop.Diagram("satellite")
    tilt, N, J_m = d.param("tilt", 0), d.param("N", 100), d.param("J_m", 2e-5)
    command = d.input("command")  # angle of the motor [rad]
    hub = d.add("hub", titop.RigidBody(mass=400, inertia=[200, 180, 220],
                                       children={"array": [0, 0.8, 0]}))
    hub.parent.force = 0
    panel = titop.RigidBody(mass=panel_mass, inertia=panel_inertia(), PA=[0.15, width / 2, 0],
                            children={"next": [0, width, 0]})
    inner = d.add("panel1", panel)
    y = [0, 1, 0]
    drive = titop.hinge(d, "drive", inner, hub.child["array"], titop.Rotation.about(y, tilt), y)
    # Of the motor, which turns with the hub and N times the drive: its inertia and its detent.
    inertia = J_m * (hub.parent.accel.angular.along(y) + N * drive.accel)
    detent = N * (detent_c * drive.rate + detent_k * drive.angle) - detent_k * command
    drive.torque = N * (inertia + detent)
    hub.parent.force.angular.along[y] += inertia
    for i in 2, 3:
        outer = d.add(f"panel{i}", panel)
        joint = titop.hinge(d, f"hinge{i}", outer, inner.child["next"], titop.Rotation(), [1, 0, 0])
        joint.torque = panel_k * joint.angle + panel_c * joint.rate
        inner = outer
    d.output["turn"] = hub.parent.accel.angular
    return d


def pointing(system, omega, n):
    """Largest turn of the hub due to harmonic n of a sawtooth of one step."""
    s = 1j * n * omega
    return np.linalg.norm(system.transfer(s) / s**2) * step / (pi * n)


flat = titop.compile(satellite())
print(f"order {flat.state_space().order}, with the tilt, N and J_m as parameters")
print("turn of the hub [urad] at harmonics of 1.6 steps per second")
print(f"{'tilt [rad]':>10}", *(f"{n:9}" for n in range(1, 5)))
for tilt in 0.0, 0.6, 1.2:
    system = flat.update({"tilt": tilt})
    print(f"{tilt:10.1f}", *(f"{1e6 * pointing(system, 2 * pi * 1.6, n):9.4g}" for n in range(1, 5)))
