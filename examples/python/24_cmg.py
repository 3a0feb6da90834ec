"""A cluster of four single-gimbal control moment gyroscopes: each is a rotor of constant speed on a
gimbal that a hinge turns about an axis across the rotor's. As examples/24_cmg.cpp."""
from math import cos, pi, sin, sqrt

import numpy as np
import titop

axial, transverse = 0.08, 0.05  # [kg m^2]
gimbal_inertia, h = 0.01, 40  # [kg m^2], [N m s]
k, c = 500, 0.2  # of the gimbal drives, [N m/rad], [N m s/rad]


def axes(i):
    """Of the gimbal and of the rotor: a pyramid about z; the momenta sum to 0."""
    azimuth, up = i * pi / 2, 54.7 * pi / 180
    out = np.array([cos(azimuth), sin(azimuth), 0])
    side = np.cross([0, 0, 1], out)
    return cos(up) * np.array([0, 0, 1]) + sin(up) * out, side


def cluster():
    d = titop.Diagram("cluster")
    U = d.input("U", 3)
    hub = d.add("hub", titop.RigidBody(mass=300, inertia=[120, 140, 100],
                                       children={"cluster": [0.1, 0, -0.2]}))
    hub.parent.force.angular += -U
    titop.release(hub)
    for i in range(4):
        gimbal_axis, rotor_axis = axes(i)
        gimbal = d.add(f"gimbal{i + 1}", titop.RigidBody(mass=1, inertia=[gimbal_inertia] * 3,
                                                         children={"rotor": None}))
        rotor = d.add(f"rotor{i + 1}", titop.Rotor(mass=5, axial=axial, transverse=transverse,
                                                   axis=rotor_axis, momentum=h))
        drive = titop.hinge(d, f"drive{i + 1}", gimbal, hub.child["cluster"], titop.Rotation(),
                            gimbal_axis)
        titop.mount(rotor, gimbal.child["rotor"])
        drive.torque = k * drive.angle + c * drive.rate - d.input(f"u{i + 1}")
        rotor.accel = 0  # its speed is held
        d.output[f"angle{i + 1}"] = drive.angle
    d.output["turn"] = hub.parent.accel.angular
    return d


system = titop.compile(cluster())
slowest = next(p.omega for p in system.poles() if p.pair)
print(f"order {system.state_space().order}, slowest gimbal mode {slowest:.4f} rad/s, sqrt(k / J) "
      f"{sqrt(k / (gimbal_inertia + transverse)):.4f}")
# Far below the poles: the inertia that a torque on the hub meets, with h^2 / k.
apparent = np.linalg.inv(system.transfer(1e-3j)[4:, :3].real)
wound = sum(h * h / k * np.outer(t, t) for t in (np.cross(r, g) for g, r in map(axes, range(4))))
print(f"apparent inertia about x: {apparent[0, 0]:.4f} kg m^2, of which h^2 / k {wound[0, 0]:.4f}")
