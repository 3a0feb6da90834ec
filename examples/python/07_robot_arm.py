"""An arm of three flexible links: joints and links are added in a loop, and each joint brings its
spring, its damper and its motor. As examples/07_robot_arm.cpp."""
import titop

# length and diameter [m] of a tube with walls of 10 %; axis of the joint before it, in the link's
# frame, and its posture about it [rad]; drive [N m/rad], [N m s/rad]
links = [(0.5, 0.08, [0, 0, 1], 0.3, 2e4, 20),  # yaw
         (0.7, 0.06, [0, 1, 0], -0.9, 1e4, 10),  # pitch
         (0.6, 0.04, [0, 1, 0], 1.2, 3e3, 2)]  # pitch


def robot_arm():
    d = titop.Diagram("robot arm")
    base = d.add("base", titop.RigidBody(children={"J1": None}))
    titop.ground(base)
    site = base.child["J1"]
    joints = []
    for i, (length, diameter, axis, posture, k, c) in enumerate(links, 1):
        link = d.add(f"link{i}", titop.FlexibleBody(
            titop.Beam(length=length, section=titop.tube(diameter, 0.8 * diameter),
                       material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=2)))
        joint = titop.hinge(d, f"joint{i}", link, site, titop.Rotation.about(axis, posture), axis)
        joint.torque = k * joint.angle + c * joint.rate - d.input(f"tau{i}")
        joints.append(joint)
        site = link.child["C"]
    d.output["hand"] = site.accel  # in the last link's frame
    for i, joint in enumerate(joints, 1):
        d.output[f"theta{i}"] = joint.angle
    return d


system = titop.compile(robot_arm())
model = system.state_space()
print(f"order {model.order}, {len(model.inputs)} inputs, {len(model.outputs)} outputs; the slow "
      f"poles\n{system.poles()[:6]}", end="")
