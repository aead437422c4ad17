"""How a solve ended, and the remedy."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """How a solve ended; ``remedy`` is a sentence on the next step."""

    SOLVED = "solved"
    ROWS_VIOLATED = "rows violated"
    TOLERANCE_NOT_REACHED = "tolerance not reached"
    NOT_PROVED = "not proved"
    INFEASIBLE = "infeasible"
    NOT_FOUND = "no motion found"
    NOT_ON_THIS_MESH = "no motion found on this mesh"
    ITERATION_LIMIT = "iteration limit"
    TIME_LIMIT = "time limit"
    MEMORY_LIMIT = "memory limit"
    INTERRUPTED = "interrupted"
    STALLED = "stalled"
    DIVERGED = "diverged"
    INVALID_NUMBER = "invalid number"
    OVERDETERMINED = "overdetermined"
    SOLVER_ERROR = "solver error"
    ERROR = "error"
    DIED = "process ended"

    @property
    def remedy(self) -> str:
        """The next step, as a sentence."""
        return _REMEDIES[self]


_REMEDIES = {
    Status.SOLVED: "Nothing to do: prove it with rt.validate(solution).",
    Status.ROWS_VIOLATED: "The solver stopped at a point that violates rows; see violations(). Tighten its tolerance.",
    Status.TOLERANCE_NOT_REACHED: "The error on the last mesh exceeds the tolerance; see solution.refinement. "
    "Allow a larger one, or start from a finer mesh or a scheme of higher order.",
    Status.NOT_PROVED: "The last mesh meets its rows, but not the goals between its points; see solution.proof. "
    "Start from a finer mesh with tolerance=, or allow more time. Where joints oscillate in least time, add "
    "1e-3 * rt.objectives.SpeedVariation() to the objective.",
    Status.INFEASIBLE: "Limits exclude every motion; see conflicts and violations(). Change one of the limits, or what "
    "conflicts with it.",
    Status.NOT_FOUND: "No guess led to a motion that meets all rows, which does not exclude one. Allow more time, "
    "relax the rows named in violations(), or start from another guess.",
    Status.NOT_ON_THIS_MESH: "A motion on another mesh meets all rows at its points, so limits need not conflict. "
    "Start from another guess or use more intervals, a scheme whose control has more values, or no mesh.",
    Status.ITERATION_LIMIT: "Raise the solver's max_iterations, or continue from here with guess=solution.",
    Status.TIME_LIMIT: "Raise time_limit, or continue from here with guess=solution.",
    Status.MEMORY_LIMIT: "Raise memory_limit, or plan on fewer intervals.",
    Status.INTERRUPTED: "Continue from here with guess=solution.",
    Status.STALLED: "No further progress was possible. Start from another guess or a coarser mesh, or bound variables "
    "that diverge.",
    Status.DIVERGED: "Variables diverged. Bound the states and controls that are free.",
    Status.INVALID_NUMBER: "An expression was NaN or infinite. Keep roots and divisions away from zero by bounds on "
    "the states.",
    Status.OVERDETERMINED: "There are more equality rows than free variables. Free an end of the motion or the "
    "duration.",
    Status.SOLVER_ERROR: "The solver failed; see its message.",
    Status.ERROR: "Plan this problem alone with rt.plan to see where the error is raised.",
    Status.DIED: "Plan this problem alone with rt.plan, or give fewer workers where the machine has no memory left.",
}

STATUSES = {
    "solved": Status.SOLVED,
    "acceptable": Status.SOLVED,
    "settled": Status.SOLVED,
    "invalid number": Status.INVALID_NUMBER,
    "iteration limit": Status.ITERATION_LIMIT,
    "infeasible": Status.INFEASIBLE,
    "line search failed": Status.STALLED,
    "step failed": Status.STALLED,
    "time limit": Status.TIME_LIMIT,
    "interrupted": Status.INTERRUPTED,
    "stopped": Status.INTERRUPTED,
}
"""Status of each outcome of the method in C++, by its name."""
