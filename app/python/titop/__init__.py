"""titop: from block diagrams of flexible bodies to one minimal state-space model.

Equations are assignments to attributes of ports:

    d = titop.Diagram("masses")
    u = d.input("u")                                                # [N]
    z = d.add("z", titop.SpringMass(mass=1.0, stiffness=10.0))      # [kg], [N/m]
    z.parent.accel = 0
    z.child.force += u
    d.output["x"] = z.stretch                                       # [m]
    A, B, C, D = titop.compile(d).state_space()

Units are SI; the C++ headers are the reference manual. Mistakes raise titop.Error.
"""
import sys as _sys

from . import _titop
from ._titop import *
from ._titop import fe
from .errors import CompileWarning, Error, Mistake
from .control import control
from .pictures import (Report, Svg, plot_bode, plot_mode, plot_nyquist, plot_poles, plot_sigma,
                       plot_step, report)

_sys.modules[__name__ + ".fe"] = fe
