"""A block is also a port-Hamiltonian system: the rate of its energy is the power supplied at its
ports minus the power dissipated by damping. The balance holds along any trajectory. As
examples/06_energy.cpp."""
from math import cos, exp, sin

import numpy as np
import titop


def integrate(s, h, steps, u):
    """Implicit midpoint rule, x+ = x + h f((x + x+) / 2): it keeps the balance exactly."""
    A, I = (s.J - s.R) @ s.Q, np.eye(len(s.Q))
    left = np.linalg.inv(I - h / 2 * A)
    x, supplied, dissipated = np.zeros(len(A)), 0.0, 0.0
    for i in range(steps):
        load = np.array(u((i + 0.5) * h))
        after = left @ ((I + h / 2 * A) @ x + h * (s.G @ load))
        middle = (x + after) / 2
        supplied += h * s.supplied(middle, load)
        dissipated += h * s.dissipated(middle)
        x = after
    return supplied, dissipated, s.energy(x)


def report(name, course):
    print("{}: supplied {:.6f} J, dissipated {:.6f} J, stored {:.6f} J".format(name, *course))


spring = titop.SpringMass(mass=2, stiffness=50, damping=0.3, parent_mass=0.5)
report("spring-mass", integrate(titop.port_hamiltonian(spring), 1e-3, 5000,
                                lambda t: [3 * sin(4 * t), 0.5 * cos(7 * t)]))  # [N], [m/s^2]

# With the modes of a beam: shaken at its root, pushed at its tip.
beam = titop.FlexibleBody(
    titop.Beam(length=1.5, section=titop.rectangle(0.04, 0.01),
               material=titop.Material(E=70e9, nu=0.33, rho=2700), elements=4,
               modes=titop.fe.ModeOptions(xi=[0.01])))


def loads(t):
    u = [0.0] * 12
    u[2] = 2 * sin(30 * t)  # force at the tip along z [N]
    u[7] = 4 * exp(-t)  # acceleration of the root along y [m/s^2]
    u[9] = 1.5 * cos(12 * t)  # and about x [rad/s^2]
    return u


b = titop.port_hamiltonian(beam)
report("beam", integrate(b, 2e-4, 10000, loads))
symmetric = np.all(b.R == b.R.T) and b.R.diagonal().min() >= 0
print(f"J is skew, R is {'symmetric and not negative' if symmetric else 'WRONG'}")
