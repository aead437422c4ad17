"""Limits of jerks and of rates of torques that must give.

They bound derivatives of polynomials, to which no slack can be added row by row. All of them are therefore widened by
one factor f >= 1. It is doubled until the relaxed problem needs no slack, and then bisected to the least such factor.
Where the widest limits do not suffice, other rows must give whatever the rates are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.elastic import motion_near, relaxed_motion
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.motors.rates import RateLimit
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.solution.conflict import Conflict, with_room
from robotraj.solution.solution import Solution
from robotraj.transcription.interval_limits.row_values import Rates

WIDEST = 1024.0
"""Largest factor that is tried."""
BISECTIONS = 4
"""Bisections of the factor, to a sixteenth of its last doubling."""
PLACES = np.linspace(0.0, 1.0, 5)
"""Places of an interval at which rates are read."""


def wider_rates(
    problem: Problem, coarse: CoarseSolves, guess: Solution | None
) -> tuple[tuple[Conflict, ...], Solution | None]:
    """Return the limit of a rate that must give, or else the rows that must give first, and a motion with wider limits.

    Parameters
    ----------
    problem : Problem
    coarse : CoarseSolves
    guess : Solution or None

    Returns
    -------
    conflicts : tuple of Conflict
        The row of every phase that is used most in the motion with the least factor, largest first. Otherwise the
        relaxed rows of the motion within the widest limits. Empty where the problem has no such limits.
    motion : Solution or None
        None without conflicts.
    """
    if not any(phase.rows.rates for phase in problem.phases):
        return (), None

    def motion_with(factor: float) -> Solution | None:
        motion, meets_rows = motion_near(_widened(problem, factor), coarse, guess)
        return motion if meets_rows else None

    enough, motion = 2.0, motion_with(2.0)
    # Where the widest limits do not suffice, all narrower ones would be tried in vain.
    widest = motion_with(WIDEST) if motion is None else None
    while motion is None and widest is not None:
        enough *= 2.0
        motion = motion_with(enough) if enough < WIDEST else widest
    if motion is None:
        motion, others = relaxed_motion(_widened(problem, WIDEST), coarse, guess)
        return others, motion
    too_little = 0.5 * enough
    for _ in range(BISECTIONS):
        middle = 0.5 * (too_little + enough)
        found = motion_with(middle)
        if found is None:
            too_little = middle
        else:
            enough, motion = middle, found
    # Wherever the motion with the least factor is at a limit, that limit must give; so must others that it exceeds.
    worst: dict[str, Conflict] = {}
    for used in sorted(_used(problem, motion, enough), key=lambda conflict: -conflict.relative):
        if not worst or used.relative > 0.0:
            worst.setdefault(used.phase, used)
    return tuple(worst.values()), motion


def _widened(problem: Problem, factor: float) -> Problem:
    phases = [
        phase.with_(
            constraints=[_wider(each, phase, factor) for each in phase.constraints],
            limits=phase.limits.scaled(jerk=factor) if isinstance(phase.limits, Limits) else None,
        )
        for phase in problem.phases
    ]
    return Problem(phases, problem.links)


def _wider(constraint: Constraint, phase: Phase, factor: float) -> Constraint:
    """Return a limit of rates with ``factor`` times its bounds, which still begins and ends at rest; others as is."""
    if not isinstance(constraint, RateLimit) or phase.robot is None:
        return constraint
    limited = constraint.limited(phase.robot)
    return replace(constraint, bounds={joint: between(factor * low, factor * high) for joint, low, high in limited})


def _used(problem: Problem, motion: Solution, factor: float) -> Iterator[Conflict]:
    """Yield the greatest rate of every limited variable in a motion, as a bound that would do."""
    for phase, part in zip(problem.phases, motion.phases, strict=True):
        for variables, curve in ((phase.dae.algebraic, part.trajectory.z), (phase.dae.controls, part.trajectory.u)):
            for row, column in phase.rows.rates_of(variables):
                rates = Rates(curve, [column])
                values = rates.grid(PLACES)[..., 0]
                shares = np.where(values < 0.0, values / row.lower, values / row.upper)
                interval, place = np.unravel_index(int(np.argmax(shares)), shares.shape)
                bound = row.lower if values[interval, place] < 0.0 else row.upper
                first, last = rates.breaks[interval : interval + 2]
                needed = with_room(bound, bound * min(float(shares[interval, place]), factor))
                time = float(first + (last - first) * PLACES[place])
                yield Conflict(
                    phase.name, row.label, time, bound, needed, row.unit, float(shares.max()) - 1.0, physical=True
                )
