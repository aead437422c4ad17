"""Rows that the configurations at the ends of phases must satisfy, with their symbols.

They are the limits, the states given at an end, contacts, links, and the mean speeds between both ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.point import Point
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.row import Measure
from robotraj.guess.along_path import SHORTEST
from robotraj.problem.constraints.base import Where
from robotraj.problem.links.base import Ends
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits

QUATERNION_WEIGHT, END_WEIGHT, CONSTRAINT_WEIGHT, LIMIT_WEIGHT = 1e3, 20.0, 5.0, 1.0
"""Weights of slacks: quaternions' lengths and roots; states given at an end; contacts, links, frames there; limits."""


@dataclass(frozen=True, eq=False)
class EndRow:
    """A row of the relaxed problem: value, bounds, name, the unit and the measure of reports, weight of its slack."""

    value: ca.SX
    lower: float
    upper: float
    phase: str
    name: str
    unit: str
    time: ca.SX
    weight: float
    physical: bool = False
    measure: Measure | None = None
    end: Where | None = None
    """The end at which it must hold; None for rows of both ends."""

    def shown(self, value: float) -> float:
        """Return a value or a bound of the row as reports state it [unit]."""
        return value if self.measure is None else self.measure.of(value)

    @property
    def scale(self) -> float:
        """Unit of the slack: the larger finite bound, else 1; of a measured quantity at least 1 in its unit.

        A small angle of a cone is relaxed as easily as the angles of an orientation.
        """
        if self.measure is not None:
            return max(self.measure.value_of(1.0), 1.0)
        return max((abs(b) for b in (self.lower, self.upper) if np.isfinite(b) and b), default=1.0)


@dataclass(frozen=True, eq=False)
class PhaseEnds:
    """Symbols of the two ends of a phase, and the points built from them."""

    phase: Phase
    first: ca.SX
    last: ca.SX
    begun: ca.SX
    duration: ca.SX
    parameters: ca.SX
    start: Point
    end: Point

    @property
    def unknowns(self) -> list[ca.SX]:
        """Positions at both ends, time of the start, duration and parameters."""
        size = position_count(self.phase)
        known = self.begun if self.begun.is_symbolic() else ca.SX(0, 1)
        return [self.first[:size], self.last[:size], known, self.duration, self.parameters]


def position_count(phase: Phase) -> int:
    """Return how many states are positions; all states of a System."""
    return phase.body.position_count if isinstance(phase.body, RigidBody) else len(phase.body.states)


def ends_of_phases(phases: Sequence[Phase]) -> list[PhaseEnds]:
    """Return symbols and points of the ends of every phase."""
    found = []
    for i, phase in enumerate(phases):
        begun = ca.SX.sym(f"t{i}") if i else ca.SX(0)
        body, names = phase.body, phase.parameter_names
        first, last = (ca.SX.sym(f"{which}{i}", len(body.states)) for which in ("first", "last"))
        duration, p = ca.SX.sym(f"T{i}"), ca.SX.sym(f"p{i}", len(names))
        inner = [
            [ca.SX.sym(f"{variable.name} at the {which}") for variable in variables]
            for which in ("start", "end")
            for variables in (body.algebraic, body.controls)
        ]
        z0, u0, z1, u1 = (ca.vertcat(ca.SX(0, 1), *column) for column in inner)
        start = body.point(begun, first, z0, u0, p, names)
        end = body.point(begun + duration, last, z1, u1, p, names)
        found.append(PhaseEnds(phase, first, last, begun, duration, p, start, end))
    return found


def rows_at_ends(ends: PhaseEnds) -> Iterator[EndRow]:
    """Yield the rows of one phase: limits, given states, contacts, mean speeds."""
    phase, size = ends.phase, position_count(ends.phase)
    table = phase.rows
    # A kinematic plan has the same symbols among its algebraic variables and its controls.
    inner = ca.vertcat(
        ca.SX(0, 1), *ca.symvar(ca.vertcat(ca.SX(0, 1), *table.point.z.values(), *table.point.u.values()))
    )
    groups = (table.path, table.at(Where.START), table.at(Where.END))
    read = [row for group in groups for row in group if not ca.depends_on(table.expressions((row,))[0], inner)]
    sides = (
        (Where.START, ends.start, ends.first, ends.begun, phase.start_bounds),
        (Where.END, ends.end, ends.last, ends.begun + ends.duration, phase.end_bounds),
    )
    for where, point, x, t, given in sides:
        for row, i in table.bounds_of(phase.body.states[:size], Where.THROUGHOUT, where):
            limit = (x[i], row.lower, row.upper, phase.name, row.label, row.unit, t, LIMIT_WEIGHT, True)
            yield EndRow(*limit, end=where)
        for variable, value, low, high in zip(phase.body.states[:size], ca.vertsplit(x[:size]), *given, strict=False):
            label = f"{where.value} {variable.quantity}, {variable.label}"
            yield EndRow(value, low, high, phase.name, label, variable.unit, t, END_WEIGHT, True, end=where)
        here = [row for row in read if row.where in (Where.THROUGHOUT, where)]
        values = _values(ends, here, x, t)
        for row, value in zip(here, values, strict=True):
            weight = LIMIT_WEIGHT if row.where is Where.THROUGHOUT else CONSTRAINT_WEIGHT
            weight = QUATERNION_WEIGHT if row.selects_root else weight
            own = (value, row.lower, row.upper, phase.name, row.label, row.shown_unit, t, weight)
            yield EndRow(*own, measure=row.measure, end=where)
        held = phase.body.invariant(point) if phase.body.invariants else ca.SX(0, 1)
        for variable, value in zip(phase.body.invariants, ca.vertsplit(held), strict=True):
            label = f"{variable.quantity}, {variable.label}"
            weight = QUATERNION_WEIGHT if variable.quantity == "unit quaternion" else CONSTRAINT_WEIGHT
            yield EndRow(value, 0.0, 0.0, phase.name, label, variable.unit, t, weight)
    middle = ends.begun + 0.5 * ends.duration
    for name, value, low, high in zip(
        phase.parameter_names, ca.vertsplit(ends.parameters), *phase.parameter_bounds, strict=True
    ):
        yield EndRow(value, low, high, phase.name, f"parameter {name}", "", middle, LIMIT_WEIGHT, True)
    least, longest = phase.duration_bounds
    yield EndRow(
        ends.duration, max(least, SHORTEST), longest, phase.name, "duration", "s", ends.duration, LIMIT_WEIGHT, True
    )
    yield from _mean_speeds(ends)


def _values(ends: PhaseEnds, rows: Sequence[PhaseRow], x: ca.SX, t: ca.SX) -> list[ca.SX]:
    """Return the expressions of rows of the state at one end."""
    table = ends.phase.rows
    if not rows:
        return []
    column = ca.vertcat(*table.expressions(tuple(rows)))
    symbols = table.symbols
    extra = symbols[1].numel() - x.numel()
    state = ca.vertcat(x, ca.SX.sym("added", extra)) if extra else x
    return list(
        ca.vertsplit(ca.substitute([column], [symbols[0], symbols[1], symbols[4]], [t, state, ends.parameters])[0])
    )


def _mean_speeds(ends: PhaseEnds) -> Iterator[EndRow]:
    """Yield (q_1 - q_0) / T within the speed limits, for joints with one position."""
    phase, robot = ends.phase, ends.phase.state_robot
    if robot is None or not isinstance(phase.limits, Limits):
        return
    positions = list(robot.position_names)
    limits = zip(*phase.limits.sides("velocity"), strict=True)
    for joint, unit, (low, high) in zip(robot.velocity_names, robot.units, limits, strict=True):
        if joint in positions and np.isfinite([low, high]).any():
            i = positions.index(joint)
            mean = (ends.last[i] - ends.first[i]) / ends.duration
            half = ends.begun + 0.5 * ends.duration
            yield EndRow(mean, low, high, phase.name, f"velocity limit, {joint}", f"{unit}/s", half, LIMIT_WEIGHT, True)


def rows_of_links(problem: Problem, ends: Sequence[PhaseEnds]) -> Iterator[EndRow]:
    """Yield the rows of all links of a problem."""
    for link in problem.bound_links:
        own = {unknown.name: ca.SX.sym(unknown.name) for unknown in link.unknowns}
        values = link.values([Ends(ends[i].start, ends[i].end) for i in link.phases], own)
        at = ends[link.phases[0]]
        for row, value in zip(link.rows, values, strict=True):
            name = f"{row.label} of {link.name}"
            yield EndRow(
                value, row.lower, row.upper, at.phase.name, name, row.unit, at.begun + at.duration, CONSTRAINT_WEIGHT
            )


def reads_only(value: ca.SX, unknown: ca.SX) -> bool:
    """Whether a value depends on positions, durations and parameters alone, not on speeds or impulses."""
    return not ca.Function("row", [unknown], [value], {"allow_free": True}).has_free()
