"""Statements without an effect are refused: comparisons in place of equations, writing into
copies, half of a matrix, imaginary parts, models whose matrices do not fit."""
import gc
import pickle
import unittest

import numpy as np
import titop


def beam():
    return titop.fe.modal_data(
        titop.Beam(length=3, section=titop.tube(0.05, 0.045),
                   material=titop.Material(E=70e9, nu=0.25, rho=2700), elements=1))


class Refusals(unittest.TestCase):
    def refused(self, statement, *words, by=TypeError):
        with self.assertRaises(by) as raised:
            statement()
        for word in words:
            self.assertIn(word, str(raised.exception))
        return raised.exception


class Comparisons(Refusals):
    def setUp(self):
        self.d = titop.Diagram("d")
        self.u = self.d.input("u")
        self.z = self.d.add("z", titop.SpringMass())

    def test_of_signals(self):
        force = self.z.child.force
        self.refused(lambda: force == self.u, "write `=`")
        self.refused(lambda: force != self.u, "write `=`")
        self.refused(lambda: 2 * self.u == 0, "write `=`")
        self.refused(lambda: 0 == self.z.stretch, "write `=`")
        self.refused(lambda: np.float64(0) == self.z.stretch, "write `=`")

    def test_of_points(self):
        self.refused(lambda: self.z.parent == 0, "mount")
        self.refused(lambda: self.z.child != self.z.parent, "mount")

    def test_keys_of_a_dict(self):
        force, child = self.z.child.force, self.z.child
        self.assertEqual({force: 1, child: 2}[force], 1)


class Pickle(Refusals):
    def test_of_diagrams_and_systems(self):
        d = titop.Diagram("d")
        z = d.add("z", titop.SpringMass())
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.output["x"] = z.stretch
        for thing in d, z, z.stretch, titop.SpringMass(), titop.compile(d):
            self.refused(lambda: pickle.dumps(thing), "pickle")
        other = titop.parse_diagram(pickle.loads(pickle.dumps(titop.diagram_json(d))))
        self.assertEqual(titop.compile(other).static_gain().tolist(), [[1]])


class Copies(Refusals):
    def test_children_outlive_their_replacement(self):
        data = beam()
        child = data.children[0]
        name, PC = child.name, child.PC.tolist()
        data.children = [titop.ModalChild(f"other {i}", [0, 0, 0], child.Phi_C) for i in range(50)]
        gc.collect()
        self.assertEqual((child.name, child.PC.tolist()), (name, PC))
        self.assertEqual((name, PC), ("C", [3, 0, 0]))
        self.assertEqual(len(data.children), 50)
        self.assertIsInstance(data.children, tuple)

    def test_arrays_are_read_only(self):
        data = beam()
        for array in (data.omega, data.xi, data.L_P, data.D_P, data.children[0].PC,
                      data.children[0].Phi_C):
            with self.assertRaises(ValueError):
                array[...] = 1.0
        xi = data.xi.copy()
        xi[0] = 0.25
        data.xi = xi
        self.assertEqual(data.xi[0], 0.25)

    def test_times_are_read_only(self):
        d = titop.Diagram("d")
        z = d.add("z", titop.SpringMass())
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.output["x"] = z.stretch
        run = titop.simulate(titop.compile(d), titop.Excitation.none(), step=0.5, until=1)
        with self.assertRaises(ValueError):
            run.time[0] = 7
        self.assertEqual(run.time.tolist(), [0, 0.5, 1])


class Numbers(Refusals):
    def setUp(self):
        self.d = titop.Diagram("d")
        self.J = self.d.param("J", 4.0)

    def code(self, statement, *words):
        return self.refused(statement, *words, by=titop.Error).mistakes[0].code

    def test_inertia_of_both_triangles(self):
        J = self.J
        off = 0.5 * self.d.param("off", 1.0)

        def inertia(xy, yx, zz=J):
            return titop.RigidBody(inertia=[[5, xy, 0], [yx, 5, 0], [0, 0, zz]])

        inertia(off, off)
        inertia(1 / 3, 1 / 3 + 1e-16)
        for xy, yx in (off, 0), (0, off), (off, 2 * off), (off, J), (off, 0.5), (1, 0):
            self.assertEqual(self.code(lambda: inertia(xy, yx), "(1, 2)", "(2, 1)"), "bad-inertia")

    def test_stiffness_of_both_triangles(self):
        def stiffness(upper, lower):
            K = [[4.0 * (i == j) for j in range(6)] for i in range(6)]
            K[1][5], K[5][1] = upper, lower
            return titop.Bushing(stiffness=K)

        stiffness(self.J, self.J)
        for upper, lower in (self.J, 0), (0, self.J), (self.J, 4.0):
            self.assertEqual(self.code(lambda: stiffness(upper, lower), "(2, 6)"), "bad-value")

    def test_no_real_numbers(self):
        u = self.d.input("u")
        for k in 1j, np.complex128(2), np.complex64(2), True, np.bool_(True), np.array(2 + 0j):
            with self.subTest(repr(k)):
                self.refused(lambda: u * k, "multiplied by a number")
                self.refused(lambda: titop.SpringMass(mass=k))
                self.refused(lambda: self.J * k, "multiplied by a number")
        self.refused(lambda: np.array([[1j]]) @ u, "real numbers", "complex128")
        self.refused(lambda: np.array([[True]]) @ u, "real numbers", "bool")
        self.refused(lambda: np.array(["a"]) @ u, "two dimensions")
        self.refused(lambda: np.array([["a"]]) @ u, "real numbers")
        z = self.d.add("z", titop.SpringMass())
        for number in 10**30, -(10**30), 2**64:
            with self.assertRaisesRegex(TypeError, "d.input"):
                z.child.force += number


class ImaginaryParts(Refusals):
    """Arrays of complex numbers: the TypeError names the argument and tells of .real."""

    def test_of_models(self):
        for make in (titop.StateSpace, titop.Lti):
            for name in "ABCD":
                for number in 2 + 1j, np.complex64(1), 0j:
                    matrices = dict.fromkeys("ABCD", np.ones((1, 1)))
                    make(**matrices)
                    matrices[name] = np.array([[number]])
                    self.refused(lambda: make(**matrices), name + " of", "real")
                    matrices[name] = [[number]]
                    self.refused(lambda: make(**matrices), name + " of", "real")
                    matrices[name] = np.array([[number]]).real
                    make(**matrices)

    def test_of_rotations_and_vectors(self):
        self.refused(lambda: titop.Rotation.matrix(np.eye(3) * (1 + 0j)), "T of Rotation", ".real")
        self.assertEqual(titop.Rotation.matrix(np.eye(3, dtype=int)).nominal.tolist(),
                         np.eye(3).tolist())
        self.refused(lambda: titop.about(np.array([1j, 0, 1])), "1.j")

    def test_of_structural_damping(self):
        K = np.diag([1e4] * 6)
        B = np.hstack([-np.eye(6), np.eye(6)])
        dofs = [(p, c) for p in "PC" for c in ("x", "y", "z", "rx", "ry", "rz")]

        def mesh(M, K):
            return titop.fe.Mesh(points={"P": [0, 0, 0], "C": [0, 0, 0]}, dofs=dofs, M=M,
                                 K=B.T @ K @ B)

        mesh(np.eye(12), K)
        self.refused(lambda: mesh(np.eye(12), K * (1 + 0.02j)), "K of", "with_loss_factor")
        self.refused(lambda: mesh(np.eye(12) * 1j, K), "M of", ".real")

    def test_of_modes(self):
        def data(**changed):
            given = {"omega": [1.0], "xi": [0.0], "L_P": np.zeros((1, 6)), "D_P": np.eye(6)}
            return titop.ModalData(**{**given, **changed})

        data()
        for name, array in (("omega", np.array([1 + 1j])), ("omega", [np.complex64(1)]),
                            ("L_P", np.zeros((1, 6)) * 1j), ("D_P", np.eye(6) * 1j)):
            self.refused(lambda: data(**{name: array}), name)


class Casts(Refusals):
    """Arguments of other types: the TypeError names the expected and the given one."""

    def test_of_blocks(self):
        self.refused(lambda: titop.RigidBody(inertia=3.0), "an inertia", "3 x 3", "3.0")
        self.refused(lambda: titop.RigidBody(children={"A": [1, 2]}), "vector of 3", "[1, 2]")
        self.refused(lambda: titop.RigidBody(children={1: [1, 2, 3]}), "name", "not 1")
        self.refused(lambda: titop.Bushing(stiffness=[1] * 6, damping=2.0), "six values", "2.0")

    def test_of_functions(self):
        d = titop.Diagram("d")
        z = d.add("z", titop.SpringMass(stiffness=d.param("k", 2.0)))
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.output["x"] = z.stretch
        system = titop.compile(d)
        u = titop.Excitation.function(lambda t: 1.0)
        self.refused(lambda: titop.simulate(system, u, step=0.1, until=1), "u(t)", "1.0")
        self.refused(lambda: titop.lft(system, {"k": 20}), "percent", "20")


class Models(Refusals):
    def test_matrices_that_do_not_fit(self):
        A, B, C, D = np.eye(2), np.ones((2, 1)), np.ones((3, 2)), np.zeros((3, 1))
        titop.StateSpace(A, B, C, D)
        for wrong in ((np.ones((2, 3)), B, C, D), (A, np.ones((3, 1)), C, D),
                      (A, B, np.ones((3, 1)), D), (A, B, C, np.zeros((3, 2)))):
            error = self.refused(lambda: titop.StateSpace(*wrong), "StateSpace", by=titop.Error)
            self.assertTrue(error.has("size"))

    def test_names(self):
        matrices = np.eye(2), np.ones((2, 1)), np.ones((3, 2)), np.zeros((3, 1))
        model = titop.StateSpace(*matrices, states=["a", "b"])
        self.assertEqual((model.states, model.inputs, model.outputs),
                         (["a", "b"], ["u1"], ["y1", "y2", "y3"]))
        self.assertEqual(titop.StateSpace(*matrices).states, ["x1", "x2"])
        for names in {"states": ["a"]}, {"inputs": ["a", "b"]}, {"outputs": ["a"]}:
            error = self.refused(lambda: titop.StateSpace(*matrices, **names), list(names)[0],
                                 by=titop.Error)
            self.assertTrue(error.has("size"))


if __name__ == "__main__":
    unittest.main()
