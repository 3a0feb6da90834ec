"""Files of finite-element programs, and of models, read and written from a script."""
import os
import pathlib
import tempfile
import unittest

import numpy as np
import titop

DATA = pathlib.Path(os.environ["TITOP_SOURCE"]) / "examples" / "data"


def op4(*matrices):
    """Text of 2 x 2 matrices by columns."""
    lines = []
    for name, (a, b), (c, d) in matrices:
        lines.append(f"{2:8d}{2:8d}{2:8d}{2:8d}{name:8s}1P,3E23.16")
        for column, (x, y) in enumerate(((a, c), (b, d)), 1):
            lines += [f"{column:8d}{1:8d}{2:8d}", f"{x:23.16E}{y:23.16E}"]
        lines += [f"{3:8d}{1:8d}{1:8d}", f"{0:23.16E}"]
    return "\n".join(lines) + "\n"


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def test_names_that_repeat(self):
        file = self.path / "loop.op4"
        file.write_text(op4(("K", (2, -1), (-1, 2)), ("SE", (1, 2), (3, 4)),
                            ("SE", (5, 6), (7, 8)), ("M", (3, 0), (0, 3)), ("M", (3, 0), (0, 3))))
        found = titop.fe.read_op4(file)
        self.assertEqual(sorted(found), ["K", "M"])
        np.testing.assert_array_equal(found["K"], [[2, -1], [-1, 2]])
        self.assertEqual(list(titop.fe.read_op4(file, ["m"])), ["M"])
        with self.assertRaisesRegex(titop.Error, "several matrices SE"):
            titop.fe.read_op4(file, ["SE"])
        with self.assertRaisesRegex(titop.Error, "no matrix X"):
            titop.fe.read_op4(file, ["X"])

    def test_mat_files(self):
        d = titop.Diagram("mass")
        z = d.add("z", titop.SpringMass(mass=2, stiffness=50, damping=0.4))
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.output["x"] = z.stretch
        system = titop.compile(d)
        model = system.state_space()
        for written in (system, model):
            file = self.path / "model.mat"
            titop.write_mat(written, file)
            found = titop.fe.read_mat(file)
            self.assertEqual(sorted(found), ["A", "B", "C", "D"])
            for name in found:
                np.testing.assert_array_equal(found[name], getattr(model, name))
        self.assertEqual(list(titop.fe.read_mat(file, ["b"])), ["B"])
        with self.assertRaisesRegex(titop.Error, "STATES was not read"):
            titop.fe.read_mat(file, ["states"])

    def test_import(self):
        file = DATA / "nastran_cantilever" / "pn_mwe_s-solution_1.op2"
        body = titop.fe.import_body(file, parent="1", children=["3"], units=(1e-3, 1, 1)).body
        by_hand = titop.fe.read_modal_csv(DATA / "nastran_cantilever" / "cantilever.csv")
        np.testing.assert_allclose(body.omega, by_hand.omega, rtol=1e-6)


if __name__ == "__main__":
    unittest.main()
