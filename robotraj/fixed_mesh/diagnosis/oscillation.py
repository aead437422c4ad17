"""A warning before planning: least time under a limit on a speed that the wheels share.

Where the limit on the speed of wheels determines the duration, many motions of the joints are equally short. The solver
chooses among them by the gaps between the points, through which oscillating joints gain a little. Their proof takes
many rounds, and some plans are not proved. Other limits that joints share need no warning (``shared_limits``).
"""

from __future__ import annotations

from robotraj._util.errors import warn
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.differential_drive import DifferentialDrive
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem


def warn_of_oscillation(problem: Problem) -> None:
    """Warn of phases of least time whose joints may oscillate, and name the cost that makes their motion unique.

    Warns
    -----
    UserWarning
    """
    for phase in problem.phases:
        limit = next((type(each).__name__ for each in phase.constraints if _is_shared(each)), None)
        if limit is not None and _takes_least_time(phase):
            warn(
                f"Phase {phase.name!r}: in least time under {limit}, joints may oscillate, and plans take long. "
                "Add 1e-3 * rt.objectives.SpeedVariation() to the objective."
            )


def _is_shared(constraint: Constraint) -> bool:
    return isinstance(constraint, DifferentialDrive)


def _takes_least_time(phase: Phase) -> bool:
    terms = [term for _, term in phase.objective.terms] if phase.objective else []
    return any(isinstance(each, Duration) for each in terms) and not any(isinstance(each, Integral) for each in terms)
