"""A solar array of three panels on a yoke, hinged along their whole edges, which move by a few
polynomials, or are measured by them: two models, between which each frequency of the array with
hinges at every node lies. As examples/28_solar_array.cpp, which also compares it with the matrices
of all meshes, put together by hand."""
import titop
from titop import fe

polynomials, kept = 3, 6  # of each edge; modes of each panel
hinge_k, hinge_c = 60, 0.3  # [N m/rad], [N m s/rad]
hub_spec = titop.RigidBody(mass=450, inertia=[160, 140, 180], children={"array": [0.7, 0, 0]})
yoke_spec = titop.Beam(length=0.9, section=titop.tube(0.06, 0.056),
                       material=titop.Material(E=70e9, nu=0.33, rho=2700), elements=2)
panel_spec = titop.Plate(a=1.5, b=2.4, thickness=0.02, material=titop.Material(rho=150),
                         D=titop.PlateStiffness(900, 270, 600, 250), elements=[4, 6])


def panel(first, lumping):
    """Parent "yoke" along the middle third of its edge, or "inner" along all of it; child "outer".
    """
    mesh, parent = fe.plate_mesh(panel_spec), "yoke" if first else "inner"
    stiff = lumping == "constrained"
    along, point = (fe.shapes, fe.rigid) if stiff else (fe.moments, fe.average)

    def line(edge):
        return along(fe.edge(mesh, edge), fe.legendre(polynomials))

    if first:
        mesh = fe.with_interface(mesh, parent, point(fe.segment(mesh, "x0", 1 / 3, 2 / 3)))
    else:
        mesh = fe.with_interface(mesh, parent, line("x0"))
    mesh = fe.with_interface(mesh, "outer", line("x1"))
    modes = fe.ModeOptions(kept=kept, residual=[parent, "outer"], xi=[0.002])
    return titop.FlexibleBody(fe.modal_data(mesh, parent, ["outer"], modes))


def satellite(lumping):
    """Wrench W on the hub; its acceleration."""
    d = titop.Diagram("satellite")
    W = d.input("W", 6)  # [N; N m]
    hub = d.add("hub", hub_spec)
    yoke = d.add("yoke", titop.FlexibleBody(yoke_spec))
    p1 = d.add("p1", panel(True, lumping))
    titop.mount(yoke, hub.child["array"])
    titop.mount(p1, yoke.child)
    spec = panel(False, lumping)
    p2, p3 = d.add("p2", spec), d.add("p3", spec)
    h1 = titop.hinge_line(d, "h1", p2.line("inner"), p1.line("outer"))
    h2 = titop.hinge_line(d, "h2", p3.line("inner"), p2.line("outer"))
    h1.torque = hinge_k * h1.angle + hinge_c * h1.rate
    h2.torque = hinge_k * h2.angle + hinge_c * h2.rate
    hub.parent.force = -W
    d.output["hub"] = hub.parent.accel
    return d


bracket = titop.interface_bracket(satellite)
print(f"the slowest modes, edges by {polynomials} polynomials\n{bracket}", end="")
