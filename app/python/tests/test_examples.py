"""The examples in Python give what the C++ ones give: their diagrams and their A, B, C, D (of
distributed bodies, a transfer) to the last bit (models.cpp runs the C++ examples and writes both),
and the lines that they print."""
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
if importlib.util.find_spec("nlopt") is None:  # of one example only, as in C++
    SCRIPTS = [script for script in SCRIPTS if script.stem != "20_codesign"]
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


def matrices(system):
    """A, B, C, D; of distributed bodies, which have none, a transfer's real and imaginary part."""
    try:
        return tuple(system.state_space())
    except titop.Error as error:
        if not error.has("not-rational"):
            raise
    transfer = system.transfer(2 + 60j)
    return transfer.real, transfer.imag


def run(script, folder):
    """What a script prints, and {diagram as JSON: its matrices} of everything that it compiles."""
    compiled, compile, bracket = {}, titop.compile, titop.interface_bracket

    def recorded(diagram, *args, **options):
        system = compile(diagram, *args, **options)
        compiled.setdefault(titop.diagram_json(diagram), matrices(system))
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

    def test_printed_lines(self):
        for name, (text, _) in self.results.items():
            with self.subTest(name):
                expected = iter(lines_of((EXAMPLES / f"{name}.output").read_text()))
                lines = lines_of(text)
                self.assertGreaterEqual(len(lines), 2)
                for line in lines:
                    self.assertTrue(line in expected, f"C++ does not print {line!r} here")

    def test_models_to_the_last_bit(self):
        count = 0
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
                    for ours, theirs in zip(compiled[text], expected):
                        self.assertEqual(ours.shape, theirs.shape)
                        self.assertEqual(ours.tobytes(), np.asarray(theirs).tobytes())
                    count += 1
        codesign = "20_codesign" in self.results and (self.cpp / "20_codesign").is_dir()
        self.assertEqual(count, 59 + 3 * codesign)


if __name__ == "__main__":
    unittest.main()
