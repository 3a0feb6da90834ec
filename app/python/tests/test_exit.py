"""A script may end while a thread of it is inside of a computation: status 0, nothing on stderr."""
import subprocess
import sys
import unittest

SCENE = """
import sys, threading, time
import titop
d = titop.Diagram("d")
k = d.param("k", 1.0)
z = d.add("z", titop.SpringMass(stiffness=k))
z.parent.accel = 0
z.child.force = d.input("u")
d.output["x"] = z.stretch
system = titop.compile(d)
started = threading.Event()
"""

END = """
threading.Thread(target=work, daemon=True).start()
started.wait()
time.sleep(0.05)
"""

# Both take the lock again and again, and end seconds after the script.
WORK = {
    "released": """
def work():
    started.set()
    while True:
        titop.simulate(system, titop.Excitation.step([1.0]), step=1e-3, until=20)
""",
    "function": """
def work():
    started.set()
    titop.simulate(system, titop.Excitation.function(lambda t: [t]), step=1e-6, until=20)
""",
    "visits": """
def work():
    started.set()
    titop.sweep(system, 100000 * [{"k": 2.0}], lambda i, s: s.static_gain()[0, 0], threads=2)
"""}


class Exit(unittest.TestCase):
    def test_daemon_threads(self):
        for name, work in WORK.items():
            for attempt in range(3):
                with self.subTest(name, attempt=attempt):
                    run = subprocess.run([sys.executable, "-c", SCENE + work + END],
                                         capture_output=True, text=True, timeout=60)
                    self.assertEqual((run.returncode, run.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
