"""The errors of plans: no solution, or Ctrl-C."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotraj._util.errors import RobotrajError

if TYPE_CHECKING:
    from robotraj.solution.solution import Solution


class PlanInterrupted(KeyboardInterrupt):
    """Ctrl-C ended a plan; ``solution`` is the best motion or the last iterate.

    Attributes
    ----------
    solution : robotraj.Solution
        It may be solved. ``rt.plan(problem, guess=error.solution)`` continues from it.
    """

    def __init__(self, message: str, solution: Solution) -> None:
        super().__init__(message)
        self.solution = solution

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.solution)


class NoSolutionFound(RobotrajError):
    """The solver stopped without a solution; ``solution`` is the last iterate.

    Attributes
    ----------
    solution : robotraj.Solution
        The last iterate, with its status, remedy and violated rows.
    """

    def __init__(self, message: str, solution: Solution) -> None:
        super().__init__(message)
        self.solution = solution

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.solution)
