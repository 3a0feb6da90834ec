"""The examples in Python give what the C++ ones give: their diagrams and their A, B, C, D to the
last bit (models.cpp runs the C++ examples and writes both), and the lines that they print."""
import contextlib
import difflib
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
SCRIPTS = sorted((EXAMPLES / "python").glob("[0-9]*.py"))
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


def run(script, folder):
    """What a script prints, and {diagram as JSON: A, B, C, D} of everything that it compiles."""
    compiled, compile = {}, titop.compile

    def recorded(diagram, *args, **options):
        system = compile(diagram, *args, **options)
        compiled.setdefault(titop.diagram_json(diagram), tuple(system.state_space()))
        return system

    output, there = io.StringIO(), os.getcwd()
    os.makedirs(folder, exist_ok=True)
    titop.compile = recorded
    sys.path.insert(0, str(script.parent))
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(output):
            runpy.run_path(str(script), run_name="__main__")
    finally:
        os.chdir(there)
        sys.path.remove(str(script.parent))
        titop.compile = compile
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
                    for ours, theirs in zip(compiled[text], read_matrices(file.with_suffix(".bin"))):
                        self.assertEqual(ours.shape, theirs.shape)
                        self.assertEqual(ours.tobytes(), np.asarray(theirs).tobytes())
                        count += 1
        self.assertEqual(count, 4 * 44)


if __name__ == "__main__":
    unittest.main()
