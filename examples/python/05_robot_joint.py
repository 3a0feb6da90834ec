"""A hinge adds one channel, (acceleration, torque) about its axis: torque = 0 leaves it free, accel
= u drives it, torque = K(s) of its own angle and rate is a mechanism. As
examples/05_robot_joint.cpp."""
import titop

k, c = 800, 6  # spring [N m/rad] and damper [N m s/rad] of the motor
gain, lead, corner = 900, 12, 150  # controller: gain + lead s / (1 + s / corner)
axis = [0, 1, 0]  # of the elbow, in the forearm's frame
elbow_angle = 0.8  # posture, about y [rad]


def arm(length):
    return titop.FlexibleBody(
        titop.Beam(length=length, section=titop.tube(0.04, 0.03),
                   material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=2))


def robot(kind):
    d = titop.Diagram("robot")
    W = d.input("W", 6)  # wrench on the hand, in the forearm's frame
    upper = d.add("upper", arm(0.8))
    forearm = d.add("forearm", arm(0.6))
    elbow = titop.hinge(d, "elbow", forearm, upper.child, titop.Rotation.about(axis, elbow_angle),
                        axis)
    titop.ground(upper)
    forearm.child.force = W
    d.output["xdd"] = forearm.child.accel

    if kind == "free":
        elbow.torque = 0
    elif kind == "driven":
        elbow.accel = d.input("thetadd")  # the angle follows a given motion ...
        d.output["C_m"] = elbow.torque  # ... and this torque is required
    elif kind == "spring, damper and motor":  # gear and friction, and the motor's torque u
        elbow.torque = k * elbow.angle + c * elbow.rate - d.input("u")
    else:
        K = d.add("K", titop.Lti(A=[[-corner]], B=[[corner]], C=[[-lead * corner]],
                                 D=[[gain + lead * corner]]))
        K.in_ = elbow.angle
        elbow.torque = K.out - d.input("u")
    if kind != "driven":
        d.output["theta"] = elbow.angle
    return d


for kind in "free", "driven", "spring, damper and motor", "controller":
    system = titop.compile(robot(kind))
    poles = system.poles()
    print(f"{kind}: order {system.state_space().order}, {sum(p.damping > 1e-6 for p in poles)} "
          f"poles are damped, {sum(p.damping < -1e-6 for p in poles)} grow")
    slowest = [p for p in poles if p.omega > 0][:4]
    print("  slowest [rad/s, damping]:",
          *(f"{p.omega:.5g} ({p.damping if abs(p.damping) >= 1e-6 else 0:.4f})" for p in slowest))
