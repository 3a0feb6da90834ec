"""Damping as test reports state it: `damping_of_assembly` makes a body of a wing in which each
assembled mode has the damping of the report, clamped on the bench or, of the whole spacecraft, in
orbit. As examples/23_damping.cpp."""
import titop

report = [(1.0, 0.003), (20.0, 0.005)]  # [Hz], [-]
hub_spec = titop.RigidBody(mass=300, inertia=[80, 90, 100], children={"W": [1, 0, 0]})


def add_wing(d):
    """Boom and tip mass as blocks; returns the boom, by which they are mounted."""
    boom = d.add("boom", titop.FlexibleBody(
        titop.Beam(length=5, section=titop.tube(0.05, 0.048),
                   material=titop.Material(E=70e9, nu=0.3, rho=2700),
                   modes=titop.fe.ModeOptions(kept=2, residual=["C"], xi=[0.003]))))
    tip = d.add("tip", titop.RigidBody(mass=12, inertia=[1, 1, 1], children={"C": None}))
    titop.mount(tip, boom.child["C"])
    return boom


def wing():
    """The same as one body, tested on a bench."""
    part = titop.Diagram("wing")
    add_wing(part)
    return titop.damping_of_assembly(part, "boom.parent", {"C": "tip.C"}, report)


def spacecraft():
    """The spacecraft as one body, tested in orbit."""
    part = titop.Diagram("spacecraft")
    hub = part.add("hub", hub_spec)
    titop.mount(add_wing(part), hub.child["W"])
    return titop.damping_of_assembly(part, "hub.parent", {"tip": "tip.C"}, report, "free")


def show(title, d, root):
    """The poles of the diagram, whose free body is `root`."""
    root.parent.force = -d.input("U", 6)
    d.output["accel"] = root.parent.accel
    print(f"{title}\n{titop.compile(d).poles()}", end="")


blocks, bench, orbit = titop.Diagram("blocks"), titop.Diagram("bench"), titop.Diagram("orbit")
hub, hub_of_bench = blocks.add("hub", hub_spec), bench.add("hub", hub_spec)
titop.mount(add_wing(blocks), hub.child["W"])
titop.mount(bench.add("wing", wing()), hub_of_bench.child["W"])
show("0.3 % of the boom's modes, clamped at its root", blocks, hub)
show("the report, of the wing on a bench", bench, hub_of_bench)
show("the report, of the spacecraft in orbit", orbit, orbit.add("spacecraft", spacecraft()))
