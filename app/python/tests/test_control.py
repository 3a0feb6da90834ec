"""The control engineer's functions against closed forms: loops and margins, norms, responses,
zeros, discrete models, delays, inputs by name."""
import math
import unittest

import numpy as np
import titop

K = 2.0


def first_order():
    """x' = r - K x, cut at the loop point "law": L = K / s."""
    d = titop.Diagram("first order")
    r = d.input("r")
    x = d.add("x", titop.Integrator())
    x.in_ = r - d.loop_point("law", K * x.out)
    d.output["y"] = x.out
    return titop.compile(d)


def lag(a):
    """1 / (s + a)."""
    return titop.StateSpace([[-a]], [[1]], [[1]], [[0]])


class Loops(unittest.TestCase):
    def test_margins_of_an_integrator(self):
        """|L| = 1 at K with -90 deg: a phase of pi / 2, a delay of pi / (2 K). S - T = (s - K) /
        (s + K): alpha = 2. |1 + L| > 1 falls to 1 at high frequencies."""
        system = first_order()
        self.assertEqual(titop.loop_points(system), ["law"])
        loop = titop.loop(system, "law")
        self.assertEqual(loop.points, ["law"])
        s = 0.3 + 1.7j
        for transfer, exact in (loop.L, K / s), (loop.S, s / (s + K)), (loop.T, K / (s + K)):
            self.assertAlmostEqual(transfer.transfer(s)[0, 0], exact, places=12)
        m = titop.margins(loop)
        law, = m.loops
        self.assertTrue(m.stable and m.nyquist.agree)
        self.assertEqual(law.larger_gain.value, math.inf)
        self.assertEqual(law.smaller_gain.value, 0)
        self.assertAlmostEqual(law.phase.value, math.pi / 2, places=9)
        self.assertAlmostEqual(law.delay.value, math.pi / (2 * K), places=9)
        self.assertAlmostEqual(law.delay.omega, K, places=9)
        self.assertAlmostEqual(law.nearest.value, 1, places=9)
        self.assertAlmostEqual(law.disk.alpha, 2, places=9)
        self.assertAlmostEqual(law.disk.phase, math.pi / 2, places=9)

    def test_a_delay_takes_its_part(self):
        """With the delay T the phase margin is pi / 2 - K T."""
        loop = titop.loop(first_order(), "law")
        law, = titop.margins(loop, delay=0.3).loops
        self.assertAlmostEqual(law.phase.value, math.pi / 2 - 0.3 * K, places=9)


class Norms(unittest.TestCase):
    def test_of_a_lag(self):
        """H2: 1 / sqrt(2 a); H-infinity: 1 / a at 0, 1 / |j w + a| over a band from w on."""
        self.assertAlmostEqual(titop.norm_h2(lag(3)), 1 / math.sqrt(6), places=14)
        peak = titop.norm_hinf(lag(3))
        self.assertAlmostEqual(peak.value, 1 / 3, places=12)
        self.assertEqual(peak.omega, 0)
        band = titop.norm_hinf(lag(3), band_hz=[4 / (2 * math.pi), 100])
        self.assertAlmostEqual(band.value, 1 / 5, places=12)
        self.assertAlmostEqual(band.omega, 4, places=12)

    def test_of_a_resonance(self):
        """1 / (s^2 + 2 z s + 1): 1 / (2 z sqrt(1 - z^2)) at sqrt(1 - 2 z^2), H2 1 / (2 sqrt(z))."""
        z = 0.05
        model = titop.StateSpace([[0, 1], [-1, -2 * z]], [[0], [1]], [[1, 0]], [[0]])
        peak = titop.norm_hinf(model)
        self.assertAlmostEqual(peak.value, 1 / (2 * z * math.sqrt(1 - z * z)), places=9)
        self.assertAlmostEqual(peak.omega, math.sqrt(1 - 2 * z * z), places=6)
        self.assertAlmostEqual(titop.norm_h2(model), 1 / (2 * math.sqrt(z)), places=12)


class Responses(unittest.TestCase):
    def test_bode(self):
        omega = [0.1, 2.0, 30.0]
        response = titop.bode(first_order(), "y", "r", omega)
        exact = 1 / (1j * np.array(omega) + K)
        self.assertEqual(response.omega.tolist(), omega)
        np.testing.assert_allclose(response.decibels, 20 * np.log10(abs(exact)), atol=1e-12)
        np.testing.assert_allclose(response.degrees, np.degrees(np.angle(exact)), atol=1e-12)

    def test_zeros(self):
        """(s + 3) / (s + 1)^2."""
        model = titop.StateSpace([[0, 1], [-1, -2]], [[0], [1]], [[3, 1]], [[0]])
        zero, = titop.transmission_zeros(model)
        self.assertAlmostEqual(zero, -3, places=12)

    def test_inputs_by_name(self):
        d = titop.Diagram("two")
        u, v = d.input("u", 2), d.input("v")
        d.output["y"] = u
        d.output["z"] = v
        system = titop.compile(d)
        self.assertEqual(titop.input_values(system, {"v": 3, "u(2)": 1}).tolist(), [0, 1, 3])
        with self.assertRaises(titop.Error) as raised:
            titop.input_values(system, {"w": 1})
        self.assertTrue(raised.exception.has("unknown-name"))


class Discrete(unittest.TestCase):
    def test_holds_and_tustin(self):
        """Of 1 / (s + a): exp(-a h), (1 - exp(-a h)) / a; Tustin (with prewarping) at one z."""
        a, h = 3.0, 0.1
        held = titop.discretize(lag(a), h)
        self.assertEqual(held.period, h)
        self.assertAlmostEqual(held.model.A[0, 0], math.exp(-a * h), places=14)
        self.assertAlmostEqual(held.model.B[0, 0], (1 - math.exp(-a * h)) / a, places=14)
        bilinear = titop.discretize(lag(a), h, "tustin").at(5)[0, 0]
        self.assertAlmostEqual(bilinear, 1 / (2j / h * math.tan(5 * h / 2) + a), places=12)
        warped = titop.discretize(lag(a), h, "tustin", prewarp=5).at(5)[0, 0]
        self.assertAlmostEqual(warped, 1 / (5j + a), places=12)
        both = titop.series(held, titop.discretize(lag(1), h))
        z = np.exp(0.7j * h)
        exact = ((1 - math.exp(-a * h)) / a / (z - math.exp(-a * h))
                 * (1 - math.exp(-h)) / (z - math.exp(-h)))
        self.assertAlmostEqual(both.at(0.7)[0, 0], exact, places=12)

    def test_sampled_law_comes_to_rest(self):
        """x' = r + T, T = -x(k) held: x(k + 1) = x(k) (1 - h) + h r, at rest x = r."""
        d = titop.Diagram("integrator")
        x = d.add("x", titop.Integrator())
        x.in_ = d.input("r") + d.input("T")
        d.output["y"] = x.out
        law = titop.discretize(titop.StateSpace(
            np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[-1.0]],
            inputs=["y"], outputs=["T"]), 0.5)
        system = titop.compile(d)
        push = titop.Excitation.step(titop.input_values(system, {"r": 1}))
        y = titop.simulate(system, titop.Excitation.sampled(law, push), step=0.5, until=3).y[0]
        np.testing.assert_allclose(y, 1 - 0.5**np.arange(7), atol=1e-14)

    def test_pade(self):
        """(1 - s T / 2) / (1 + s T / 2), of order 1; of order 4 exp(-s T) to (s T)^9."""
        s, T = 2.0j, 0.1
        d = titop.Diagram("late")
        late = [d.add(f"late{order}", titop.pade(T, order)) for order in (1, 4)]
        u = d.input("u")
        for i, block in enumerate(late):
            block.in_ = u
            d.output[f"y{i}"] = block.out
        first, fourth = titop.compile(d).transfer(s)[:, 0]
        self.assertAlmostEqual(first, (1 - s * T / 2) / (1 + s * T / 2), places=13)
        self.assertAlmostEqual(fourth, np.exp(-s * T), places=12)


if __name__ == "__main__":
    unittest.main()
