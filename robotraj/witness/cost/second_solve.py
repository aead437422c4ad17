"""A second solve, from the plan, on meshes twice as fine: what it gains, the plan has missed.

The planner compares its own solves. A plan that is no optimum may therefore have a proof that holds: of another plan,
of another objective, or of a solver that stopped early. The solve takes over nothing but the motion
(``finer_motions``). The costs of both motions are integrals along them by Gauss's rule, and a gain counts where the
better motion itself passes every other claim of the validation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solution.claims.objective_size import size_for
from robotraj.solution.solution import Solution
from robotraj.witness.cost.objective import objective_check
from robotraj.witness.protocols import SolutionLike


@dataclass(frozen=True, eq=False)
class SecondSolve(OneLine):
    """The cheapest motion that a solve from the plan finds.

    Attributes
    ----------
    before, after : float
        Costs of the plan and of that motion.
    gain : float
        Share of the objective that it gains, 0 where it costs more; relative to ``objective_size``.
    better : Solution or None
        The motion, where it gains more than is allowed.
    faults : tuple of str
        What a validation finds wrong with the better motion.
    reason : str
        Why there is no such motion to compare with; empty if there is one.
    """

    before: float
    after: float
    gain: float
    better: Solution | None = None
    faults: tuple[str, ...] = ()
    reason: str = ""


def second_solve(solution: SolutionLike, allowed: float, clock: Callable[[], None] = lambda: None) -> SecondSolve:
    """Solve from a plan on meshes twice as fine.

    Parameters
    ----------
    solution : Solution
    allowed : float
        Share of the objective that may be gained.
    clock : callable
        Called once an iteration; may raise.
    """
    before = objective_check(solution, clock).of_motion
    found = SecondSolve(before, before, 0.0, reason="it is no solution of rt.plan")
    if not isinstance(solution, Solution):
        return found
    from robotraj.witness.cost.finer_motions import finer_motions

    try:
        for motion in finer_motions(solution, allowed, clock):
            if not motion.success:
                why = f"the second solve did not converge: {motion.message}"
                return found if found.better is not None else replace(found, reason=why)
            after = objective_check(motion, clock).of_motion
            gain = max(0.0, before - after)
            share = gain / size_for(gain, allowed, solution.phases, before)
            if share <= allowed:
                return SecondSolve(before, after, share)
            found = SecondSolve(before, after, share, replace(motion, objective=after))
    except InputError as error:
        return replace(found, reason=f"the plan cannot be solved again: {error}")
    return found
