"""A telecommunication satellite from its files to the margins of its law: yokes from finite-element
data, wings of three panels, wheels, liquid and a law in one model; a small model of the structure
for the frequencies of the loop; the law's margins, continuous and sampled. As
examples/30_telecom.cpp, which also runs the law as generated C++."""
from math import pi

import numpy as np
import satellite
import titop
from titop import fe

I = np.eye(3)
axes = ["(1)", "(2)", "(3)"]
hub_spec = titop.RigidBody(mass=1800, inertia=[1500, 900, 1700],
                           children={"north": [0, 1.1, 0.1], "south": [0, -1.1, 0.1],
                                     "tank": [0, 0, -0.5], "wheels": [0.3, 0, 0.4]})
panel = titop.Plate(a=1.5, b=2.4, thickness=0.02, material=titop.Material(rho=150),
                    D=titop.PlateStiffness(900, 270, 600, 250), elements=[4, 6])
hinge_k, hinge_c = 60, 0.3  # between panels [N m/rad], [N m s/rad]
drive_k, drive_c = 900, 1  # holding torque [N m/rad], [N m s/rad]
wheel_momentum = 20  # of the wheel about y [N m s]
kp, kd = np.array([30, 20, 35]), np.array([300, 190, 340])  # per axis [N m/rad], [N m s/rad]
lag, period = 4, 0.1  # of the law's filters [rad/s]; of the law on board [s]


def law_block():
    """(kp + kd s) / (s / lag + 1)^2 per axis, from angles to torques."""
    P, D, O = np.diag(kp), lag * np.diag(kd), np.zeros((3, 3))
    return titop.Lti(A=np.block([[-lag * I, O], [lag * I, -lag * I]]),
                     B=np.vstack([lag * I, O]), C=np.hstack([D, P - D]))


def read_yoke():
    mesh = fe.read_calculix(satellite.data / "calculix_beam/beam_free_mat",
                            {"P": 900001, "C": 900003})
    modes = fe.ModeOptions(kept=2, residual=["C"], xi=[0.01])
    return titop.FlexibleBody(fe.modal_data(mesh, "P", ["C"], modes))


def sandwich_panel():
    """A panel between its two long edges, which are stiff, with its lowest modes."""
    mesh = fe.plate_mesh(panel)
    mesh = fe.with_interface(mesh, "inner", fe.rigid(fe.edge(mesh, "x0")))
    mesh = fe.with_interface(mesh, "outer", fe.rigid(fe.edge(mesh, "x1")))
    modes = fe.ModeOptions(kept=3, xi=[0.003])
    return titop.FlexibleBody(fe.modal_data(mesh, "inner", ["outer"], modes))


def add_wing(d, side, site, turn, yoke_body, panel_body):
    """Yoke on a drive, and three panels hinged one to the other, outward along the yoke's x."""
    yoke = d.add(f"{side} yoke", yoke_body)
    drive = titop.hinge(d, f"{side} drive", yoke, site, titop.Rotation.about([0, 0, 1], turn),
                        [1, 0, 0])
    drive.torque = drive_k * drive.angle + drive_c * drive.rate
    inner = d.add(f"{side} panel 1", panel_body)
    titop.mount(inner, yoke.child["C"])
    for i in 2, 3:
        outer = d.add(f"{side} panel {i}", panel_body)
        h = titop.hinge(d, f"{side} hinge {i}", outer, inner.child["outer"], titop.Rotation(),
                        [0, 1, 0])
        h.torque = hinge_k * h.angle + hinge_c * h.rate
        inner = outer


def telecom(yoke, factor=1.0):
    """Inputs T (3), a disturbing torque on the hub, and command (3), torques on the hub by the
    wheels; the law acts with a factor, the parameter "gain"."""
    d = titop.Diagram("telecom satellite")
    T, command = d.input("T", 3), d.input("command", 3)
    gain = d.param("gain", factor)
    hub, panel_body = d.add("hub", hub_spec), sandwich_panel()
    add_wing(d, "north", hub.child["north"], pi / 2, yoke, panel_body)
    add_wing(d, "south", hub.child["south"], -pi / 2, yoke, panel_body)
    titop.slosh(d, "liquid", hub.child["tank"], titop.Slosh(mass=120, stiffness=20, damping=1.5))
    law = d.add("law", law_block())
    law.in_ = hub.parent.position.angular
    torque = d.loop_point("torque", law.out)
    for i, name in enumerate("xyz"):
        wheel = d.add(f"wheel {name}", titop.Rotor(mass=6, axial=0.06, transverse=0.035, axis=I[i],
                                                   momentum=wheel_momentum if name == "y" else 0))
        titop.mount(wheel, hub.child["wheels"])
        wheel.torque = I[i:i + 1] @ command - gain * (I[i:i + 1] @ torque)
    hub.parent.force.linear = 0
    hub.parent.force.angular = -T
    d.output["attitude"] = hub.parent.position.angular
    return d


def attitude_law():
    d = titop.Diagram("law")
    attitude = d.input("attitude", 3)  # [rad]
    law = d.add("law", law_block())
    law.in_ = attitude
    d.output["command"] = -law.out  # [N m]
    return d


def with_law(structure):
    """The law around this model of the structure."""
    d = titop.Diagram("loop")
    A, B, C, D = structure
    plant = d.add("structure", titop.Lti(A=A, B=B, C=C, D=D))
    law = d.add("law", law_block())
    law.in_ = plant.out
    plant.in_ = -d.loop_point("torque", law.out)
    return d


def sampled_loop(structure):
    """L with the law as it runs on board."""
    A, B, C, D = titop.compile(attitude_law()).state_space()
    law = titop.StateSpace(A, B, -C, -D)  # its output is the torque that the wheels exert
    return titop.series(titop.discretize(structure, period), titop.discretize(law, period))


def print_margins(name, m):
    print(f"{name}: {'stable' if m.stable else 'NOT stable'}")
    for axis, l in zip("xyz", m.loops):
        print(f"  {axis}: gain {20 * np.log10(l.larger_gain.value):.1f} dB, phase "
              f"{np.degrees(l.phase.value):.1f} deg, delay {l.delay.value:.2f} s, disk "
              f"{l.disk.alpha:.2f} at {l.disk.omega:.2f} rad/s")


yoke = read_yoke()
system = titop.compile(telecom(yoke), minimize_up_to=0)
small = titop.compile(telecom(yoke, 0.0), titop.Scene(
    inputs=["command" + a for a in axes], outputs=["attitude" + a for a in axes],
    band_hz=[0.01, 4], accuracy=1e-3))
structure = small.state_space()
torque = titop.loop(titop.compile(with_law(structure)), "torque")
m, sampled = titop.margins(torque), titop.margins(sampled_loop(structure))
print(f"structure from 0.01 to 4 Hz: {small.order} states")
print_margins("the law", m)
print_margins("the law every 0.1 s", sampled)

# As by the flight code: a torque of 0.1 N m about each axis from time 0 on.
law = titop.discretize(titop.compile(attitude_law()).state_space(), period)
push = titop.Excitation.step(titop.input_values(system, {"T(1)": 0.1, "T(2)": 0.1, "T(3)": 0.1}))
t = titop.simulate(system.update({"gain": 0.0}), titop.Excitation.sampled(law, push),
                   step=period, until=300)
for k in 100, 300, 1000, 3000:
    print("  t = {:3.0f} s  {:5.2f} {:5.2f} {:5.2f} mrad".format(k * period, *(1e3 * t.y[:, k])))
