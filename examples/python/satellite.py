"""The satellite of the demo: a rigid hub, two booms, one of them on a hinge with a motor. As
examples/scenes/satellite.cpp."""
import pathlib
from math import pi

import titop

data = pathlib.Path(__file__).parent.parent / "data"
hub_spec = dict(mass=85, inertia=[9, 11, 13], PA=[0.02, -0.01, 0.05],  # [kg], [kg m^2], [m]
                children={"C1": [0.35, 0, 0.1], "C2": [-0.35, 0.05, 0.1]})
kappa, c = 60, 0.8  # hinge spring [N m/rad] and damper [N m s/rad]
hinge_axis = [0, 1, 0]  # in the boom's frame: across it
turn1, turn2 = titop.Rotation.about([0, 0, 1], pi / 12), titop.Rotation.about([1, 2, 9], 2.9)


def read_boom():
    """A beam from real finite-element data, 342 modes: six are kept, and the static response to a
    motion of its root. Damping 0.5 %."""
    mesh = titop.fe.read_calculix(data / "calculix_beam/beam_free_mat", {"P": 900001, "C": 900003})
    modes = titop.fe.ModeOptions(kept=6, residual=["P"], xi=[0.005])
    return titop.FlexibleBody(titop.fe.modal_data(mesh, "P", ["C"], modes))


def beam(**modes):
    """A boom of 2 m by beam elements."""
    return titop.FlexibleBody(
        titop.Beam(length=2, section=titop.rectangle(0.06, 0.04),
                   material=titop.Material(E=70e9, nu=0.33, rho=2700), elements=10,
                   modes=titop.fe.ModeOptions(xi=[0.005], **modes)))


def satellite(boom, law=None, damper=c):
    """`law`: (kp [N m/rad], kd [N m s/rad]), torque on the hub by its own attitude and rate."""
    d = titop.Diagram("satellite")
    W = d.input("W", 6)  # wrench on the hub at P [N; N m]
    tau_m = d.input("tau_m")  # torque of the motor on boom 2 [N m]
    hub = d.add("hub", titop.RigidBody(**hub_spec))
    boom1 = d.add("boom1", boom)
    boom2 = d.add("boom2", boom)
    hub.parent.force = -W
    titop.mount(boom1, hub.child["C1"], turn1)
    drive = titop.hinge(d, "drive", boom2, hub.child["C2"], turn2, hinge_axis)
    drive.torque = kappa * drive.angle + damper * drive.rate - tau_m
    if law:
        kp, kd = law
        hub.parent.force.angular += (kp * hub.parent.position.angular
                                     + kd * hub.parent.rate.angular)

    d.output["hub"] = hub.parent.accel  # [m/s^2; rad/s^2]
    d.output["tip1"] = boom1.child["C"].accel
    d.output["tip2"] = boom2.child["C"].accel
    d.output["theta"] = drive.angle  # [rad]
    return d
