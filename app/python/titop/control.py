"""Models for the package control (python-control)."""
from . import _titop


def control(system):
    """The python-control `ss` of a System, ReducedSystem, StateSpace or DiscreteModel, with the
    names of states, inputs and outputs; a '.' in a name becomes '_'. Raises ImportError without
    the package control.
    """
    import control as package

    period = 0
    if isinstance(system, _titop.DiscreteModel):
        system, period = system.model, system.period
    if not isinstance(system, _titop.StateSpace):
        system = system.state_space()

    def clean(names):
        return [name.replace(".", "_") for name in names]

    return package.ss(*system, period, states=clean(system.states), inputs=clean(system.inputs),
                      outputs=clean(system.outputs))
