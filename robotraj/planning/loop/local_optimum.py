"""Whether a plan whose solver stopped early is a local optimum: one more solve starts from it and may not gain.

The objectives of two meshes are compared where both solves converged, to a tolerance far below the goal. Solves that
stop early on each mesh leave the same objective, and the comparison takes that for an optimum. The solve that is made
here has its own tolerance, estimates its multipliers anew, and starts from a larger barrier. It takes the compiled
program of the plan's first mesh, so that its iterations are all it costs. A mesh that is no finer has no better optimum
nearby: what it gains, the plan has missed.
"""

from __future__ import annotations

from robotraj.fixed_mesh.checked_solution import checked_solution
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.guess.from_solution import FromSolution
from robotraj.solution.claims.objective_size import size_for
from robotraj.solution.proof import Goals
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress, Solver
from robotraj.solvers.compiled import origin_of
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.objective_quadrature import smoothing_cost
from robotraj.transcription.reuse import started_at

TOLERANCE = 1e-3
"""Tolerance of the solve relative to the goal of the objective."""


def is_converged(found: Solution, goals: Goals) -> bool:
    """Whether the solver met a tolerance that is ``TOLERANCE`` times the goal of the objective."""
    origin = origin_of(found.multipliers)
    return origin is not None and origin.accuracy <= TOLERANCE * goals.objective


def can_be_solved_again(first: Solution) -> bool:
    """Whether a solution has its program."""
    return first.multipliers is not None and first.multipliers.origin is not None


def gain_from(
    plan: Solution, first: Solution, goals: Goals, solver: Solver, progress: Progress | None = None
) -> tuple[Solution, float]:
    """Solve from a plan on the mesh of its first solution.

    The gain is the lesser one of two: that over the plan's objective, and that over the sum that the plan has at the
    points of this mesh. It is 0 where the solve does not converge in ``PATIENCE`` iterations.

    Parameters
    ----------
    plan, first : Solution
        The plan, and the first solution of the same problem with its program.
    goals : Goals
    solver : Solver
        Solver of the plan.
    progress : callable, optional

    Returns
    -------
    solution : Solution
    share : float
        Share of the objective that it gains.
    """
    known = first.multipliers
    assert known is not None and known.origin is not None
    nlp = started_at(known.origin.nlp, FromSolution(plan))
    nearby = solver.from_nearby(altered=True).at_most(PATIENCE)
    careful = nearby.accurate_to(TOLERANCE * goals.objective)
    outcome = careful.resolve(nlp, known, progress)
    found = checked_solution(nlp, outcome, {})
    if outcome.status is not Status.SOLVED:
        return found, 0.0
    # The program's objective includes the cost of smoothing, and that of the plan does not.
    smoothing = sum(smoothing_cost(p.phase, p.trajectory, p.mesh.schemes, nlp.smoothing) for p in plan.phases)
    before = min(plan.objective + smoothing, nlp.objective(nlp.guess))
    gain = max(0.0, before - nlp.objective(outcome.w))
    return found, gain / size_for(gain, goals.objective, plan.phases, plan.objective)
