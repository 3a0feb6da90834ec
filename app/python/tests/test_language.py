"""Equations as assignments to attributes: the diagrams that they write, and refused ones."""
import gc
import json
import sys
import threading
import time
import unittest
import warnings

import numpy as np
import titop


def equations(d):
    return json.loads(titop.diagram_json(d))["equations"]


class Equations(unittest.TestCase):
    def setUp(self):
        self.d = titop.Diagram("d")
        self.u = self.d.input("u", 6)
        self.hub = self.d.add("hub", titop.RigidBody(mass=2, children={"C": [1, 0, 0]}))

    def test_one_equation_per_assignment(self):
        self.hub.parent.force = -self.u
        self.hub.child.force += 2 * self.u
        force = self.hub.child.force
        force += self.u
        force -= 3 * self.u
        written = equations(self.d)
        self.assertEqual([e["of"] for e in written],
                         [["hub", "parent", "force"]] + 3 * [["hub", "C", "force"]])
        self.assertEqual([e.get("add", False) for e in written], [False, True, True, True])
        self.assertEqual([e["terms"][0].get("sign", 1) for e in written], [-1, 1, 1, -1])

    def test_parts(self):
        self.hub.parent.accel.linear = 0
        self.hub.parent.force.angular.along[0, 0, 1] += self.u.along([0, 0, 1])
        self.hub.parent.force.about[0, 1, 0] += self.u.about([0, 1, 0])
        written = equations(self.d)
        self.assertEqual(len(written), 3)
        self.assertEqual(written[0]["terms"], [])
        with self.assertRaises(titop.Error) as raised:
            self.u.linear.about([0, 0, 1])
        self.assertEqual(raised.exception.mistakes[0].code, "size")

    def test_sizes_of_outputs_follow(self):
        self.hub.parent.force = -self.u
        self.d.output["a"] = self.hub.parent.accel
        self.d.output["b"] = self.hub.parent.accel.angular
        self.d.output["c"] = np.ones((2, 6)) @ self.hub.parent.accel
        self.d.output["d"] = sum([self.hub.parent.accel.along([1, 0, 0]) for _ in range(3)])
        self.assertEqual([o["size"] for o in json.loads(titop.diagram_json(self.d))["outputs"]],
                         [6, 3, 2, 1])

    def test_numbers_of_numpy(self):
        self.hub.parent.force = np.float64(2) * self.u / np.int64(4)
        self.d.output["a"] = self.hub.parent.accel
        gain = titop.compile(self.d).static_gain()
        self.assertTrue(np.array_equal(gain[:3, :3], np.diag([-0.25] * 3)))

    def refused(self, statement, *words):
        with self.assertRaises((TypeError, AttributeError)) as raised:
            statement()
        for word in words:
            self.assertIn(word, str(raised.exception))

    def test_what_is_not_linear_is_refused(self):
        p, x = self.d.param("p", 2.0), self.hub.parent.accel
        parent = self.hub.parent
        self.refused(lambda: x + 1.0, "d.input")
        self.refused(lambda: 1.0 - x, "d.input")
        self.refused(lambda: x * x, "linear")
        self.refused(lambda: x / p, "reciprocal")
        self.refused(lambda: p * p, "parameter")
        self.refused(lambda: 1 / p, "reciprocal")
        self.refused(lambda: p + 1, "sum")
        self.refused(lambda: setattr(parent, "accel", 3), "literal 0")
        self.refused(lambda: setattr(parent, "accel", self.hub.child), "mount")
        self.refused(lambda: parent.accel.__iadd__(self.u), "forces")
        self.refused(lambda: setattr(parent, "acel", 0))
        self.refused(lambda: setattr(self.hub, "parent", self.hub.child))
        self.assertEqual(equations(self.d), [])

    def test_parameters(self):
        m = self.d.param("m", 3.0)
        z = self.d.add("z", titop.SpringMass(mass=m / 2, stiffness=-(-4 * m)))
        z.parent.accel = 0
        z.child.force += 2 * (m * self.u.along([1, 0, 0]))
        self.hub.parent.force = 0
        self.d.output["x"] = z.stretch
        system = titop.compile(self.d)
        self.assertEqual(system.parameters, {"m": 3.0})
        for value in 3.0, 5.0:
            gain = system.update({"m": value}).static_gain()
            self.assertAlmostEqual(gain[0, 0], 2 * value / (4 * value), 14)


class Blocks(unittest.TestCase):
    def test_every_block_has_ports(self):
        body = titop.RigidBody(mass=2, inertia=[1, 1, 1])
        blocks = [titop.Gain(), titop.MatrixGain(matrix=[[1]]), titop.Sum(), titop.Integrator(),
                  titop.Lti(A=[[-1]], B=[[1]], C=[[1]]), titop.SpringMass(), body,
                  titop.FlexibleBody(body), titop.Hinge([0, 0, 1]), titop.Slide([0, 0, 1]),
                  titop.Joint(titop.ball()), titop.Bushing(stiffness=[1] * 6),
                  titop.Rotor(mass=1, axial=1, transverse=1, axis=[0, 0, 1])]
        d = titop.Diagram("d")
        for block in blocks:
            ports = d.add(type(block).__name__, block)
            self.assertTrue(hasattr(ports, "parent") or hasattr(ports, "out"), ports)


class Warnings(unittest.TestCase):
    def diagram(self):
        d = titop.Diagram("d")
        z = d.add("z", titop.SpringMass())
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.input("unread")
        d.output["x"] = z.stretch
        return d

    def test_notes_of_the_log_that_warn(self):
        with self.assertWarnsRegex(titop.CompileWarning, "unread") as warned:
            system = titop.compile(self.diagram())
        self.assertEqual(warned.filename, __file__)
        notes = [note for note in system.notes if note.kind == "warning"]
        self.assertEqual(len(notes), 1)
        self.assertIn("unread", repr(notes[0]))
        self.assertIn("warning", repr(notes[0]))

    def test_as_errors(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error", titop.CompileWarning)
            self.assertRaises(titop.CompileWarning, titop.compile, self.diagram())

    def test_update_repeats_none(self):
        d = titop.Diagram("d")
        z = d.add("z", titop.SpringMass(stiffness=d.param("k", 2.0)))
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.input("unread")
        d.output["x"] = z.stretch
        with self.assertWarns(titop.CompileWarning):
            system = titop.compile(d)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            system.update({"k": 3.0})


class Lifetimes(unittest.TestCase):
    def test_ports_keep_their_diagram(self):
        def port():
            d = titop.Diagram("d")
            return d.add("z", titop.SpringMass()).child.force, d.input("u")

        force, u = port()
        gc.collect()
        force += 2 * u
        self.assertIn("u", repr(2 * u))

    def test_matrices_are_views(self):
        d = titop.Diagram("d")
        z = d.add("z", titop.SpringMass(mass=2, stiffness=50))
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.output["x"] = z.stretch
        system = titop.compile(d)
        first, second = system.state_space(), system.state_space()
        self.assertTrue(np.shares_memory(first.A, second.A))
        self.assertFalse(first.A.flags.writeable)
        A, B, C, D = system.state_space()
        self.assertTrue(np.shares_memory(A, first.A))
        del system, first, second
        gc.collect()
        self.assertEqual(A.tolist(), [[0, 1], [-25, 0]])
        self.assertEqual((B.shape, C.shape, D.shape), ((2, 1), (1, 2), (1, 1)))
        y = titop.simulate(titop.compile(d), titop.Excitation.step([1.0]), step=0.1, until=1).y
        gc.collect()
        self.assertEqual(y.shape, (1, 11))
        self.assertIsNotNone(y.base)


class Threads(unittest.TestCase):
    def counted(self, work):
        """Steps of another thread while `work` runs, with no forced switch of threads."""
        count, stop = [0], threading.Event()

        def run():
            while not stop.is_set():
                count[0] += 1
                time.sleep(0)  # lets the other thread go on

        interval = sys.getswitchinterval()
        thread = threading.Thread(target=run)
        thread.start()
        sys.setswitchinterval(1000)
        try:
            before = count[0]
            work()
            return count[0] - before
        finally:
            sys.setswitchinterval(interval)
            stop.set()
            thread.join()

    def test_other_threads_run_during_computations(self):
        d = titop.Diagram("chain")
        last = d.add("z0", titop.SpringMass(parent_mass=1))
        last.parent.force = -d.input("u")
        for i in range(1, 3000):
            z = d.add(f"z{i}", titop.SpringMass(parent_mass=1))
            titop.mount(z, last.child)
            last = z
        d.output["x"] = last.stretch
        self.assertGreater(self.counted(lambda: titop.compile(d, minimize_up_to=0)), 0)
        system = titop.compile(d, minimize_up_to=0)
        omega = np.linspace(3, 4, 50)
        self.assertGreater(self.counted(lambda: system.frequency_response(omega)), 0)

    def test_sweep_visits_in_threads(self):
        d = titop.Diagram("d")
        k = d.param("k", 1.0)
        z = d.add("z", titop.SpringMass(stiffness=k))
        z.parent.accel = 0
        z.child.force = d.input("u")
        d.output["x"] = z.stretch
        points = [{"k": float(i)} for i in range(1, 30)]
        result = titop.sweep(titop.compile(d), points, lambda i, s: (i, s.static_gain()[0, 0]),
                             threads=2)
        self.assertEqual([i for i, _ in result], list(range(29)))
        for (_, gain), point in zip(result, points):
            self.assertAlmostEqual(gain * point["k"], 1, 14)
        with self.assertRaises(ZeroDivisionError):
            titop.sweep(titop.compile(d), points, lambda i, s: 1 / (i - 7), threads=2)


if __name__ == "__main__":
    unittest.main()
