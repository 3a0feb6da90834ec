"""What a function cannot take is refused, with words."""
import unittest

import titop


class Refusals(unittest.TestCase):
    def refused(self, statement, *words, by=TypeError):
        with self.assertRaises(by) as raised:
            statement()
        for word in words:
            self.assertIn(word, str(raised.exception))
        return raised.exception


class Casts(Refusals):
    """What a function cannot take: the TypeError tells what it expects, and what came."""

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


if __name__ == "__main__":
    unittest.main()
