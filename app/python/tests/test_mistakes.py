"""The ten likeliest mistakes give the same messages as in C++ (mistakes.cpp), with the lines of this
file in place of those of C++."""
import linecache
import os
import re
import subprocess
import unittest

import titop

hub = titop.RigidBody(mass=100, children={"C1": [1, 0, 0]})
wing = titop.RigidBody(mass=10)


def mount_forgotten(d):
    U = d.input("U", 6)
    B = d.add("B", hub)
    d.add("A1", wing)
    B.parent.force = -U
    d.output["xdd_P", 6] = B.parent.accel


def force_driven_twice(d):
    U = d.input("U", 6)
    B = d.add("B", hub)
    B.parent.force = -U
    B.parent.force = U
    d.output["xdd_P", 6] = B.parent.accel


def frames_mixed(d):
    U = d.input("U", 6)
    B = d.add("B", hub)
    A1 = d.add("A1", wing)
    B.parent.force = -U
    A1.parent.accel = B.child["C1"].accel
    B.child["C1"].force = A1.parent.force
    d.output["xdd_P", 6] = B.parent.accel


def massless_body_freed(d):
    u = d.input("u")
    z1 = d.add("z1", titop.SpringMass(mass=1, stiffness=10))
    z1.parent.force = -u
    d.output["xdd"] = z1.parent.accel


def wrong_size(d):
    U = d.input("U", 3)
    B = d.add("B", hub)
    B.parent.force = -U
    d.output["xdd_P", 6] = B.parent.accel


def unknown_child(d):
    B = d.add("B", hub)
    A1 = d.add("A1", wing)
    B.parent.force = 0
    titop.mount(A1, B.child["C2"])
    d.output["xdd_P", 6] = B.parent.accel


def name_taken(d):
    B = d.add("B", hub)
    A1 = d.add("B", wing)
    B.parent.force = 0
    titop.mount(A1, B.child["C1"])
    d.output["xdd_P", 6] = B.parent.accel


def position_as_acceleration(d):
    z1 = d.add("z1", titop.SpringMass(mass=1, stiffness=10))
    z2 = d.add("z2", titop.SpringMass(mass=1, stiffness=10))
    titop.ground(z1)
    z2.parent.accel = z1.stretch
    z1.child.force = z2.parent.force
    d.output["x"] = z2.stretch


def hinge_not_driven(d):
    B = d.add("B", hub)
    A1 = d.add("A1", wing)
    B.parent.force = 0
    titop.hinge(d, "drive", A1, B.child["C1"], titop.Rotation(), [0, 0, 1])
    d.output["xdd_P", 6] = B.parent.accel


def negative_mass(d):
    d.add("B", titop.RigidBody(mass=-1))


# A word of the line that every mistake names.
LINES = {
    mount_forgotten: 'd.add("A1", wing)', force_driven_twice: "B.parent.force = U",
    frames_mixed: "A1.parent.accel = ", massless_body_freed: "z1.parent.force = -u",
    wrong_size: "B.parent.force = -U", unknown_child: 'B.child["C2"]', name_taken: 'd.add("B"',
    position_as_acceleration: "z2.parent.accel = ", hinge_not_driven: "titop.hinge(",
    negative_mass: "RigidBody(mass=-1)"}
PLACE = re.compile(r"\S+\.(py|cpp):\d+")


def refusal(write):
    try:
        d = titop.Diagram("scene")
        write(d)
        titop.compile(d)
    except titop.Error as error:
        return error
    raise AssertionError(f"{write.__name__} is not refused")


class TenMistakes(unittest.TestCase):
    def test_messages_are_those_of_cpp(self):
        printed = subprocess.run([os.environ["TITOP_MISTAKES"]], capture_output=True, text=True,
                                 check=True).stdout
        expected = dict(re.findall(r"== (\w+)\n(.*?)\n(?===|\Z)", printed, re.DOTALL))
        self.assertEqual(len(expected), 10)
        for write in LINES:
            with self.subTest(write.__name__):
                text = PLACE.sub("PLACE", str(refusal(write)))
                self.assertEqual(text.split(), PLACE.sub("PLACE", expected[write.__name__]).split())

    def test_places_are_lines_of_this_file(self):
        for write, words in LINES.items():
            with self.subTest(write.__name__):
                mistakes = refusal(write).mistakes
                places = [place for mistake in mistakes for place in mistake.places]
                self.assertTrue(all(mistake.places for mistake in mistakes))
                lines = []
                for place in places:
                    file, line = place.rsplit(":", 1)
                    self.assertTrue(__file__.endswith(file), place)
                    lines.append(linecache.getline(__file__, int(line)))
                self.assertTrue(any(words in line for line in lines), lines)

    def test_places_with_spaces(self):
        script = ('import titop\nd = titop.Diagram("d")\nz = d.add("z", titop.SpringMass())\n'
                  'z.parent.accel = 0\nz.parent.accel = d.input("u")\ntitop.compile(d)\n')
        for file in "/home/a user/my models/a b.py", "models/a b.py", "a b.py", "<cell 3>":
            with self.subTest(file), self.assertRaises(titop.Error) as raised:
                exec(compile(script, file, "exec"), {})
            name = "/".join(file.split("/")[-2:])
            places = [p for mistake in raised.exception.mistakes for p in mistake.places]
            self.assertEqual(set(places) & {f"{name}:4", f"{name}:5"},
                             {f"{name}:4", f"{name}:5"})
            self.assertTrue(all(place.startswith(name + ":") for place in places), places)

    def test_all_mistakes_together(self):
        def write(d):
            mount_forgotten(d)
            d.add("A2", wing)

        error = refusal(write)
        self.assertEqual([m.code for m in error.mistakes], ["no-equation", "no-equation"])
        self.assertTrue(error.has("no-equation"))
        self.assertFalse(error.has("frame"))
        for mistake in error.mistakes:
            self.assertIn(mistake.message, str(error))
            self.assertIn(mistake.hint, str(error))


if __name__ == "__main__":
    unittest.main()
