"""The trajectory of a phase as named columns: states, accelerations, algebraic variables, controls."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.rigid_body import RATE_UNITS
from robotraj.dynamics.variable import Variable
from robotraj.problem.phase import Phase
from robotraj.solution.phase_solution import PhaseSolution


def variables_of(phase: Phase) -> tuple[Variable, ...]:
    """List the variables of a phase in the order of tables and plots.

    Accelerations of a robot are those of the states' polynomials, whichever form its dynamics have.
    """
    dae, robot = phase.dae, phase.robot
    if robot is None:
        return (*dae.states, *dae.algebraic, *dae.controls)
    accelerations = tuple(
        Variable(f"a.{joint}", RATE_UNITS[unit][1], "acceleration", joint)
        for joint, unit in zip(robot.velocity_names, robot.units, strict=True)
    )
    known = {variable.name for variable in accelerations}
    others = [v for v in (*dae.algebraic, *dae.controls) if v.name not in known]
    if phase.path is not None:
        free = phase.path.free
        return (*free.states, *accelerations, *free.controls, *dae.states, *others)
    return (*dae.states, *accelerations, *others)


def values_of(part: PhaseSolution, times: Array, interval: int | None = None) -> dict[str, Array]:
    """Evaluate every variable of a phase at times [s], (m,) each, by name.

    With ``interval`` the polynomial of that interval is evaluated, for one-sided values at its knots.
    """
    sample = part.at(times, interval)
    values = {name: np.asarray(each) for name, each in (*sample.x.items(), *sample.z.items(), *sample.u.items())}
    robot = part.phase.robot
    if robot is not None:
        values |= {f"a.{joint}": a for joint, a in zip(robot.velocity_names, sample.a.T, strict=True)}
    return values
