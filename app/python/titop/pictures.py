"""Diagrams, plots and reports for notebooks."""
import html
import pathlib
import shutil
import subprocess

from . import _titop


class Svg(str):
    """A picture as SVG text; notebooks show it."""

    def _repr_svg_(self):
        return str(self)

    def write(self, file):
        """Writes it to a file."""
        pathlib.Path(file).write_text(self, encoding="utf-8")


def _picture(function):
    def plot(*args, **options):
        return Svg(function(*args, **options))

    plot.__name__ = function.__name__
    plot.__doc__ = function.__doc__
    return plot


plot_bode = _picture(_titop.plot_bode)
plot_step = _picture(_titop.plot_step)
plot_sigma = _picture(_titop.plot_sigma)
plot_nyquist = _picture(_titop.plot_nyquist)
plot_poles = _picture(_titop.plot_poles)
plot_mode = _picture(_titop.plot_mode)


class Report:
    """A report of a system as one HTML page; notebooks show it in a frame."""

    def __init__(self, text):
        self.html = text

    def write(self, file):
        """Writes the page to a file."""
        pathlib.Path(file).write_text(self.html, encoding="utf-8")

    def _repr_html_(self):
        return (f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="700" '
                'style="border: 1px solid #ccc"></iframe>')


def report(system, **options):
    """The report of a System: options as of report_html."""
    return Report(_titop.report_html(system, **options))


def _drawing(thing):
    """SVG of a diagram or of a system after all passes by Graphviz; None without `dot`."""
    dot = shutil.which("dot")
    if not dot:
        return None
    text = _titop.to_dot(thing, fold=40)
    return subprocess.run([dot, "-Tsvg"], input=text, capture_output=True, text=True,
                          check=True).stdout


_titop.Diagram._repr_svg_ = _drawing
_titop.System._repr_svg_ = _drawing
