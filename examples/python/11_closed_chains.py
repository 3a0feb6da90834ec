"""Closed chains: a four-bar mechanism of three flexible links on free pins, its crank turned by a
motor through a shaft. The last joint closes the chain. Then the same chain of rigid links. As
examples/11_closed_chains.cpp."""
from math import pi

import titop

SHAFT = 5e4  # [N m/rad]
z = [0, 0, 1]


def turn(angle):
    return titop.Rotation.about(z, angle)


def four_bar(crank_body, coupler_body, rocker_body, b):
    """A parallelogram; coupler along x, of length b [m]."""
    d = titop.Diagram("four-bar")
    motor = d.input("motor")  # turns the crank [N m]
    base = d.add("base", titop.RigidBody(mass=1, children={"J1": None, "J2": [b, 0, 0]}))
    crank = d.add("crank", crank_body)
    coupler = d.add("coupler", coupler_body)
    rocker = d.add("rocker", rocker_body)
    titop.ground(base)
    shaft = titop.hinge(d, "shaft", crank, base.child["J1"], turn(pi / 2), z)
    titop.hinge(d, "p2", coupler, crank.child, turn(-pi / 2), z).torque = 0
    titop.hinge(d, "p3", rocker, base.child["J2"], turn(pi / 2), z).torque = 0
    p4 = d.add("p4", titop.Hinge(z))
    titop.mount(p4, rocker.child, turn(-pi / 2))
    titop.weld(coupler.child, p4.child)  # closes the chain
    p4.torque = 0
    shaft.torque = SHAFT * shaft.angle - motor
    d.output["tip"] = coupler.child.position.linear  # [m]
    d.output["speed"] = shaft.rate  # [rad/s]
    return d


def tube(length):
    return titop.FlexibleBody(
        titop.Beam(length=length, section=titop.tube(0.04, 0.03),
                   material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=3))


def rod(length, mass):
    inertia = mass * length * length / 12
    return titop.FlexibleBody(
        titop.RigidBody(mass=mass, inertia=[0, inertia, inertia], PA=[length / 2, 0, 0],
                        children={"C": [length, 0, 0]}))


def print_chain(system):
    for note in system.notes:
        if note.pass_ in ("chains", "close"):
            print(f"  {note.text}")


a, b, m, m_coupler = 0.4, 0.9, 1.5, 2.5
soft = titop.compile(four_bar(tube(a), tube(b), tube(a), b), minimize_up_to=0)
print(f"flexible links: order {soft.order}")
print_chain(soft)

rigid = titop.compile(four_bar(rod(a, m), rod(b, m_coupler), rod(a, m), b))
print(f"rigid links: order {rigid.order}")
print_chain(rigid)
print(rigid.poles(), end="")
