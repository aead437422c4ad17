"""Problems whose relaxed form has no local minima: linear dynamics, rows and links, and given durations.

The relaxed problem on a mesh is then a linear program. If its least sum is above zero, no motion on the mesh meets all
rows. A free duration counts as given at its upper bound where the robot can wait at one of its ends: a motion that
takes less time, followed or preceded by rest, takes that long.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj._util.precision import SAME
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.elastic import relaxed_motion
from robotraj.problem.constraints.base import Where
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import are_clear
from robotraj.solution.solution import Solution


def excluded_on_finer_mesh(problem: Problem, finer: CoarseSolves, guess: Solution) -> bool:
    """Whether the relaxed problem is a linear program, and needs clear slacks on a finer mesh.

    Parameters
    ----------
    problem : Problem
    finer : CoarseSolves
    guess : Solution
        Guess of the relaxed problem.
    """
    longest = _at_longest_durations(problem)
    return longest is not None and are_clear(relaxed_motion(longest, finer, guess)[1])


def _at_longest_durations(problem: Problem) -> Problem | None:
    """Return a problem with given durations that has a motion if the given one has; None if it is not linear."""
    if not all(isinstance(link, Continuity) for link in problem.links) or not all(map(_is_linear, problem.phases)):
        return None
    longest = [phase.duration_bounds[1] for phase in problem.phases]
    fixed = [phase.duration_bounds[0] == phase.duration_bounds[1] for phase in problem.phases]
    waits = len(problem.phases) == 1 and np.isfinite(longest[0]) and _waits(problem.phases[0])
    if not all(fixed) and not waits:
        return None
    phases = [replace(phase, duration=time) for phase, time in zip(problem.phases, longest, strict=True)]
    return Problem(phases, problem.links)


def _is_linear(phase: Phase) -> bool:
    """Whether rates, residuals and rows of a phase are affine in its variables."""
    table = phase.rows
    if phase.path is not None or phase.bound_contacts or phase.dae.invariants:
        return False
    if any(each.avoids_collisions for each in phase.constraints):
        return False
    variables = ca.vertcat(*table.symbols[1:])
    rows = [row for row in table if row.kind not in (Kind.BOUND, Kind.RATE)]
    parts = ca.vertcat(table.dae.rates(table.point), table.dae.residual(table.point), *table.expressions(rows))
    return bool(ca.is_linear(parts, variables))


def _waits(phase: Phase) -> bool:
    """Whether controls within all rows keep the system at its given start or end, at any time and for any time."""
    table = phase.rows
    t, x, z, u, p = table.symbols
    throughout = [row for row in table.throughout if row.kind is not Kind.BOUND]
    balance = ca.vertcat(table.dae.rates(table.point), table.dae.residual(table.point))
    parts = ca.vertcat(balance, *table.expressions(throughout))
    if any(row.where in (Where.INTEGRAL, Where.RATE) for row in table) or ca.depends_on(parts, ca.vertcat(t, p)):
        return False
    inner = ca.vertcat(z, u)
    evaluate = ca.Function("parts", [x, inner], [ca.densify(parts), ca.densify(ca.jacobian(parts, inner))])
    (z_low, z_high), (u_low, u_high) = (table.limits_of(each) for each in (table.dae.algebraic, table.dae.controls))
    ranges = list(zip(np.append(z_low, u_low), np.append(z_high, u_high), strict=True))
    count = balance.numel()
    low = np.append(np.zeros(count), [row.lower for row in throughout])
    high = np.append(np.zeros(count), [row.upper for row in throughout])
    for bounds in (phase.start_bounds, phase.end_bounds):
        state = np.asarray(bounds.lower)[: x.numel()]
        if len(state) < x.numel() or not np.array_equal(state, np.asarray(bounds.upper)[: x.numel()]):
            continue
        values, slopes = (np.array(each) for each in evaluate(state, np.zeros(inner.numel())))
        if _is_solvable(slopes, low - values.ravel(), high - values.ravel(), ranges):
            return True
    return False


def _is_solvable(slopes: np.ndarray, low: np.ndarray, high: np.ndarray, ranges: Sequence[tuple[float, float]]) -> bool:
    """Whether low <= A w <= high has a solution w within its ranges."""
    if not ranges:
        return bool(np.all(low <= SAME) and np.all(high >= -SAME))
    from scipy.optimize import linprog

    above, below = np.isfinite(high), np.isfinite(low)
    rows = np.vstack([slopes[above], -slopes[below]])
    sides = np.append(high[above], -low[below]) + SAME
    return bool(linprog(np.zeros(len(ranges)), rows, sides, bounds=ranges).status == 0)
