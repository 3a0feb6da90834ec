"""The margins of an attitude loop: the satellite's hub is turned by a PD law per axis with an
actuator's lag and a delay. The loop is cut where the law's torque enters, three axes at once. As
examples/27_margins.cpp."""
import numpy as np
import satellite
import titop

kp, kd, actuator, delay = 30, 45, 40, 0.02


def first_order(gain, pole, corner):
    """gain + pole / (s + corner) for each of three signals."""
    I = np.eye(3)
    return titop.Lti(A=-corner * I, B=I, C=pole * I, D=gain * I)


def late_block():
    """The delay of all three torques, by its Pade approximation of one state."""
    one, I = titop.pade(delay, 1), np.eye(3)
    return titop.Lti(A=one.A * I, B=one.B * I, C=one.C * I, D=one.D * I)


def controlled(beam):
    d = titop.Diagram("controlled")
    T = d.input("T", 3)  # disturbance on the hub [N m]
    gain = d.param("gain", 1.0)
    hub = d.add("hub", titop.RigidBody(**satellite.hub_spec))
    boom1, boom2 = d.add("boom1", beam), d.add("boom2", beam)
    law = d.add("law", first_order(kd * actuator, (kp - kd * actuator) * actuator, actuator))
    late = d.add("late", late_block())
    titop.mount(boom1, hub.child["C1"], satellite.turn1)
    drive = titop.hinge(d, "drive", boom2, hub.child["C2"], satellite.turn2, satellite.hinge_axis)
    drive.torque = satellite.kappa * drive.angle + satellite.c * drive.rate
    law.in_ = hub.parent.position.angular
    late.in_ = law.out
    hub.parent.force.linear = 0
    hub.parent.force.angular = -T + gain * d.loop_point("torque", late.out)
    d.output["attitude"] = hub.parent.position.angular
    return d


system = titop.compile(controlled(satellite.beam(kept=6)))
torque = titop.loop(system, "torque")
m = titop.margins(torque)
print(m, end="")

allowed = min(loop.larger_gain.value for loop in m.loops)
twice = titop.margins(titop.loop(system.update({"gain": 2 * allowed}), "torque"))
print(f"\nat {2 * allowed:.2f} times the gain: {twice}", end="")

titop.plot_nyquist(torque).write("nyquist.svg")
titop.plot_bode(torque.L, "torque(3)", "torque(3)").write("bode.svg")
titop.plot_poles(system, band_hz=[0, 20]).write("poles.svg")
