"""An arm of two links, which are beams as the partial differential equations have them: in closed
form at every s, with all of their infinitely many modes. Its transfers are exact, and measure how
many elements and modes a finite model needs. As examples/29_exact_beam.cpp."""
import titop

material = titop.Material(E=70e9, nu=0.33, rho=2700)
damping = (0.02, 2e-5)  # [1/s], [s]
upper_spec = titop.ExactBeam(length=3, section=titop.tube(0.08, 0.07), material=material,
                             damping=damping)
lower_spec = titop.ExactBeam(length=2, section=titop.tube(0.05, 0.042), material=material,
                             damping=damping)
band_hz = [0, 50]


def arm(upper_link, lower_link):
    """The arm on a free hub, with links of any kind; the elbow is a hinge on a spring."""
    d, z = titop.Diagram("arm"), [0, 0, 1]
    hub = d.add("hub", titop.RigidBody(mass=60, inertia=[5, 6, 7], children={"arm": [0.4, 0, 0]}))
    upper, lower = d.add("upper", upper_link), d.add("lower", lower_link)
    hand = d.add("hand", titop.RigidBody(mass=3, inertia=[0.02, 0.02, 0.02]))
    hub.parent.force = -d.input("F", 6)  # [N; N m]
    titop.mount(upper, hub.child["arm"])
    elbow = titop.hinge(d, "elbow", lower, upper.child["C"], titop.Rotation.about(z, 0.7), z)
    elbow.torque = 900 * elbow.angle + 4 * elbow.rate
    titop.mount(hand, lower.child["C"])
    d.output["hub"] = hub.parent.accel
    d.output["hand"] = hand.parent.accel
    return d


def with_mesh(elements):
    """All modes of links of so many elements."""
    links = [titop.FlexibleBody(titop.with_elements(spec, elements))
             for spec in (upper_spec, lower_spec)]
    return titop.compile(arm(*links), minimize_up_to=0)


distributed = arm(upper_spec, lower_spec)
exact = titop.compile(distributed)
print("band: 0 to 50 Hz; errors against the distributed beams (estimates)")
for n in 2, 4, 8, 16:
    finite = with_mesh(n)
    worst = titop.compare(finite, exact, titop.Scene(band_hz=band_hz)).worst
    print(f"all modes, elements {n:2d}: {finite.order:3d} states, error {worst:.1e}")
for accuracy in 1e-2, 1e-3:
    reduced = titop.reduce_beams(distributed, titop.Scene(band_hz=band_hz, accuracy=accuracy))
    print(f"accuracy {accuracy:.0e}\n{reduced}", end="")

# The error of the refined mesh at the tip, extrapolated: it falls with h^4.
s = 2 + 60j
fine, coarse = (with_mesh(n).transfer(s)[7, 1] for n in (24, 12))
limit = fine + (fine - coarse) / 15
off = abs(limit / exact.transfer(s)[7, 1] - 1)
print(f"tip by hub at s = 2 + 60j, against the limit of meshes: to 1e-06 "
      f"{'yes' if off <= 1e-6 else 'NO'}")
