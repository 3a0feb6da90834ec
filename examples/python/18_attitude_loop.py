"""No more states than the scene needs, with a controller in the loop: the satellite's hub is
controlled by a law with an actuator and a delay. States are balanced; the error has a bound. As
examples/18_attitude_loop.cpp."""
import numpy as np
import satellite
import titop

# Torque = (kp + kd s) / (s / actuator + 1) (1 - s delay / 2) / (1 + s delay / 2) times the attitude
# error, for each axis.
kp, kd, actuator, delay = 30, 45, 40, 0.02


def first_order(gain, pole, corner):
    """gain + pole / (s + corner) for each of three signals."""
    I = np.eye(3)
    return titop.Lti(A=-corner * I, B=I, C=pole * I, D=gain * I)


def controlled(beam):
    d = titop.Diagram("controlled")
    T = d.input("T", 3)  # disturbance on the hub [N m]
    wanted = d.input("wanted", 3)  # attitude [rad]
    hub = d.add("hub", titop.RigidBody(**satellite.hub_spec))
    boom1, boom2 = d.add("boom1", beam), d.add("boom2", beam)
    law = d.add("law", first_order(kd * actuator, (kp - kd * actuator) * actuator, actuator))
    late = d.add("late", first_order(-1, 4 / delay, 2 / delay))
    titop.mount(boom1, hub.child["C1"], satellite.turn1)
    drive = titop.hinge(d, "drive", boom2, hub.child["C2"], satellite.turn2, satellite.hinge_axis)
    drive.torque = satellite.kappa * drive.angle + satellite.c * drive.rate
    law.in_ = wanted - hub.parent.position.angular
    late.in_ = law.out
    hub.parent.force.linear = 0
    hub.parent.force.angular = -T - late.out
    d.output["attitude"] = hub.parent.position.angular
    d.output["torque"] = late.out
    d.output["tip2"] = boom2.child["C"].accel.linear
    return d


d = controlled(satellite.beam())
scene = titop.Scene(band_hz=[0, 20], accuracy=1e-3)
r = titop.compile(d, scene)
print(f"{d.name}: {r.order} states instead of {r.full.order}")
for step in r.steps:
    print(f"  {step.name}: {step.before} -> {step.after}\n    {step.text}")
print(f"bound below 1e-3: {'yes' if r.bound.worst <= scene.accuracy else 'NO'}")
stable = all(p.s.real < 0 for p in r.state_space().poles())
print(f"stable as the loop is: {'yes' if stable else 'NO'}")

print("\naccuracy  states")
for w in titop.what_if(d, scene, [1e-1, 1e-2, 1e-3, 1e-4]):
    print(f"{w.accuracy:8.0e}  {w.order:6}")

try:
    r.second_order()
except titop.Error as error:
    print(f"\n{error}")
