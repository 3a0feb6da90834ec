"""Co-design: the stiffness and damper of a boom's root, the place of the wing and the gains of the
attitude law are chosen together, for the least mass within three bounds. NLopt's SLSQP (package
python3-nlopt) uses the exact derivatives of the three models. As examples/20_codesign.cpp, which
also compares the gradients with differences in 50 digits."""
import nlopt
import numpy as np
import titop

# Design variables, relative to: stiffness of the root, its damper, distance of the root from the
# hub's centre, gains of the attitude law.
reference = np.array([2400.0, 60.0, 1.0, 120.0, 300.0])
names = ["k", "c", "y", "kp", "kd"]
least, most, start = np.array([0.02, 0.02, 0.6, 0.02, 0.02]), 6, 1.5
panel, lag = 40, 4  # [kg], actuator of the law [rad/s]
bounds = {"pointing": 2.6e-3, "sensitivity": 1.6, "frequency": 4}  # [rad], [-], [rad/s]


def boom_mass(x):
    return 9 * np.sqrt(x)


def mass_of(x):
    """Mass of the structure that a design needs [kg], and its gradient."""
    return (boom_mass(x[0]) + 0.3 * x[1] + x[2] + 2 * x[3] + 6 * x[4],
            np.array([4.5 / np.sqrt(x[0]), 0.3, 1, 2, 6]))


def satellite(question):
    """A free hub whose attitude is controlled about all axes; the wing lies in its plane z = 0."""
    d = titop.Diagram("satellite")
    k, c, y, kp, kd = (d.param(name, value) for name, value in zip(names, reference))
    m = d.param("m", panel + boom_mass(1.0))
    up, about, I = [0, 0, 1], np.array([[0.0], [0.0], [1.0]]), np.eye(3)
    hub = d.add("hub", titop.RigidBody(mass=600, inertia=[200, 200, 250],
                                       children={"wing": [0, y, 0]}))
    wing = d.add("wing", titop.RigidBody(mass=m, inertia=[60, 1, 60], PA=[0, 3, 0]))
    root = titop.hinge(d, "root", wing, hub.child["wing"], titop.Rotation(), up)
    root.torque = k * root.angle + c * root.rate
    T = d.input("T")  # disturbing torque about z [N m]
    hub.parent.force.linear = 0
    if question == "frequency":
        hub.parent.force.angular = -about @ T
        d.output["accel"] = hub.parent.accel.about[up]
        return d
    law = d.add("law", titop.Lti(A=-lag * I, B=lag * I, C=I))
    law.in_ = kp * hub.parent.position.angular + kd * hub.parent.rate.angular
    hub.parent.force.angular = law.out - about @ T
    if question == "pointing":
        d.output["angle"] = hub.parent.position.angular.along(up)  # [rad]
    else:
        d.output["torque"] = T - about.T @ law.out  # sensitivity
    return d


models = {question: titop.compile(satellite(question)) for question in bounds}


def constraints(x):
    """g <= 0, relative to the bounds, and a row of the gradient for each."""
    m = panel + boom_mass(x[0])
    values = {**dict(zip(names, x * reference)), "m": m}
    slopes_of = {q: titop.derivatives(s.update(values), [*values]) for q, s in models.items()}

    def by_design(by_parameter):  # m follows from the stiffness
        gradient = by_parameter[:5] * reference
        gradient[0] += by_parameter[5] * 4.5 / np.sqrt(x[0])
        return gradient

    h2, peak = slopes_of["pointing"].h2(), slopes_of["sensitivity"].peak()
    wing = slopes_of["frequency"].poles()[-1]
    turn = np.array([slope[0].imag for slope in wing.slopes])
    pointing, sensitivity, frequency = bounds.values()
    return (np.array([h2.value / pointing - 1, peak.value / sensitivity - 1,
                      1 - wing.s.imag / frequency]),
            np.array([by_design(h2.slopes / pointing), by_design(peak.slopes / sensitivity),
                      by_design(-turn / frequency)]))


def objective(x, gradient):
    mass, slopes = mass_of(x)
    if gradient.size:
        gradient[:] = slopes
    return mass


def inequality(g, x, gradient):
    g[:], slopes = constraints(x)
    if gradient.size:
        gradient[:] = slopes


search = nlopt.opt(nlopt.LD_SLSQP, 5)
search.set_lower_bounds(least)
search.set_upper_bounds(most)
search.set_min_objective(objective)
search.add_inequality_mconstraint(inequality, np.full(3, 1e-10))
search.set_xtol_rel(1e-12)
search.set_maxeval(200)
x = search.optimize(np.full(5, start))

print(f"least mass {mass_of(x)[0]:.3f} kg, from {mass_of(np.full(5, start))[0]:.3f} kg at the start")
for text, value in zip(["stiffness of the root [N m/rad]", "damper [N m s/rad]",
                        "place of the wing [m]", "gain of the angle [N m/rad]",
                        "gain of the rate [N m s/rad]"], x * reference):
    print(f"  {text:<34} {value:9.4g}")
g, gradients = constraints(x)
for name, value in zip(bounds, g):
    print(f"  {name:<12} {'at its bound' if value > -1e-8 else 'below its bound'}")

# Multipliers of the active constraints and bounds by least squares.
mass, active = mass_of(x)[1], [row for row, value in zip(gradients, g) if value > -1e-8]
active += [-row for row, at, low in zip(np.eye(5), x, least) if at < low + 1e-8]
G = np.array(active).T
multipliers = np.linalg.lstsq(G, -mass, rcond=None)[0]
residual = np.linalg.norm(mass + G @ multipliers) / np.linalg.norm(mass)
holds = residual <= 1e-6 and min(multipliers) >= 0 and max(g) <= 1e-8
print(f"conditions of Karush, Kuhn and Tucker: to 1e-6 {'yes' if holds else 'NO'}")
