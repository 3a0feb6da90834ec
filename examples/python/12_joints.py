"""Joints and springs between bodies: a reaction wheel on an isolator of six axes, a mast on a jack,
a dish on a gimbal whose elevation a closed triangle of links gives, a tuned mass damper along one
axis of the mast's tip. As examples/12_joints.cpp."""
from math import pi

import numpy as np
import titop
from titop import LoopStep, RigidBody, about, along

x, y, z = [1, 0, 0], [0, 1, 0], [0, 0, 1]
iso_k = np.array([3e4, 3e4, 6e4, 220, 220, 150])  # [N/m; N m/rad]
iso_c = np.array([25, 25, 40, 0.2, 0.2, 0.1])
jack_k, jack_c = 8e4, 60  # [N/m], [N s/m]
gimbal_k, gimbal_c = [900, 1400], 0.8  # [N m/rad], [N m s/rad]
base, arm, strut = 0.40, 0.30, 0.35  # triangle that turns the dish about y [m]


def dish_posture():
    """Elevation at which the strut closes the triangle."""
    return titop.posture([LoopStep(about(y, "elevation"), guess=1, link=[arm, 0, 0]),
                          LoopStep(about(y, "strut top"), guess=2),
                          LoopStep(along(x, "strut"), given=strut),
                          LoopStep(about(y, "strut foot"), guess=2, link=[-base, 0, 0])])


def satellite(isolated):
    d = titop.Diagram("satellite")
    w = d.input("w", 6)  # of the wheel on its own frame: imbalance and bearing noise
    u = d.input("u")  # force of the jack on the mast
    hub = d.add("hub", RigidBody(mass=120, inertia=[20, 25, 18],
                                 children={"W": [0.2, -0.3, 0.1], "M": [0.6, 0, 0],
                                           "D": [-0.5, 0.1, 0.3]}))
    wheel = d.add("wheel", RigidBody(mass=6, inertia=[0.03, 0.03, 0.05], children={"rotor": None}))
    mast = d.add("mast", titop.FlexibleBody(
        titop.Beam(length=1.6, section=titop.tube(0.05, 0.045),
                   material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=2)))
    dish = d.add("dish", RigidBody(mass=8, inertia=[1, 1, 1.6], PA=[0, 0, 0.25]))
    damper = d.add("damper", titop.SpringMass(mass=0.2, stiffness=60, damping=0.9))
    titop.release(hub)

    tilt = titop.Rotation.about([1, 1, 0], 0.6)
    wheel.child.force = w
    if isolated:
        titop.bushing(d, "isolator", wheel, hub.child["W"], tilt,
                      titop.Bushing(stiffness=np.diag(iso_k), damping=np.diag(iso_c)))
    else:
        titop.mount(wheel, hub.child["W"], tilt)

    jack = titop.slide(d, "jack", mast, hub.child["M"], titop.Rotation(), x)
    jack.force = jack_k * jack.travel + jack_c * jack.rate - u

    gimbal = titop.joint(d, "gimbal", dish, hub.child["D"], dish_posture().T_ba[0],
                         [about(x, "roll"), about(y, "pitch")])
    roll, pitch = gimbal.axis("roll"), gimbal.axis("pitch")
    roll.force = gimbal_k[0] * roll.position + gimbal_c * roll.rate
    pitch.force = gimbal_k[1] * pitch.position + gimbal_c * pitch.rate

    titop.mount(damper, mast.child.along(z))

    d.output["hub"] = hub.parent.accel
    d.output["dish"] = dish.parent.accel.angular
    d.output["travel"] = jack.travel
    return d


def jitter(isolated, hertz):
    """Largest angular acceleration of the dish per force of the wheel across its axis."""
    G = titop.compile(satellite(isolated)).transfer(2j * pi * hertz)
    return abs(G[6:9, 0:2]).max()


print(f"elevation {dish_posture().values[0] * 180 / pi:.4f} deg")
try:
    titop.posture([LoopStep(about(y, "elevation"), link=[arm, 0, 0]), LoopStep(about(y)),
                   LoopStep(along(x, "strut"), given=base + arm + 0.1),
                   LoopStep(about(y, "strut foot"), link=[-base, 0, 0])])
except titop.Error as error:
    print(f"a strut of 0.8 m: {error.mistakes[0].code}")

for isolated, mounting in (True, "on its isolator"), (False, "fixed to the hub"):
    print(f"wheel {mounting}:")
    order = titop.compile(satellite(isolated)).state_space().order
    print(f"  order {order}, coordinates beside the rigid motion: {order // 2}")
print("jitter of the dish, isolated over fixed:",
      *(f" {f} Hz {jitter(True, f) / jitter(False, f):.3g}" for f in (2, 10, 30, 100)))
