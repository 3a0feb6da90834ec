"""A compiled scene as a document: one HTML page to read on a screen, to print, and to hand over;
a notebook shows it inline. As examples/17_report.cpp."""
import titop


def antenna():
    """A hub with an antenna on a driven hinge."""
    d = titop.Diagram("antenna")
    W = d.input("W", 6)  # wrench on the hub [N; N m]
    tau = d.input("tau")  # torque of the motor [N m]
    hub = d.add("hub", titop.RigidBody(mass=120, inertia=[14, 12, 18], children={"C": [0.4, 0.1, 0.3]}))
    mast = d.add("mast", titop.FlexibleBody(
        titop.Beam(length=3, section=titop.tube(0.04, 0.036),
                   material=titop.Material(E=70e9, nu=0.33, rho=2700),
                   modes=titop.fe.ModeOptions(kept=4, residual=["C"], xi=[0.005]))))
    dish = d.add("dish", titop.RigidBody(mass=4, inertia=[0.3, 0.2, 0.2]))
    hub.parent.force = -W
    drive = titop.hinge(d, "drive", mast, hub.child["C"], titop.Rotation.about([1, 2, 9], 0.6), [0, 1, 0])
    drive.torque = 200.0 * drive.angle + 1.5 * drive.rate - tau
    titop.mount(dish, mast.child["C"])
    d.output["hub"] = hub.parent.accel
    d.output["dish"] = dish.parent.accel
    d.output["angle"] = drive.angle
    return d


report = titop.report(titop.compile(antenna()), title="Antenna on a driven hinge",
                      remark="For the design review.\nMast: tube 40 x 2 mm, 3 m; drive: 200 N m/rad.",
                      band_hz=[0.1, 200],
                      pairs=[("angle", "tau"), ("dish(3)", "tau"), ("dish(3)", "W(3)")])
report.write("report.html")
page = report.html
drawings, plots = page.count('<svg class="drawing"'), page.count('<figure class="plot"')
print(f"report.html: {page.count('<section')} sections, {drawings} diagrams, {plots} plots")
print(f"all checks hold: {'yes' if 'All checks hold' in page else 'no'}")
