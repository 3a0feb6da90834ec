"""Meshes, plates, lines, distributed beams and mode shapes, against closed forms."""
import math
import pathlib
import sys
import tempfile
import unittest

import numpy as np
import titop
from titop import fe

material = titop.Material(E=70e9, nu=0.33, rho=2700)
plate = titop.Plate(a=0.8, b=0.2, thickness=0.002, material=material, elements=[4, 2])


def panel(parent="x0", child="x1"):
    mesh = fe.plate_mesh(plate)
    for name, edge in ("root", parent), ("next", child):
        mesh = fe.with_interface(mesh, name, fe.shapes(fe.edge(mesh, edge), fe.legendre(3)))
    return titop.FlexibleBody(fe.modal_data(mesh, "root", ["next"]))


class Meshes(unittest.TestCase):
    def test_mesh_by_hand(self):
        """A mass m on a spring k to the point P of mass 1: omega = sqrt(k / m)."""
        m, k, S = 2.0, 50.0, np.zeros((7, 7))
        for i, j, sign in (0, 0, 1), (6, 6, 1), (0, 6, -1), (6, 0, -1):
            S[i, j] = sign * k
        axes = "x", "y", "z", "rx", "ry", "rz"
        mesh = fe.Mesh(points={"P": [0, 0, 0], "1": [1, 0, 0]},
                       dofs=[("P", axis) for axis in axes] + [("1", "x")], interfaces={"root": "P"},
                       M=np.diag([1.0, 1, 1, 1, 1, 1, m]), K=S)
        self.assertEqual(mesh.dofs[6], "1.x")
        self.assertEqual(mesh.interfaces, {"root": "P"})
        self.assertEqual(mesh.points["1"].tolist(), [1, 0, 0])
        data = fe.modal_data(mesh, "root", [])
        self.assertAlmostEqual(data.omega[0], math.sqrt(k / m), places=12)

    def test_mistakes_of_meshes(self):
        with self.assertRaisesRegex(ValueError, "a component is one of 'x'"):
            fe.Mesh(points={"P": [0, 0, 0]}, dofs=[("P", "u")], M=np.eye(1), K=np.zeros((1, 1)))
        with self.assertRaises(titop.Error) as raised:
            fe.Mesh(points={"P": [0, 0, 0]}, dofs=[("Q", "x")], M=np.eye(1), K=np.zeros((1, 1)))
        self.assertTrue(raised.exception.has("unknown-name"))

    def test_plate_has_its_mass(self):
        mass = 2700 * 0.8 * 0.2 * 0.002
        data = panel().data
        self.assertAlmostEqual(data.D_P[2, 2], mass, places=12)
        self.assertAlmostEqual(data.D_P[0, 0], mass, places=12)
        self.assertEqual([line.name for line in data.lines], ["root", "next"])
        self.assertEqual(data.lines[1].Phi.shape,
                         (len(data.lines[1].shapes), len(data.omega)))

    def test_narrow_plate_is_a_beam(self):
        """nu = 0: omega_1 = 1.875104^2 sqrt(E h^2 / (12 rho)) / a^2, by the whole edge clamped."""
        narrow = titop.Plate(a=1, b=0.1, thickness=0.004,
                             material=titop.Material(E=70e9, nu=0, rho=2700), elements=[8, 1])
        mesh = fe.plate_mesh(narrow)
        mesh = fe.with_interface(mesh, "root", fe.rigid(fe.edge(mesh, "x0")))
        omega = fe.modal_data(mesh, "root", []).omega[0]
        exact = 1.8751040687**2 * math.sqrt(70e9 * 0.004**2 / (12 * 2700))
        self.assertLess(abs(omega / exact - 1), 1e-4)

    def test_refused_edges(self):
        mesh = fe.plate_mesh(plate)
        with self.assertRaisesRegex(titop.Error, "x0, x1, y0, y1"):
            fe.edge(mesh, "left")
        with self.assertRaises(titop.Error):
            fe.segment(mesh, "x0", 0.3, 0.7)
        self.assertEqual(len(fe.segment(mesh, "x0", 0, 0.5).points), 2)
        self.assertEqual(len(fe.segment(mesh, [0, 0, 0], [0.8, 0, 0]).points), 5)


class ClosedForms(unittest.TestCase):
    def test_simply_supported_square(self):
        """D = 1, rho h = 1: omega = pi^2 (i^2 + j^2), from above, by less than the error of k half
        waves along 8 cubic elements, (k pi / 8)^4 / 1440."""
        square = titop.Plate(a=1, b=1, thickness=0.01, material=titop.Material(rho=100),
                             D=titop.PlateStiffness(1, 0.3, 1, 0.35))
        mesh = fe.plate_mesh(square)
        free = []
        for row, name in enumerate(mesh.dofs):
            point, component = name.rsplit(".", 1)
            x, y = (place in (0, 1) for place in mesh.points[point][:2])
            if not (x and component in ("z", "rx") or y and component in ("z", "ry")):
                free.append(row)
        inverse = np.linalg.inv(np.linalg.cholesky(mesh.M[np.ix_(free, free)]))
        omega = np.sqrt(np.linalg.eigvalsh(inverse @ mesh.K[np.ix_(free, free)] @ inverse.T))
        for found, (i, j) in zip(omega, ((1, 1), (1, 2), (2, 1), (2, 2))):
            error = found / (math.pi**2 * (i * i + j * j)) - 1
            self.assertGreater(error, 0)
            self.assertLess(error, (max(i, j) * math.pi / 8)**4 / 1440)

    def strip(self, in_plane):
        """2 m x 0.25 m, held along x = 0, nu = 0: along x a rod of 10 linear elements."""
        strip = titop.Plate(a=2, b=0.25, thickness=0.002, elements=[10, 2], in_plane=in_plane,
                            material=titop.Material(E=70e9, nu=0, rho=2700))
        mesh = fe.plate_mesh(strip)
        mesh = fe.with_interface(mesh, "root", fe.rigid(fe.edge(mesh, "x0")))
        mesh = fe.with_interface(mesh, "tip", fe.average(fe.edge(mesh, "x1")))
        return strip, fe.modal_data(mesh, "root", ["tip"])

    def test_membrane_is_a_rod(self):
        """Waves k along linear elements of length h with their consistent mass: omega^2 = (E / rho)
        6 (1 - cos kh) / ((2 + cos kh) h^2)."""
        _, membrane = self.strip("membrane")
        for i in range(1, 5):
            c, h = math.cos((i - 0.5) * math.pi / 10), 0.2
            omega = math.sqrt(70e9 / 2700 * 6 * (1 - c) / (2 + c)) / h
            self.assertLess(abs(membrane.omega / omega - 1).min(), 1e-9)
        _, rigid = self.strip("rigid")
        self.assertEqual(len(membrane.omega), len(rigid.omega) + 2 * 30)
        for omega in rigid.omega[:8]:  # bending is as before
            self.assertLess(abs(membrane.omega / omega - 1).min(), 1e-9)

    def test_membrane_in_a_diagram(self):
        """F along the strip moves its end by F a / (E h b)."""
        strip, data = self.strip("membrane")
        d = titop.Diagram("strip")
        body = d.add("strip", titop.FlexibleBody(data))
        titop.ground(body)
        body.child["tip"].force += d.input("F", 6)
        d.output["x"] = body.child["tip"].position
        gain = titop.compile(d).static_gain()[0, 0]
        exact = strip.a / (strip.material.E * strip.thickness * strip.b)
        self.assertLess(abs(gain / exact - 1), 1e-9)

    def test_plate_is_readable(self):
        strip, _ = self.strip("membrane")
        self.assertEqual((strip.in_plane, strip.D, strip.A), ("membrane", None, None))
        self.assertEqual((strip.material.nu, strip.material.G), (0, None))
        laminate = titop.Plate(a=1, b=1, thickness=0.01, material=titop.Material(rho=100),
                               D=titop.PlateStiffness(1, 0.3, 2, 0.35), in_plane="membrane",
                               A=titop.MembraneStiffness(5, 1.1, 3, 0.8))
        self.assertEqual((laminate.D.D22, laminate.A.A11, laminate.A.A66), (2, 5, 0.8))
        self.assertEqual(plate.in_plane, "rigid")
        with self.assertRaisesRegex(ValueError, "in_plane is one of 'rigid', 'membrane'"):
            titop.Plate(a=1, b=1, thickness=0.01, material=material, in_plane="elastic")
        with self.assertRaisesRegex(titop.Error, "A and no D"):
            fe.plate_mesh(titop.Plate(a=1, b=1, thickness=0.01, material=material,
                                      in_plane="membrane",
                                      A=titop.MembraneStiffness(5, 1.1, 3, 0.8)))


class Lines(unittest.TestCase):
    def hinged(self, k):
        d = titop.Diagram("panels")
        p1, p2 = d.add("p1", panel()), d.add("p2", panel())
        titop.ground(p1.line("root"))
        h = titop.hinge_line(d, "h", p2.line("root"), p1.line("next"))
        h.torque = k * h.angle
        p2.child["next"].force += d.input("F", 6)
        d.output["accel"] = p2.child["next"].accel
        return titop.compile(d)

    def welded(self):
        d = titop.Diagram("panels")
        p1, p2 = d.add("p1", panel()), d.add("p2", panel())
        titop.ground(p1.line("root"))
        titop.weld(p2.line("root"), p1.line("next"))
        return titop.compile(d)

    def test_stiff_hinge_is_a_weld(self):
        stiff, welded = self.hinged(1e6).poles()[0].omega, self.welded().poles()[0].omega
        self.assertLess(abs(stiff / welded - 1), 1e-2)
        self.assertLess(self.hinged(1).poles()[0].omega, welded)

    def test_soft_hinge_carries_a_rigid_panel(self):
        """The second panel swings about the line, m a^2 omega^2 / 3 = k, less what bending yields.
        Under the hinge's moment M and the second panel's force 3 M / (2 a) the first one has the
        energy M^2 / (2 E I) times the integral of (1 + 3 x / (2 a))^2, 3.25 a; the second one, of a
        moment that falls from M to 0, less than a. A plate has E I to E I / (1 - nu^2)."""
        k, a, m, EI = 1e-3, 0.8, 2700 * 0.8 * 0.2 * 0.002, 70e9 * 0.2 * 0.002**3 / 12
        lowered = 1 - self.hinged(k).poles()[0].omega / math.sqrt(3 * k / (m * a**2))
        self.assertGreater(lowered, 3.25 / 2 * k * a / EI * (1 - 0.33**2))
        self.assertLess(lowered, 4.25 / 2 * k * a / EI)

    def test_shapes(self):
        d = titop.Diagram("d")
        line = d.add("p", panel()).line("next")
        self.assertEqual((line.name, line.axis, line.is_parent), ("p.next", 1, False))
        self.assertAlmostEqual(line.length, 0.2)
        self.assertIn("z2", line.shapes)
        d.output["z2"] = line.shape("z2").accel
        with self.assertRaisesRegex(titop.Error, "its shapes are .*z2"):
            line.shape("z7")
        with self.assertRaisesRegex(titop.Error, "its lines are root, next"):
            d.add("q", panel()).line("last")


class Distributed(unittest.TestCase):
    beam = titop.ExactBeam(length=2, section=titop.rectangle(0.04, 0.02), material=material)

    def cantilever(self, body):
        d = titop.Diagram("cantilever")
        b = d.add("b", body)
        titop.ground(b)
        b.child.force += d.input("F", 6)
        d.output["a"] = b.child.accel
        return titop.compile(d)

    def test_transfer_of_a_rod(self):
        """Axial: a = s^2 x, x / F = tanh(s L / c) / (E A s / c), c = sqrt(E / rho)."""
        s, E, A, c = 3 + 2000j, 70e9, 0.04 * 0.02, math.sqrt(70e9 / 2700)
        exact = s * s * np.tanh(s * 2 / c) / (E * A * s / c)
        H = self.cantilever(self.beam).transfer(s)[0, 0]
        self.assertLess(abs(H / exact - 1), 1e-12)

    def test_it_has_no_state_space(self):
        with self.assertRaises(titop.Error) as raised:
            self.cantilever(self.beam).state_space()
        self.assertTrue(raised.exception.has("not-rational"))

    def test_compare_and_reduce(self):
        exact, scene = self.cantilever(self.beam), titop.Scene(band_hz=[0, 60], accuracy=1e-2)
        errors = [titop.compare(self.cantilever(titop.FlexibleBody(
            titop.with_elements(self.beam, n))), exact, scene).worst for n in (4, 8)]
        self.assertLess(errors[1], errors[0])
        d = titop.Diagram("cantilever")
        b = d.add("b", self.beam)
        titop.ground(b)
        b.child.force += d.input("F", 6)
        d.output["a"] = b.child.accel
        reduced = titop.reduce_beams(d, scene)
        self.assertLessEqual(reduced.error.worst, 1e-2)
        self.assertEqual([beam.name for beam in reduced.beams], ["b"])
        self.assertIn("against the distributed beams", str(reduced))


class Shapes(unittest.TestCase):
    def system(self):
        d = titop.Diagram("boom")
        b = d.add("b", titop.FlexibleBody(titop.Beam(
            length=2, section=titop.rectangle(0.04, 0.02), material=material)))
        titop.ground(b)
        b.child.force += d.input("F", 6)
        d.output["a"] = b.child.accel
        return titop.compile(d)

    def test_tip_moves_across(self):
        shapes = titop.mode_shapes(self.system(), [0])
        self.assertEqual([p.name for p in shapes.points], ["b.C", "b.parent"])
        tip = [p.name for p in shapes.points].index("b.C")
        motion = shapes.modes[0].translation[:, tip]
        self.assertEqual(shapes.points[tip].place.tolist(), [2, 0, 0])
        self.assertAlmostEqual(np.linalg.norm(motion), 1)
        self.assertLess(abs(motion[0]), 1e-9)

    def test_models_and_files(self):
        system = self.system()
        model = system.state_space()
        small = titop.minimize(model, resolution=0)
        self.assertEqual(small.model.order, model.order)
        again = titop.compile(titop.diagram_of_model(model, "again"), minimize_up_to=0)
        s = 1 + 40j
        error = np.abs(again.transfer(s) - model.transfer(s)).max()
        self.assertLess(error, 1e-9 * np.abs(model.transfer(s)).max())
        A, B = titop.hold(model.A, model.B, 1e-3)
        y = titop.held_response(model, 1e-3, np.ones((6, 3)))
        x1 = B @ np.ones(6)
        expected = np.stack([model.D @ np.ones(6), model.C @ x1 + model.D @ np.ones(6),
                             model.C @ (A @ x1 + x1) + model.D @ np.ones(6)], axis=1)
        self.assertLess(np.abs(y - expected).max(), 1e-9 * np.abs(expected).max())
        with tempfile.TemporaryDirectory() as folder:
            titop.write_numpy(system, folder, "boom_model")
            sys.path.insert(0, folder)
            import boom_model
            sys.path.remove(folder)
            self.assertEqual(boom_model.A.tobytes(), np.ascontiguousarray(model.A).tobytes())
            titop.write_cpp(system, folder, "boom", states="model")
            self.assertIn("namespace boom", (pathlib.Path(folder) / "boom.hpp").read_text())
        self.assertIn("full_up_to", titop.report_html.__doc__)
        page = titop.report(system, diagrams=False, units=[("F(1)", "lbf")], full_up_to=0)
        self.assertIn("lbf", page.html)


if __name__ == "__main__":
    unittest.main()
