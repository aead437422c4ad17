"""Checks before a solve: rows of a phase that contradict each other or the ends."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError, warn
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.row import Row
from robotraj.dynamics.system import MissingEquations, System
from robotraj.problem.augmentation import free_of
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint, Where, symbols_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.constraints.joint_limits import JointLimit, JointPosition
from robotraj.problem.constraints.motors.rates import RateLimit
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.problem.rows import RowTable
from robotraj.robot.limits import Limits
from robotraj.robot.loading.inertia import weightless_joints, weightless_together
from robotraj.robot.loading.other_units import doubt_of_unit, in_other_unit, other_unit_note, seems_other
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of

SLACK = 1e-6
"""Largest distance of a given end from a bound that counts as round-off, relative to the size of the row."""

SAMPLES = 3
"""Random points at which two expressions are compared."""

UPSIDE_DOWN = -0.7
"""Height of the unit z axis of a root below which it counts as upside down."""

Ends = Mapping[Where, Bounds]
"""Bounds of the state at the start and at the end of a phase."""


def check_limits(phase: str, limits: Limits, robot: Robot) -> None:
    """Refuse limits that no motion satisfies; a joint without a motor may have an effort limit of 0.

    Raises
    ------
    InputError
        A limit locks a joint, is inverted or is no number. The message names the joints.

    Warns
    -----
    UserWarning
        A limit is plausible in degrees or millimetres only.
    """
    warnings = limits.warnings(robot.actuated)
    if warnings:
        raise InputError(f"Phase {phase!r}: " + " ".join(warnings))
    if limits is not robot.limits and limits.joints == robot.limits.joints:
        doubt = other_unit_note(robot.limits, limits, robot.units)
        if doubt:
            warn(f"Phase {phase!r}: {doubt}")


def check_masses(phase: str, robot: Robot, body: Dynamics, ends: Ends) -> None:
    """Refuse joints that move no mass, alone or together, for which the mass matrix is singular.

    Kinematics need no mass. Joints together are checked at the ends that fix all positions, or else in the neutral
    configuration.

    Raises
    ------
    InputError
        Joints move no mass. The message names them.
    """
    if not free_of(body).residuals:
        return
    joints = weightless_joints(robot.model)
    if joints:
        raise InputError(
            f"Phase {phase!r}: no mass moves with {', '.join(map(repr, joints))}, so the mass matrix is singular. "
            "Give the moved links an <inertial>, or lock the joints with "
            f"rt.load(..., locked={{{joints[0]!r}: 0.0}})."
        )
    fixed = [b.lower[: robot.nq] for b in ends.values() if np.array_equal(b.lower[: robot.nq], b.upper[: robot.nq])]
    for q in fixed or [robot.neutral]:
        moving = weightless_together(robot.model, q, len(root_of(robot.root).velocities))
        together = [robot.velocity_names[i] for i in moving]
        if together:
            where = "at a given end" if fixed else "in the neutral configuration"
            raise InputError(
                f"Phase {phase!r}: {' and '.join(map(repr, together))} can turn without moving any mass {where}, so "
                "the mass matrix is singular. Correct the <inertia> of the moved links, or lock the last joint with "
                f"rt.load(..., locked={{{together[-1]!r}: 0.0}})."
            )


def check_equations(table: RowTable, system: System) -> None:
    """Evaluate the equations of a System once, to find errors early; ``MissingEquations`` are skipped."""
    if not isinstance(system.dynamics, MissingEquations):
        point = symbols_of(table.dae, table.parameters)
        _ = table.dae.rates(point), table.dae.residual(point)


def check_rows(table: RowTable, ends: Ends, constraints: Iterable[Constraint]) -> None:
    """Refuse rows that cannot hold together, and ends at which a row cannot hold.

    Warns
    -----
    UserWarning
        A bound of one of the given constraints seems to be in degrees or millimetres.

    Raises
    ------
    InputError
        Bounds are crossed or contradict each other, or a row is violated at an end. The message names the first such
        row, its bounds and the end. A number that is not zero is refused for positions and at an end, where it could be
        meant as a value or as a limit.
    """
    constraints = tuple(constraints)
    _check_numbers(table.phase, constraints)
    _check_order(table)
    held = {end: table.bounds_by_variable(Where.THROUGHOUT, end) for end in ends}
    for rows in (rows for at in held.values() for rows in at.values()):
        _check_against_each_other(table.phase, rows)
    _check_repeated(table)
    _warn_of_units(table, constraints)
    for end, bounds in ends.items():
        crossed = np.flatnonzero(bounds.lower > bounds.upper)
        if crossed.size:
            name = table.dae.states[crossed[0]].label
            raise InputError(
                f"Phase {table.phase!r}: the {end.value} of {name!r} has its lower bound above its upper one; exchange "
                "them."
            )
        _check_against_limits(table, end, bounds, held[end])
        _check_expressions(table, end, bounds)
        _warn_of_order(table, end, bounds)


def _check_numbers(phase: str, constraints: Iterable[Constraint]) -> None:
    """Refuse numbers that could be meant as a value or as [-x, x]: of positions, and at one end of a phase."""
    for each in constraints:
        at_end = isinstance(each, AtStart | AtEnd)
        limit = each.constraint if isinstance(each, AtStart | AtEnd) else each
        if not isinstance(limit, JointLimit | RateLimit) or not (at_end or isinstance(limit, JointPosition)):
            continue
        bounds = limit.bounds
        entries = list(bounds.values()) if isinstance(bounds, Mapping) else np.ravel(np.array(bounds, dtype=object))
        number = next((x for x in entries if isinstance(x, float | int | np.number) and x not in (0, np.inf)), None)
        if number is not None:
            value, name = f"{float(number):g}", type(limit).__name__
            raise InputError(
                f"Phase {phase!r}: {name}({bounds!r}) could mean the value {value} or the limits [-x, x]. Give "
                f"rt.between({value}, {value}) for the value, or rt.between(-{value.lstrip('-')}, "
                f"{value.lstrip('-')}) for limits."
            )


def _check_order(table: RowTable) -> None:
    for row in table:
        if row.lower > row.upper:
            raise InputError(
                f"Phase {table.phase!r}: {row.label} has its lower bound {row.lower:g} above its upper bound "
                f"{_with(f'{row.upper:g}', row.unit)}; exchange them."
            )


def _range(row: Row) -> str:
    """Write the bounds of a row, with its unit."""
    return _with(f"[{row.shown(row.lower):g}, {row.shown(row.upper):g}]", row.shown_unit)


def _with(value: str, unit: str) -> str:
    """Write a value with its unit, where it has one."""
    return f"{value} {unit}" if unit else value


def _check_against_each_other(phase: str, rows: Sequence[PhaseRow]) -> None:
    """Refuse bounds of one variable that leave it no value."""
    lowest = max(rows, key=lambda row: row.lower)
    highest = min(rows, key=lambda row: row.upper)
    if lowest.lower > highest.upper:
        raise InputError(
            f"Phase {phase!r}: {lowest.label} {_range(lowest)} and {highest.label} {_range(highest)} contradict each "
            "other; relax one of them."
        )


def _check_repeated(table: RowTable) -> None:
    """Refuse bounds of one expression that leave it no value, as of two places of a frame at one end.

    Rows of one name are compared. They have the same expression if it has the same values at seeded random points.
    """
    alike: dict[tuple[str, str], list[PhaseRow]] = {}
    for row in table:
        if row.kind in (Kind.PATH, Kind.END):
            alike.setdefault((row.label, row.unit), []).append(row)
    for rows in alike.values():
        for first, second in combinations(rows, 2):
            together = first.where is second.where or Where.THROUGHOUT in (first.where, second.where)
            if together and max(first.lower, second.lower) > min(first.upper, second.upper) + SLACK * first.size:
                values = ca.vertcat(*table.expressions((first, second)))
                symbols = ca.symvar(values)
                read = ca.Function("rows", symbols, [values])
                draw = np.random.default_rng(0).uniform
                drawn = np.array([read(*(draw(0.1, 1.0) for _ in symbols)).full().ravel() for _ in range(SAMPLES)])
                if np.allclose(drawn[:, 0], drawn[:, 1], rtol=1e-9, atol=1e-12):
                    _check_against_each_other(table.phase, (first, second))


def _warn_of_units(table: RowTable, constraints: Iterable[Constraint]) -> None:
    """Warn of bounds of a user that have no effect beside a joint's limits, and would have one in another unit.

    Warns
    -----
    UserWarning
    """
    given = {row.number: row for each in constraints for row in table.of(each) if row.kind is Kind.BOUND}
    limits = table.bounds_by_variable()
    for row in given.values():
        for other in limits.get(table.variable_of(row).name, ()):
            for value, limit in ((row.lower, other.lower), (row.upper, other.upper)):
                if other.number not in given and seems_other(value, limit, row.unit):
                    warn(
                        f"Phase {table.phase!r}: {row.label} {_range(row)} has no effect beside {_range(other)}. "
                        f"{in_other_unit(value, row.unit)}"
                    )
                    break


def _check_against_limits(table: RowTable, end: Where, bounds: Bounds, rows: Mapping[str, Sequence[PhaseRow]]) -> None:
    for variable, low, high in zip(table.dae.states, bounds.lower, bounds.upper, strict=True):
        for row in rows.get(variable.name, ()):
            slack = SLACK * row.size
            if low > row.upper + slack or high < row.lower - slack:
                value = f"{low:g}" if low == high else f"[{low:g}, {high:g}]"
                doubt = doubt_of_unit(low, row.lower, row.upper, row.unit) if low == high else ""
                raise InputError(
                    f"Phase {table.phase!r}: the {end.value} {variable.quantity} of {variable.label!r} is "
                    f"{_with(value, variable.unit)}, outside its {row.name} {_range(row)}. "
                    f"Move the {end.value}, or give other limits.{doubt}"
                )


def _warn_of_order(table: RowTable, end: Where, bounds: Bounds) -> None:
    """Warn of a free root that is upside down, and upright with its quaternion in the order (w, x, y, z).

    Warns
    -----
    UserWarning
    """
    names = [variable.name for variable in table.body.states]
    if "q.root_qx" not in names:
        return
    first = names.index("q.root_qx")
    given = bounds.lower[first : first + 4]
    if not np.array_equal(given, bounds.upper[first : first + 4]) or not np.isfinite(given).all():
        return
    # The height of the root's z axis is 1 - 2 (x^2 + y^2), whichever entries are x and y.
    as_given, swapped = (1.0 - 2.0 * float(np.sum(pair**2)) for pair in (given[:2], given[1:3]))
    if as_given < UPSIDE_DOWN and swapped > -UPSIDE_DOWN:
        values = ", ".join(f"{value:g}" for value in given)
        warn(
            f"Phase {table.phase!r}: at the {end.value}, the root with the quaternion (x, y, z, w) = ({values}) is "
            "upside down. In the order (w, x, y, z) it would be upright; put w last."
        )


def _check_expressions(table: RowTable, end: Where, bounds: Bounds) -> None:
    """Evaluate the rows that depend on the state alone at an end whose whole state is fixed."""
    lower, upper = (side[: len(table.body.states)] for side in bounds)
    rows = [row for row in table if row.kind in (Kind.PATH, Kind.END) and row.where in (Where.THROUGHOUT, end)]
    if not rows or not np.array_equal(lower, upper):
        return
    x = table.symbols[1][: len(lower)]
    for row, value in zip(rows, table.expressions(rows), strict=True):
        if any(not ca.depends_on(x, s) for s in ca.symvar(value)):
            continue
        number = float(ca.Function("row", [x], [value])(lower))
        if np.isnan(number):
            raise InputError(f"Phase {table.phase!r}: {row.label} is NaN at the {end.value}; check its expression.")
        slack = SLACK * row.size
        if not row.lower - slack <= number <= row.upper + slack:
            value = _with(f"{row.shown(number):.6g}", row.shown_unit)
            raise InputError(
                f"Phase {table.phase!r}: at the {end.value}, {row.label} is {value}, outside {_range(row)}. "
                f"Move the {end.value}, or relax the constraint.{_at_one_end(row.where, end)}"
            )


def _at_one_end(where: Where, violated: Where) -> str:
    """Name the class that imposes a constraint at the other end alone, where it is violated at this one."""
    if where is not Where.THROUGHOUT:
        return ""
    other, name = (Where.END, "AtEnd") if violated is Where.START else (Where.START, "AtStart")
    return f" It holds throughout; rt.{name}(...) imposes it at the {other.value} alone."
