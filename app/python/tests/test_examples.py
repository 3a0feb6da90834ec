"""The examples in Python give what the C++ ones give: their diagrams, their A, B, C, D (of
distributed bodies, a transfer), norms, margins and responses to the last bit (models.cpp runs the
C++ examples and writes all), and the lines that they print."""
import collections
import contextlib
import difflib
import importlib.util
import io
import os
import pathlib
import re
import runpy
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import titop

EXAMPLES = pathlib.Path(os.environ["TITOP_SOURCE"]) / "examples"
SCRIPTS = sorted((EXAMPLES / "python").glob("[0-9]*.py")) + [EXAMPLES / "python" / "demo.py"]
ALL = {script.stem for script in SCRIPTS}
ONLY_CPP = {"09_own_block", "15_generated_code"}
if importlib.util.find_spec("nlopt") is None:  # of one example only, as in C++
    SCRIPTS = [script for script in SCRIPTS if script.stem != "20_codesign"]
WHAT = "A", "B", "C", "D", "H2", "H-infinity", "margins", "loops", "y", "error"
ANALYSED = 60  # states: analyses of more would take minutes
PLACE = re.compile(r"\S+\.(py|cpp):\d+$")


def lines_of(text):
    return [PLACE.sub("PLACE", line.rstrip()) for line in text.splitlines() if line.strip()]


def read_matrices(file):
    data, matrices = file.read_bytes(), []
    while data:
        rows, columns = np.frombuffer(data[:16], dtype=np.int64)
        end = 16 + 8 * rows * columns
        matrices.append(np.frombuffer(data[16:end]).reshape((columns, rows)).T)
        data = data[end:]
    return matrices


def row_of(analysis):
    """The numbers of an analysis as one row; none if it refuses the model."""
    try:
        return np.array([analysis()])
    except titop.Error:
        return np.zeros((0, 0))


def numbers(margins):
    parts = [(margins.disk.alpha, margins.disk.omega),
             (margins.nearest.value, margins.nearest.omega)]
    for loop in margins.loops:
        for at in loop.larger_gain, loop.smaller_gain, loop.phase, loop.delay, loop.nearest:
            parts.append((at.value, at.omega))
    return [number for part in parts for number in part]


def results_of_model(model):
    """A, B, C, D; of up to ANALYSED states H2 and H-infinity norms of the model whose poles are
    moved left by 1 rad/s, without direct term, so that they are finite; margins of its first output
    over its first input as L."""
    if model.order > ANALYSED:
        return [*model]
    A, B, C, D = model
    A = A - np.eye(model.order)
    stable = titop.StateSpace(A, B, C, 0 * D)
    L = titop.StateSpace(A, B[:, :1], C[:1], 0 * D[:1, :1])

    def hinf():
        norm = titop.norm_hinf(stable)
        return [norm.value, norm.omega]

    return [*model, row_of(lambda: [titop.norm_h2(stable)]), row_of(hinf),
            row_of(lambda: numbers(titop.margins(L)))]


def results(system):
    """The same; of a System also the margins of its loops, and the response to a unit step of all
    inputs; of distributed bodies, which have no model, a transfer's real and imaginary part."""
    try:
        all = results_of_model(system.state_space())
    except titop.Error as error:
        if not error.has("not-rational"):
            raise
        transfer = system.transfer(2 + 60j)
        return [transfer.real, transfer.imag]
    if isinstance(system, titop.System) and len(all) > 4:
        all.append(row_of(lambda: [number for name in titop.loop_points(system)
                                   for number in numbers(titop.margins(titop.loop(system, name)))]))
        t = titop.simulate(system, titop.Excitation.step(np.ones(len(system.inputs))),
                           step=0.01, until=0.5)
        all += [t.y, t.error[:, np.newaxis]]
    return all


def run(script, folder):
    """What a script prints, and {diagram as JSON: its matrices} of everything that it compiles."""
    compiled, compile, bracket = {}, titop.compile, titop.interface_bracket

    def recorded(diagram, *args, **options):
        system = compile(diagram, *args, **options)
        text = titop.diagram_json(diagram)
        if text not in compiled:
            compiled[text] = results(system)
        return system

    def recorded_bracket(scene, **options):
        for lumping in "constrained", "released":
            recorded(scene(lumping))
        return bracket(scene, **options)

    output, there = io.StringIO(), os.getcwd()
    os.makedirs(folder, exist_ok=True)
    titop.compile, titop.interface_bracket = recorded, recorded_bracket
    sys.path.insert(0, str(script.parent))
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(output):
            runpy.run_path(str(script), run_name="__main__")
    finally:
        os.chdir(there)
        sys.path.remove(str(script.parent))
        titop.compile, titop.interface_bracket = compile, bracket
    return output.getvalue(), compiled


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.cpp = pathlib.Path(cls.folder.name) / "cpp"
        subprocess.run([os.environ["TITOP_MODELS"], str(cls.cpp)], check=True,
                       stdout=subprocess.DEVNULL, cwd=cls.folder.name)
        cls.results = {s.stem: run(s, os.path.join(cls.folder.name, s.stem)) for s in SCRIPTS}

    def test_every_example_is_there(self):
        self.assertEqual(ALL | ONLY_CPP, {program.stem for program in EXAMPLES.glob("*.cpp")})

    def test_printed_lines(self):
        for name, (text, _) in self.results.items():
            with self.subTest(name):
                expected = iter(lines_of((EXAMPLES / f"{name}.output").read_text()))
                lines = lines_of(text)
                self.assertGreaterEqual(len(lines), 2)
                for line in lines:
                    self.assertTrue(line in expected, f"C++ does not print {line!r} here")

    def test_results_to_the_last_bit(self):
        count, found = 0, collections.defaultdict(set)
        for folder in sorted(self.cpp.iterdir()):
            if not folder.is_dir() or folder.name not in self.results:
                continue  # a file that an example writes
            with self.subTest(folder.name):
                compiled = self.results[folder.name][1]
                diagrams = {file.read_text(): file for file in folder.glob("*.json")}
                ours, theirs = set(compiled) - set(diagrams), set(diagrams) - set(compiled)
                for text, other in zip(sorted(ours), sorted(theirs)):
                    lines = difflib.unified_diff(other.splitlines(), text.splitlines(), n=1)
                    self.fail("the diagrams differ:\n" + "\n".join(list(lines)[:30]))
                self.assertEqual((len(ours), len(theirs)), (0, 0))
                for text, file in diagrams.items():
                    expected = read_matrices(file.with_suffix(".bin"))
                    self.assertEqual(len(compiled[text]), len(expected))
                    for what, ours, theirs in zip(WHAT, compiled[text], expected):
                        self.assertEqual(ours.shape, theirs.shape, what)
                        self.assertEqual(ours.tobytes(), np.asarray(theirs).tobytes(), what)
                        if ours.size:
                            found[what].add(folder.name)
                    count += 1
        codesign = "20_codesign" in self.results and (self.cpp / "20_codesign").is_dir()
        self.assertEqual(count, 59 + 3 * codesign)
        for what in "H2", "H-infinity", "margins", "y":
            self.assertGreaterEqual(len(found[what]), 20, what)
        self.assertEqual(found["loops"], {"27_margins", "30_telecom"})


if __name__ == "__main__":
    unittest.main()
