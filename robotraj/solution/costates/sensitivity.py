"""Sensitivities: the derivative of the optimum by a number of the problem, from the multipliers of one plan.

With the Lagrangian

    L(w, theta) = f(w, theta) + rows' (g(w, theta) - b(theta)) + bounds' (w - c(theta)),

in which b and c are the bounds that the multipliers belong to, the derivative of the optimal objective is the partial
derivative of L by theta at the solution. It is taken by central differences of the transcription, which is smooth in
theta. Nothing is solved again. Rows that were added between the points count as if they stayed at their places.

Source: Fiacco, Introduction to Sensitivity and Stability Analysis in Nonlinear Programming (1983), theorem 3.4.1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_number
from robotraj._util.errors import InputError, unknown_name
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solvers.base import Multipliers
from robotraj.solvers.kept_multipliers import KeptMultipliers
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Scalars

STEP = 1e-4
"""Step of the differences, relative to the number and at least to 1; their error is some 1e-9 of a third derivative."""


def sensitivity(kept: Multipliers | None, problem: Problem, by: str | Callable[[float], Problem | Phase]) -> float:
    """Return dJ/dtheta, the derivative of the optimal objective.

    Parameters
    ----------
    kept : Multipliers or None
        Multipliers of a released solution.
    problem : Problem
        Problem of the solution.
    by : str or callable
        Name of a fixed parameter, ``"duration"`` for a fixed duration, or a function of a step that returns the problem
        with a number that is larger by the step.

    Raises
    ------
    InputError
        The name is none of these, the function changes more than numbers, or the solution has no raw multipliers.
    """
    if not isinstance(kept, KeptMultipliers):
        raise InputError(
            "Sensitivities need a solved plan without rt.CollisionFree, as rt.plan returned it: files keep no program."
        )
    vary, size = (by, 1.0) if callable(by) else _named(problem, by)
    step = STEP * max(1.0, abs(size))
    above, below = (_lagrangian(kept, vary(h)) for h in (step, -step))
    return (above - below) / (2.0 * step)


def _named(problem: Problem, name: str) -> tuple[Callable[[float], Problem], float]:
    """Return the problem as a function of a step of a named number, and the number."""
    known = [
        {key: float(value) for key, value in phase.parameters.items() if is_number(value)}
        | ({"duration": float(phase.duration)} if is_number(phase.duration) else {})
        for phase in problem.phases
    ]
    values = [numbers[name] for numbers in known if name in numbers]
    if not values:
        raise unknown_name("fixed number of the problem", name, sorted(set().union(*known)))

    def vary(step: float) -> Problem:
        phases = []
        for phase, numbers in zip(problem.phases, known, strict=True):
            if name in phase.parameters and name in numbers:
                phase = phase.with_(parameters={**phase.parameters, name: numbers[name] + step})
            elif name in numbers:
                phase = phase.with_(duration=numbers[name] + step)
            phases.append(phase)
        return Problem(phases, problem.links, problem.missing)

    return vary, values[0]


def _lagrangian(kept: KeptMultipliers, problem: Problem | Phase) -> float:
    """Return L at the solution for a problem with other numbers."""
    posed = Problem([problem]) if isinstance(problem, Phase) else problem
    nlp: Nlp = kept.of_problem(posed).nlp
    if kept.sizes != (len(nlp.rows), len(nlp.variables)):
        raise InputError("by= changes more than numbers of the problem: the plan has other rows or variables with it.")
    outputs = nlp.outputs(kept.w)
    rows = kept.rows @ (nlp.values(kept.w, outputs) - _bound(nlp.rows, kept.rows))
    return float(nlp.objective(kept.w, outputs) + rows + kept.bounds @ (kept.w - _bound(nlp.variables, kept.bounds)))


def _bound(scalars: Scalars, multipliers: Array) -> Array:
    """Return the bound that each multiplier belongs to: the upper one where it is positive; 0 without one."""
    bound = np.where(multipliers > 0.0, scalars.upper, scalars.lower)
    return np.where(np.isfinite(bound), bound, 0.0)
