"""Reaction wheels with momentum: a hub with a boom, turned by four wheels in a pyramid under an
attitude law; torquers take the momentum out of the wheels; the imbalance of a wheel on a plate on
springs turns the line of sight. As examples/22_wheels.cpp."""
from math import cos, pi, sin

import numpy as np
import titop

axial, friction = 0.08, 1e-3  # [kg m^2], [N m s/rad]
law_k, law_c, dumped = 4, 40, 0.01  # [N m/rad], [N m s/rad], [1/s]
imbalance = titop.Imbalance(static_kgm=7e-6, dynamic_kgm2=2e-7)


def spin_axis(i):
    """A pyramid about z, 35 degrees above the x-y plane."""
    azimuth, up = (2 * i + 1) * pi / 4, 35 * pi / 180
    return np.array([cos(up) * cos(azimuth), cos(up) * sin(azimuth), sin(up)])


def allocation():
    """Torques of the motors that turn the hub by a given torque."""
    A = np.array([spin_axis(i) for i in range(4)]).T
    return A.T * (1 / (A * A).sum(axis=1))


def isolated_plate(d, hub):
    """The wheels' plate on its springs."""
    plate = d.add("plate", titop.RigidBody(mass=10, inertia=[0.4, 0.4, 0.4], children={"wheels": None}))
    titop.bushing(d, "isolator", plate, hub.child["wheels"], titop.Rotation(),
                  titop.Bushing(stiffness=[2e5] * 3 + [2e4] * 3, damping=[100] * 3 + [4] * 3))
    return plate


def add_wheel(d, i, hub, site, momentum, motors, vibration):
    """Its speed is an output, or its imbalance at 1 rad/s an input."""
    wheel = d.add(f"w{i + 1}", titop.Rotor(mass=5, axial=axial, transverse=0.05, axis=spin_axis(i),
                                           momentum=momentum))
    titop.mount(wheel, site)
    wheel.torque = friction * wheel.speed  # `torque` is that of the rotor on its carrier
    if motors != "off":
        share = allocation()[i:i + 1]
        wheel.torque += (-law_k * share) @ hub.parent.position.angular + \
            (-law_c * share) @ hub.parent.rate.angular
    if motors == "dumping":
        hub.parent.force.angular += (dumped * axial * spin_axis(i)[:, None]) @ wheel.speed
    if vibration:
        titop.unbalance(d, wheel, f"imbalance{i + 1}", imbalance, 1)
    else:
        d.output[f"speed{i + 1}"] = wheel.speed


def satellite(momentum, motors, vibration=False):
    """h is the momentum of each wheel [N m s]. `vibration`: the wheels stand on a plate on springs."""
    d = titop.Diagram("satellite")
    h = d.param("h", momentum)
    U = d.input("U", 3)  # torque of disturbances
    hub = d.add("hub", titop.RigidBody(mass=300, inertia=[120, 140, 100],
                                       children={"boom": [0.5, 0, 0.3], "wheels": [0.1, 0, -0.2]}))
    boom = d.add("boom", titop.FlexibleBody(
        titop.Beam(length=4, section=titop.tube(0.05, 0.046),
                   material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=2)))
    titop.mount(boom, hub.child["boom"])
    hub.parent.force.angular += -U
    titop.release(hub)
    site = (isolated_plate(d, hub) if vibration else hub).child["wheels"]
    for i in range(4):
        add_wheel(d, i, hub, site, h, motors, vibration)
    d.output["turn"] = hub.parent.accel.angular
    return d


def sight(turn, wheel):
    """Turn of the line of sight, the hub's z axis, by a wheel's imbalance at its speed [rad]."""
    return np.linalg.norm(turn[:2, 3 + 2 * wheel:5 + 2 * wheel] @ [1, -1j])


for momentum in 0.0, 40.0:
    free = titop.compile(satellite(momentum, "off"))
    nutation = next(p.omega for p in free.poles() if p.pair and p.omega > 0.1)
    print(f"momentum {momentum:.0f} N m s in each wheel, motors off: order "
          f"{free.state_space().order}, slowest oscillation {nutation:.4f} rad/s")
    held = titop.compile(satellite(momentum, "law"))
    slowest = max(p.s.real for p in held.poles() if p.omega > 1e-9)
    print(f"with the law: order {held.state_space().order}, {'stable' if slowest < 0 else 'not stable'}")
    slow = titop.compile(satellite(momentum, "dumping")).poles()[:3]
    print("with torquers: slowest poles", *(f"{p.s.real:.5f}{' (pair)' * p.pair}" for p in slow),
          f"1/s, their gain {dumped:.5f}")
    turned = abs(free.transfer(1e-3j)[-3:, 0]) / 1e-3
    print("at 0.001 rad/s 1 N m about x turns the hub with {:.4f}, {:.4f}, {:.4f} rad/s about x, y, "
          "z\n".format(*turned))

on_plate = titop.compile(satellite(0, "off", vibration=True))
at = {omega: sight(on_plate.update({"h": axial * omega}).transfer(1j * omega), 0)
      for omega in range(20, 631, 10)}
worst = max(at, key=at.get)
print(f"imbalance of a wheel: turns the line of sight most, by {1e9 * at[worst]:.2f} nrad, at {worst} "
      "rad/s")
