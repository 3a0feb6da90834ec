"""Every public name of the module, and of its classes, has its type in the stubs, and nothing
else; and every class, function, method and property has a docstring."""
import ast
import inspect
import pathlib
import re
import unittest

import titop

FOLDER = pathlib.Path(titop.__file__).parent
# Of Python's own, or of pybind11's.
OWN = {"__doc__", "__module__", "__init__", "__new__", "__repr__", "__str__", "__dict__",
       "__weakref__", "__reduce__", "__array_ufunc__", "_pybind11_conduit_v1_"}


def stub_of(file):
    tree = ast.parse((FOLDER / file).read_text())
    names = {}
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names[node.name] = members_of(node) if isinstance(node, ast.ClassDef) else None
    return names


def members_of(node):
    names = set()
    for item in node.body:
        if isinstance(item, ast.FunctionDef):
            names.add(item.name)
        elif isinstance(item, ast.AnnAssign):
            names.add(item.target.id)
    return names - OWN


def public(module):
    return {name: value for name, value in vars(module).items()
            if not name.startswith("_") and (inspect.isclass(value) or callable(value))}


def texts(member, name):
    """The docstrings of a member; of pybind11's functions each overload's, without its signature."""
    text = inspect.getdoc(member) or ""
    signature = rf"(?:^|\n)(?:\d+\. )?{name}\(.*\) -> .*"
    return re.split(signature, text)[1:] if re.match(rf"{name}\(", text) else [text]


class Stubs(unittest.TestCase):
    def check_text(self, owner, name, member):
        for text in texts(member, name):
            self.assertRegex(text, r"\w|\[", f"{owner}.{name} has no docstring")

    def compare(self, module, file):
        stub = stub_of(file)
        self.assertEqual(set(stub), set(public(module)))
        for name, value in public(module).items():
            self.check_text(module.__name__, name, value)
            if inspect.isclass(value):
                members = set(vars(value)) - OWN
                for member in members:
                    if not member.startswith("_"):
                        self.check_text(name, member, vars(value)[member])
                if value is titop.Mistake:
                    members |= {"code", "message", "details", "hint", "places"}
                elif value is titop.Error:
                    members |= {"mistakes"}
                elif value is titop.Report:
                    members |= {"html"}
                self.assertEqual(stub[name], members, name)

    def test_names(self):
        self.compare(titop, "__init__.pyi")
        self.compare(titop.fe, "fe.pyi")


if __name__ == "__main__":
    unittest.main()
