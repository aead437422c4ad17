"""The solution of one solve: every row is evaluated again, outside the solver."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from robotraj._util.lazy_values import LazySequence
from robotraj._util.precision import MET
from robotraj.fixed_mesh.between.nlp_violations import violations
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.records import Round
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Outcome
from robotraj.solvers.status import Status
from robotraj.transcription.extract import extract
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.refinement.objective_quadrature import smoothing_cost, surplus


def checked_solution(nlp: Nlp, outcome: Outcome, times: dict[str, float]) -> Solution:
    """Evaluate every row again, outside the solver, and return the solution.

    Parameters
    ----------
    nlp : Nlp
    outcome : Outcome
        What the solver returned.
    times : dict of str to float
        Seconds spent before it, by part.

    Returns
    -------
    Solution
        Its status is ``Status.ROWS_VIOLATED`` where the solver reports success but a row is violated. It is
        ``Status.OVERDETERMINED`` where an infeasible NLP has more equations than unknowns.
    """
    outputs = nlp.outputs(outcome.w)
    broken = violations(nlp, outcome.w, MET, outputs)
    status = outcome.status
    if status is Status.SOLVED and broken:
        status = Status.ROWS_VIOLATED
    if status is Status.INFEASIBLE and _more_equations_than_unknowns(nlp):
        status = Status.OVERDETERMINED
    trajectories = extract(nlp, outcome.w, outputs)
    phases = tuple(
        PhaseSolution(phase, layout.mesh, trajectory)
        for phase, layout, trajectory in zip(nlp.problem.phases, nlp.layouts, trajectories, strict=True)
    )
    # Slacks of absolute values count with their least values: the solver's are larger by its barrier.
    beyond = sum(
        surplus(part.phase, part.trajectory, part.mesh.schemes)
        + smoothing_cost(part.phase, part.trajectory, part.mesh.schemes, nlp.smoothing)
        for part in phases
    )
    objective, spent = nlp.objective(outcome.w, outputs) - beyond, times | outcome.times
    # Times named "solve: ..." are parts of others.
    seconds = sum(value for name, value in spent.items() if ":" not in name)
    intervals = sum(layout.mesh.count for layout in nlp.layouts)
    return Solution(
        nlp.problem,
        phases,
        status,
        outcome.message,
        objective,
        outcome.iterations,
        spent,
        broken,
        outcome.multipliers,
        duals=_lazy_duals(nlp, outcome) if status is Status.SOLVED else (),
        impulses=tuple(
            {unknown.name: float(value) for unknown, value in zip(link.unknowns, outcome.w[columns], strict=True)}
            for link, columns in zip(nlp.problem.bound_links, nlp.link_columns, strict=True)
        ),
        rounds=(Round(intervals, status, objective, outcome.iterations, seconds, outcome.by),),
    )


def _more_equations_than_unknowns(nlp: Nlp) -> bool:
    equations = np.sum(nlp.rows.lower == nlp.rows.upper)
    return bool(equations > np.sum(nlp.variables.lower < nlp.variables.upper))


def _lazy_duals(nlp: Nlp, outcome: Outcome) -> LazySequence[PhaseDuals]:
    # Costates are not unique where invariants are imposed as rows. The copy of the NLP has no cached functions.
    constrained = any(phase.dae.invariants for phase in nlp.problem.phases)
    return LazySequence(partial(_duals, replace(nlp), outcome), 0 if constrained else len(nlp.layouts))


def _duals(nlp: Nlp, outcome: Outcome) -> tuple[PhaseDuals, ...]:
    """Return duals as functions of time."""
    from robotraj.solution.costates.covector import covectors

    return covectors(nlp, outcome.w, outcome.multipliers)
