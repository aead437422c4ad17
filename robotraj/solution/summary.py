"""What ``print(solution)`` shows: figures, meshes, proof and, where no motion was found, the reason and the remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotraj._util.printing import wrapped
from robotraj.solvers.status import Status

if TYPE_CHECKING:
    from robotraj.solution.solution import Solution

CONVERGED = (Status.SOLVED, Status.TOLERANCE_NOT_REACHED, Status.NOT_PROVED)
"""Statuses of motions that satisfy every row: only of these is it shown what happens between the knots."""
CHANGE_LIMITS = "Change one of these limits or the motion that conflicts with it."


def summary(solution: Solution) -> str:
    """Return the text of a solution in lines of at most 80 columns."""
    converged = solution.status in CONVERGED
    lines = [
        f"{solution.status.value}: objective {solution.objective:.8g}, duration {solution.duration:.6g} s, "
        f"{solution.iterations} iterations, {solution.seconds:.3g} s"
    ]
    lines += [
        f"  {stage.name}: {stage.status.value}, objective {stage.objective:.8g}, "
        f"{stage.iterations} iterations, {stage.seconds:.3g} s"
        for stage in solution.continuation
    ]
    lines += [
        f"  mesh {i}: {step.intervals} intervals, {step.points} points, error {step.error:.2e}, "
        f"objective {step.objective:.10g}, {step.iterations} iterations, {step.seconds:.3g} s"
        for i, step in enumerate(solution.refinement, 1)
    ]
    if solution.proof is not None:
        lines.append(str(solution.proof))
    elif converged and not solution.refinement and (error := solution.error) is not None:
        lines.append(f"error between knots {error:.1e}; nothing was proved (plan with tolerance=, or without mesh=)")
    if converged and solution.interval_violations:
        lines.append(f"between collocation points: {solution.interval_violations[0]}; a finer mesh would help")
    if converged and solution.control_interval_violations:
        worst = solution.control_interval_violations[0]
        lines.append(
            f"between collocation points: {worst}; "
            f"interval_limits=rt.interval_limits.BernsteinBounds(controls=True) would hold it"
        )
    if not solution.success:
        lines += [f"what must give: {solution.in_phase(conflict)}" for conflict in solution.conflicts[:5]]
        lines += [f"solver: {solution.message}"]
        lines += [f"  {solution.in_phase(violation)}" for violation in solution.violations(5)]
        lines += [f"try: {CHANGE_LIMITS if solution.conflicts else solution.status.remedy}"]
    # A line is indented by its rank; what does not fit goes on below, indented further.
    return "\n".join(part for line in lines for part in wrapped(line.lstrip(), line[: len(line) - len(line.lstrip())]))
