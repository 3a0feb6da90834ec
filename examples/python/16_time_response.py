"""Time responses: a boom on a hub is turned by 14.5 degrees with a torque of two pulses, then
without torque. Three ways to step, and the error for a step that is too long. As
examples/16_time_response.cpp."""
import titop


def slewing_boom():
    d = titop.Diagram("slewing boom")
    torque = d.input("torque", 3)  # [N m]
    hub = d.add("hub", titop.RigidBody(mass=400, inertia=[80, 90, 100], children={"C": [1, 0, 0]}))
    boom = d.add("boom", titop.FlexibleBody(
        titop.Beam(length=8.0, section=titop.rectangle(0.05, 0.05),
                   material=titop.Material(E=70e9, nu=0.33, rho=2700), elements=6,
                   modes=titop.fe.ModeOptions(kept=8, xi=[0.002]))))
    titop.mount(boom, hub.child["C"])
    hub.parent.force.linear = 0
    hub.parent.force.angular = -torque
    d.output["attitude"] = hub.parent.position.angular  # [rad]
    d.output["tip"] = boom.child.accel.along([0, 1, 0])  # [m/s^2]
    return d


system = titop.compile(slewing_boom())
# [N m]: 20 s forwards, 20 s backwards; a jump is two equal times.
slew = titop.Excitation.recorded([0, 20, 20, 40, 40, 60],
                                 [[0] * 6, [0] * 6, [1, 1, -1, -1, 0, 0]])

print(f"{system.order} states; torque about z +1, -1, 0 N m\n")
print("   t [s]   attitude [mrad]   tip [mm/s^2]")
exact = titop.simulate(system, slew, step=0.1, until=60)
for k in range(0, 601, 100):
    print(f"{exact.time[k]:8.1f} {1e3 * exact.y[2, k]:17.4f} {1e3 * exact.y[3, k]:14.4f}")

print("\nthe attitude at 60 s by other steps [mrad]:")


def attitude(stepper, step):
    return 1e3 * titop.simulate(system, slew, step=step, until=60, stepper=stepper).y[2, -1]


print(f"exact,    0.1 s   {attitude('exact', 0.1):.6f}")
print(f"exact,    5 s     {attitude('exact', 5):.6f}")
print(f"midpoint, 0.1 s   {attitude('midpoint', 0.1):.6f}")
try:
    attitude("rk4", 0.1)
except titop.Error as error:
    print(f"\n{error}")
