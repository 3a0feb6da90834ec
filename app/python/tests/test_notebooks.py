"""Representations in notebooks, and conversions for other packages."""
import shutil
import sys
import types
import unittest
import unittest.mock
import xml.etree.ElementTree

import numpy as np
import titop

try:
    import control
except ImportError:
    control = None


def law():
    d = titop.Diagram("law <1>")
    z = d.add("z", titop.SpringMass(mass=2, stiffness=50, damping=0.4))
    K = d.add("K", titop.Lti(A=[[-3]], B=[[1]], C=[[7]]))
    z.parent.accel = 0
    K.in_ = z.stretch
    z.child.force = d.input("u") - d.loop_point("law", K.out)
    d.output["x"] = z.stretch
    return d


class Notebooks(unittest.TestCase):
    def setUp(self):
        self.system = titop.compile(law())

    def svg(self, text):
        self.assertTrue(xml.etree.ElementTree.fromstring(text).tag.endswith("svg"))

    @unittest.skipUnless(shutil.which("dot"), "Graphviz is not installed")
    def test_drawings(self):
        self.svg(law()._repr_svg_())
        self.svg(self.system._repr_svg_())
        page = titop.report(self.system)._repr_html_()
        self.assertTrue(page.startswith("<iframe srcdoc=\"&lt;"))

    def test_plots(self):
        self.svg(titop.plot_bode(self.system, "x", "u")._repr_svg_())
        self.svg(titop.plot_step(self.system, "x", "u", until=2))
        self.svg(titop.plot_nyquist(titop.loop(self.system, "law")))

    def test_poles(self):
        poles = self.system.poles()
        self.assertEqual(len(poles), 2)
        self.assertEqual(poles._repr_html_().count("<tr>"), 3)
        self.assertEqual(repr(poles), str(poles))
        self.assertEqual(poles[-1].omega, list(poles)[1].omega)
        numbers = np.roots(np.polyadd(np.polymul([2, 0.4, 50], [1, 3]), [7]))
        for p in poles:
            self.assertLess(abs(numbers - p.s).min(), 1e-12 * p.omega)

    def test_responses(self):
        omega = np.array([0.3, 2.0, 5.0])
        response = self.system.frequency_response(omega)
        self.assertEqual((response.shape, response.dtype), ((3, 1, 1), np.complex128))
        s = 1j * omega
        by_hand = (s + 3) / ((2 * s**2 + 0.4 * s + 50) * (s + 3) + 7)
        self.assertLess(abs(response[:, 0, 0] / by_hand - 1).max(), 1e-13)
        L = titop.loop(self.system, "law").L.frequency_response(omega)[:, 0, 0]
        self.assertLess(abs(L / (7 / (s + 3) / (2 * s**2 + 0.4 * s + 50)) - 1).max(), 1e-13)

    def test_arguments_of_control(self):
        calls = []
        stand_in = types.SimpleNamespace(ss=lambda *args, **options: calls.append((args, options)))
        with unittest.mock.patch.dict(sys.modules, control=stand_in):
            titop.control(self.system)
            titop.control(titop.discretize(self.system.state_space(), 0.1))
        model = self.system.state_space()
        self.assertEqual([args[4] for args, _ in calls], [0, 0.1])
        for ours, theirs in zip(calls[0][0], model):
            self.assertTrue(np.array_equal(ours, theirs))
        names = {"states": [s.replace(".", "_") for s in model.states], "inputs": ["u"],
                 "outputs": ["x"]}
        self.assertEqual([options for _, options in calls], [names, names])
        self.assertEqual(names["states"][0], "z_stretch")

    @unittest.skipUnless(control, "python-control is not installed")
    def test_control(self):
        model = titop.control(self.system)
        self.assertEqual(list(model.input_labels) + list(model.output_labels), ["u", "x"])
        self.assertLess(abs(model(2j) / self.system.transfer(2j)[0, 0] - 1), 1e-12)
        discrete = titop.control(titop.discretize(self.system.state_space(), 0.1))
        self.assertEqual(discrete.dt, 0.1)


if __name__ == "__main__":
    unittest.main()
