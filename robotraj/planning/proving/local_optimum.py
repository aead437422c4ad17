"""Whether a plan is a local optimum: one more solve starts from it, on a mesh no finer, and may not gain.

Meshes are compared where both solves converged. A solve that stops early on each of them leaves the same objective, and
the comparison takes that for an optimum. The solve that is made here has its own tolerance, estimates its multipliers
anew, and starts from a larger barrier. It takes the compiled program of the plan's first mesh, so that its iterations
are all it costs. A mesh that is no finer has no better optimum nearby: what it gains, the plan has missed.
"""

from __future__ import annotations

from typing import NamedTuple

from robotraj.guess.from_solution import FromSolution
from robotraj.planning.checked_solution import checked_solution
from robotraj.solution.claims.objective_size import size_for
from robotraj.solution.proof import Goals
from robotraj.solution.records import Round
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Outcome, Progress, Solver
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.refinement.objective_quadrature import smoothing_cost
from robotraj.transcription.reuse import started_at

TOLERANCE = 1e-3
"""Tolerance of the solve relative to the goal of the objective."""
MOST = 2
"""Largest number of iterations relative to those of the first solve."""


class Gain(NamedTuple):
    """The outcome of the further solve, its NLP, and the share of the objective that it gains."""

    nlp: Nlp
    outcome: Outcome
    share: float

    @property
    def solution(self) -> Solution:
        """The solution on the coarse mesh."""
        return checked_solution(self.nlp, self.outcome, {})

    @property
    def round(self) -> Round:
        """The solve in the history of the plan."""
        intervals = sum(layout.mesh.count for layout in self.nlp.layouts)
        seconds = sum(value for part, value in self.outcome.times.items() if ":" not in part)
        found = self.outcome.status, self.nlp.objective(self.outcome.w), self.outcome.iterations
        return Round(intervals, *found, seconds, lacked=f"back on the first mesh the plan gains {self.share:.1e}")


def gain_from(
    plan: Solution, first: Solution, goals: Goals, solver: Solver, progress: Progress | None = None
) -> Gain | None:
    """Solve from a plan on the mesh of its first solution.

    The gain is the lesser one of two: that over the plan's objective, and that over the sum that the plan has at the
    points of this mesh. It is 0 where the solve does not converge in one iteration more than ``MOST`` times those of
    the first one.

    Parameters
    ----------
    plan, first : Solution
        The plan, and the first solution of the same problem.
    goals : Goals
    solver : Solver
        Solver of the plan.
    progress : callable, optional

    Returns
    -------
    Gain or None
        None where the first solution has no program.
    """
    known = first.multipliers
    if known is None or known.origin is None:
        return None
    nlp = started_at(known.origin.nlp, FromSolution(plan))
    nearby = solver.from_nearby(altered=True).at_most(1 + MOST * first.iterations)
    careful = nearby.accurate_to(TOLERANCE * goals.objective)
    outcome = careful.resolve(nlp, known, progress)
    if outcome.status is not Status.SOLVED:
        return Gain(nlp, outcome, 0.0)
    # The program's objective includes the cost of smoothing, and that of the plan does not.
    smoothing = sum(smoothing_cost(p.phase, p.trajectory, p.mesh.schemes, nlp.smoothing) for p in plan.phases)
    before = min(plan.objective + smoothing, nlp.objective(nlp.guess))
    gain = max(0.0, before - nlp.objective(outcome.w))
    return Gain(nlp, outcome, gain / size_for(gain, goals.objective, plan.phases, plan.objective))
