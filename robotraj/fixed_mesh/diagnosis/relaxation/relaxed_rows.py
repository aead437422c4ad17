"""Rows with slacks: l <= c <= u becomes l - w s <= c <= u + w s.

A row with the same bound on both sides of zero, and an equality, have one slack. The two sides of other rows have one
each, since a thrust that must be larger need not become negative. A row that bounds the square of a quantity, such as
that of a tool's speed, is relaxed in the quantity: c <= u (1 + s)^2.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.dynamics.row import Row
from robotraj.fixed_mesh.diagnosis.end_rows import CONSTRAINT_WEIGHT, QUATERNION_WEIGHT
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Where
from robotraj.problem.constraints.motors.own_limits import own_limits
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.problem.rows import RowTable
from robotraj.solution.conflict import Conflict, with_room
from robotraj.solution.phase_solution import PhaseSolution


@dataclass(frozen=True)
class RelaxedRow:
    """A row, or one of its sides, with a slack.

    Attributes
    ----------
    table : RowTable
    row : PhaseRow
    name : str
        Parameter of the phase that is the slack.
    lower, upper : float
        Bounds that the slack relaxes, infinite where it does not.
    duration : float
        Duration over which the slack of an integral is spread [s]; 1 for other rows.
    """

    table: RowTable
    row: PhaseRow
    name: str
    lower: float
    upper: float
    duration: float = 1.0

    @property
    def scale(self) -> float:
        """Unit of the slack: the largest finite bound of the row, else 1, in the row's unit."""
        return self.row.greatest_bound or 1.0

    @property
    def weight(self) -> float:
        """Weight of the slack in the sum: limits give before the goals of the motion, and sizes before signs."""
        if self.row.selects_root:
            return QUATERNION_WEIGHT
        if self.row.where in (Where.START, Where.END):
            return CONSTRAINT_WEIGHT
        return CONSTRAINT_WEIGHT if self.row.greatest_bound > 0.0 and 0.0 in (self.lower, self.upper) else 1.0

    def relaxation(self, slack: ca.SX | float) -> ca.SX | float:
        """Return what a slack adds to the bounds, in the row's unit."""
        relative = slack if self.row.measure is None else (1.0 + slack) ** 2 - 1.0
        return self.scale / self.duration * relative

    def conflict(self, part: PhaseSolution, slack: float) -> Conflict:
        """Return the time at which the row is furthest beyond its bounds, and a bound that suffices."""
        row, where = self.row, self.row.where
        p = np.array([part.parameters[name] for name in self.table.parameters])
        times = {Where.START: part.points[:1], Where.END: part.points[-1:]}.get(
            where, np.unique(np.append(part.points, part.knots))
        )
        x, z, u = (curve(times) for curve in (part.trajectory.x, part.trajectory.z, part.trajectory.u))
        values = self.table.sample((row,), times, x, z, u, p)[:, 0]
        amount = float(self.relaxation(slack))
        if where is Where.INTEGRAL:
            amount *= part.duration
            times, values = times[-1:], np.array([np.trapezoid(values, times)])
        low, high = self.lower - values, values - self.upper
        worst = int(np.argmax(np.maximum(low, high)))
        upper = bool(high[worst] >= low[worst])
        bound = self.upper if upper else self.lower
        needed = row.shown(bound + amount if upper else bound - amount)
        joint = part.phase.robot is not None and row.joint in part.phase.robot.velocity_names
        return Conflict(
            part.phase.name,
            row.label,
            float(times[worst]),
            row.shown(bound),
            with_room(row.shown(bound), needed),
            row.shown_unit,
            slack,
            row.kind is Kind.BOUND or joint,
        )


def relaxed_rows(table: RowTable, rows: Sequence[PhaseRow], prefix: str, longest: float) -> Iterator[RelaxedRow]:
    """Yield rows with slacks, whose names begin with ``prefix``; ``longest`` is the phase's duration [s]."""
    for row in rows:
        duration = longest if row.where is Where.INTEGRAL else 1.0
        both = np.isfinite(row.lower) and np.isfinite(row.upper)
        if both and abs(row.lower) != abs(row.upper):
            yield RelaxedRow(table, row, f"{prefix}.{row.number}.lower", row.lower, np.inf, duration)
            yield RelaxedRow(table, row, f"{prefix}.{row.number}.upper", -np.inf, row.upper, duration)
        else:
            yield RelaxedRow(table, row, f"{prefix}.{row.number}", row.lower, row.upper, duration)


@dataclass(frozen=True)
class RelaxedConstraint(Constraint):
    """A constraint relaxed by slacks, which are parameters of the phase; rows without a slack stay exact.

    Attributes
    ----------
    bound : BoundConstraint
        The constraint itself.
    table : RowTable
        The table with its rows.
    rows : tuple of PhaseRow
    slacks : tuple of RelaxedRow
    """

    bound: BoundConstraint
    table: RowTable
    rows: tuple[PhaseRow, ...]
    slacks: tuple[RelaxedRow, ...]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Return one row for every finite side that has a slack, and the exact rows."""
        index = {row.number: i for i, row in enumerate(self.rows)}
        of_slacks = {entry.row.number for entry in self.slacks}
        exact = [i for i, row in enumerate(self.rows) if row.number not in of_slacks]
        sides = [
            (index[entry.row.number], entry, sign, Row(entry.row.name, entry.row.unit, lower, upper, entry.row.joint))
            for entry in self.slacks
            for sign, lower, upper in ((1.0, entry.lower, np.inf), (-1.0, -np.inf, entry.upper))
            if np.isfinite(lower) or np.isfinite(upper)
        ]

        def expression(point: Point) -> list[ca.SX]:
            values = self.table.values(self.rows, point)
            relaxed = [values[i] + sign * entry.relaxation(point.p[entry.name]) for i, entry, sign, _ in sides]
            return [*relaxed, *(values[i] for i in exact)]

        rows = (*(row for *_, row in sides), *(self.bound.rows[self.rows[i].entry] for i in exact))
        return replace(self.bound, rows=rows, expression=expression, source=None)

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables that the rows of the constraint read."""
        return dynamics if self.bound.source is None else self.bound.source.augment(dynamics)


def bounds_of_robot(phase: Phase) -> Mapping[str, tuple[float, float]]:
    """Return the bounds of the robot's own limits by the label of their row; empty for Systems."""
    robot = phase.robot
    if robot is None:
        return {}
    bound = [limit.bind(phase.body) for limit in own_limits(robot.limits, robot.actuated)]
    return {row.label: (row.lower, row.upper) for each in bound for row in each.rows}
