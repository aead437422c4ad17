"""Which limits must give: the problem with every bound allowed to stretch, at the least total stretch.

Each inequality l <= c(point) <= u of a phase becomes l - w s <= c <= u + w s with one stretch s >= 0 for the row and a
scale w in its unit, and the sum of the stretches is minimised. Dynamics, ends of the state, contacts and links stay
exact. The least sum of absolute values leaves most stretches at zero; one reweighted solve sharpens the choice.
Source: Candes, Wakin and Boyd, Enhancing sparsity by reweighted l1 minimization, J. Fourier Anal. Appl. 14 (2008);
Gill, Murray and Saunders, SNOPT, SIAM Review 47 (2005), for the elastic mode.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import RobotrajError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Row, Where, symbols_of
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.joint_limits import own_limits
from robotraj.problem.constraints.variable_bounds import VariableBounds
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.expressions import Mayer
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.solution.conflict import Conflict
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

Array = NDArray[np.float64]
Solve = Callable[[Problem, "Solution | None"], Solution]
"""(problem, guess) -> Solution, on a mesh and with a solver of the caller's choice."""

SMALL = 1e-3
"""Stretches below this share of a row's scale do not count."""
LONGEST = 30.0
"""How many times longer than allowed a stretched motion may take."""


@dataclass(frozen=True)
class _Stretchable:
    """One row that may stretch: parameter name, the row, its scale, and the constraint that holds it."""

    name: str
    row: Row
    scale: float
    bound: BoundConstraint
    index: int


@dataclass(frozen=True)
class _Stretched(Constraint):
    """A constraint whose inequalities stretch by parameters of the phase."""

    constraint: Constraint
    prefix: str

    def stretchable(self, dynamics: Dynamics, parameters: Sequence[str]) -> list[_Stretchable]:
        """Rows with the parameters that stretch them."""
        bound = self.constraint.bind(dynamics, parameters)
        return [
            _Stretchable(f"{self.prefix}.{i}", row, _scale(row), bound, i)
            for i, row in enumerate(bound.rows)
            if bound.where in (Where.THROUGHOUT, Where.START, Where.END)
        ]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write c + w s >= l and c - w s <= u for every finite side."""
        bound = self.constraint.bind(dynamics, parameters)
        names = {entry.index: entry for entry in self.stretchable(dynamics, parameters)}
        if not names:
            return bound
        rows: list[Row] = []
        signs: list[tuple[int, float]] = []
        for i, row in enumerate(bound.rows):
            for sign, lower, upper in ((1.0, row.lower, np.inf), (-1.0, -np.inf, row.upper)):
                if np.isfinite(lower) or np.isfinite(upper):
                    rows.append(replace(row, lower=lower, upper=upper, variable=None))
                    signs.append((i, sign))

        def expression(point: Point) -> list[ca.SX]:
            values = list(bound.expression(point))
            return [values[i] + sign * names[i].scale * point.p[names[i].name] for i, sign in signs]

        return BoundConstraint(bound.name, tuple(rows), expression, bound.where)


@dataclass(frozen=True)
class _LastTime(Constraint):
    """End of a motion that begins at 0, t <= longest [s]."""

    longest: float

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write the row."""
        row = Row("duration", "s", -np.inf, self.longest)
        return BoundConstraint("duration", (row,), lambda point: [point.t], Where.END)


def stretched(problem: Problem, solve: Solve) -> tuple[Solution | None, tuple[Conflict, ...]]:
    """Find a motion with the smallest stretches.

    Parameters
    ----------
    problem : Problem
    solve : callable

    Returns
    -------
    motion : Solution or None
        Of the stretched problem; None where that was not solved either, unless it was interrupted.
    conflicts : tuple of Conflict
        Largest relative stretch first; empty where no stretch is needed: then the motion meets every row.
    """
    try:
        relaxed, entries = _relaxed(problem, {})
        found = solve(relaxed, None)
    except RobotrajError:
        return None, ()
    if not found.success:
        return (found if found.status is Status.INTERRUPTED else None), ()
    stretches = _stretches(found, entries)
    if sum(value > SMALL for value in stretches.values()) > 1:
        weights = {name: 1.0 / (value + SMALL) for name, value in stretches.items()}
        again = solve(_relaxed(problem, weights)[0], found)
        if again.success:
            found, stretches = again, _stretches(again, entries)
    listed = [
        _conflict(found, i, entry, stretches[entry.name])
        for i, of_phase in enumerate(entries)
        for entry in of_phase
        if stretches[entry.name] > SMALL
    ]
    return found, tuple(sorted(listed, key=lambda conflict: -conflict.relative))


def _relaxed(problem: Problem, weights: Mapping[str, float]) -> tuple[Problem, list[list[_Stretchable]]]:
    """Write the stretched problem, and list for each phase what stretches."""
    phases, stretchable = [], []
    alone = len(problem.phases) == 1
    for i, phase in enumerate(problem.phases):
        every: list[Constraint] = []
        if phase.robot is not None and isinstance(phase.limits, Limits):
            every += own_limits(phase.limits, phase.robot.actuated)
        for kind, mapping in (
            ("state", phase.states),
            ("control", phase.controls),
            ("algebraic variable", phase.algebraic),
        ):
            if mapping:
                every.append(VariableBounds(kind, mapping))
        every += phase.constraints
        least, longest = phase.duration_bounds
        duration = phase.duration
        if alone and np.isfinite(longest):
            every.append(_LastTime(longest))
            duration = (least, LONGEST * longest)
        wrapped = [_Stretched(constraint, f"stretch.{i}.{k}") for k, constraint in enumerate(every)]
        entries = [
            entry for constraint in wrapped for entry in constraint.stretchable(phase.body, phase.parameter_names)
        ]
        names = [entry.name for entry in entries]
        cost: Objective = Mayer(partial(_total, names=names, weights=[weights.get(name, 1.0) for name in names]))
        phases.append(
            phase.with_(
                duration=duration,
                limits=None,
                states={},
                controls={},
                algebraic={},
                constraints=wrapped,
                objective=cost,
                parameters={**phase.parameters, **{name: between(0.0, None) for name in names}},
            )
        )
        stretchable.append(entries)
    return Problem(phases, problem.links), stretchable


def _total(start: Point, end: Point, names: Sequence[str], weights: Sequence[float]) -> ca.SX:
    """Sum of the weighted stretches."""
    return ca.sum1(ca.vertcat(0, *(weight * end.p[name] for name, weight in zip(names, weights, strict=True))))


def _scale(row: Row) -> float:
    """Size in which a stretch of the row is counted: its larger finite bound, else 1, in the row's unit."""
    finite = [abs(bound) for bound in (row.lower, row.upper) if np.isfinite(bound)]
    return max([*finite, 0.0]) or 1.0


def _stretches(found: Solution, stretched: Sequence[Sequence[_Stretchable]]) -> dict[str, float]:
    return {
        entry.name: part.parameters[entry.name]
        for part, entries in zip(found.phases, stretched, strict=True)
        for entry in entries
    }


def _conflict(found: Solution, index: int, entry: _Stretchable, stretch: float) -> Conflict:
    """Locate a stretched row: where along the motion it is furthest beyond its bounds, and the value it needs there."""
    part = found.phases[index]
    phase: Phase = part.phase
    names = phase.parameter_names
    point = symbols_of(phase.body, names)
    value = ca.SX(entry.bound.expression(point)[entry.index])
    p = [part.parameters[name] for name in names]
    symbols = [ca.vertcat(ca.SX(0, 1), *named.values()) for named in (point.x, point.z, point.u, point.p)]
    function = ca.Function("row", [point.t, *symbols], [value])
    times = {Where.START: part.points[:1], Where.END: part.points[-1:]}.get(
        entry.bound.where, np.unique(np.append(part.points, part.knots))
    )
    sample = part.at(times)
    columns = [np.reshape(list(named.values()), (-1, len(times))) for named in (sample.x, sample.z, sample.u)]
    values = np.array(function(times[None], *columns, np.tile(p, (len(times), 1)).T)).ravel()
    low, high = entry.row.lower - values, values - entry.row.upper
    worst = int(np.argmax(np.maximum(low, high)))
    upper = bool(high[worst] >= low[worst])
    bound = entry.row.upper if upper else entry.row.lower
    amount = stretch * entry.scale
    return Conflict(
        phase.name,
        entry.row.label,
        float(times[worst]),
        bound,
        bound + amount if upper else bound - amount,
        entry.row.unit,
        stretch,
        entry.row.label == "duration" or entry.row.variable is not None or entry.row.joint in _joints(phase),
    )


def _joints(phase: Phase) -> tuple[str, ...]:
    return phase.robot.velocity_names if phase.robot is not None else ()
