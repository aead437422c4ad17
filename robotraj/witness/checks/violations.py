"""Bounds of a phase that its planned polynomials violate, at and between the collocation points."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Where
from robotraj.problem.objectives.base import Integral
from robotraj.solution.violation import Violation
from robotraj.witness.checks.points import Watched, all_watches, end_of, points_of, see, values_of
from robotraj.witness.checks.residual import TORQUE_UNITS
from robotraj.witness.checks.row_sizes import RowSizes
from robotraj.witness.checks.watch import Watch
from robotraj.witness.contacts.soles import sole_watches
from robotraj.witness.planned import RobotSample, limits_of, robot_sample, system_of
from robotraj.witness.plants.plant import RATE_UNITS
from robotraj.witness.protocols import PhaseSolutionLike, RobotLike
from robotraj.witness.sampling import interval_samples

FEW_SAMPLES = 9
"""Points of every interval at which constraints are evaluated first; near their bounds, more points follow."""
STILL = 1e-3
"""Speed below which a joint rests, relative to that of its friction."""
CLOSER = 25
"""Points between two neighbours of the nearest one, where a row bends across its bound."""

ACCELERATION_UNITS = {"rad": "rad/s^2", "m": "m/s^2"}


def violations_of(
    planned: PhaseSolutionLike,
    samples: int,
    sizes: Mapping[str, float],
    clock: Callable[[], None] = lambda: None,
    phases: Sequence[PhaseSolutionLike] = (),
) -> tuple[Violation, ...]:
    """Return every violated bound of a phase, the worst first: limits, constraints, states at both ends, parameters.

    Each is reported once, at the time of its largest violation among ``samples`` points of every interval. Limits are
    judged relative to their range or to the largest value, rows of constraints to what the motion changes them by, and
    states at the ends to the ``sizes`` of the states in the motion, of all ``phases``.

    Raises
    ------
    InputError
        A constraint's expression does not return numbers on a numeric point.
    """
    phase = planned.phase
    limits = list(_limit_rows(planned))
    watched = [Watch(row) for row, _ in limits]
    checked = {_key(row) for row, _ in limits}
    # A phase may also have its limits as constraints; those rows are checked once.
    # Limits of contact forces are compared with the weight in ``holding_of``.
    contacts = {f"contact {contact.name}" for contact in phase.bound_contacts}
    bound = [
        c for c in phase.bound_constraints if c.name not in contacts and not all(_key(row) in checked for row in c.rows)
    ]
    throughout = [(c, [Watch(row) for row in c.rows]) for c in bound if c.where in (Where.THROUGHOUT, Where.RATE)]
    if limits:
        for part in interval_samples(planned, samples):
            sample = robot_sample(planned, part.times, part.interval)
            for watch, (_, read) in zip(watched, limits, strict=True):
                watch.see(part.times, read(sample))
    if throughout:
        _see_throughout(planned, throughout, samples, clock)
    of_rows = RowSizes(planned, phases or [planned])
    for constraint, watches in throughout:
        of_rows.measure(constraint, watches)
    for watch in watched:
        watch.size = watch.row.size_in(watch.peak)
    at_ends = [*_scalars(planned)]
    for side, where in ((0, Where.START), (-1, Where.END)):
        at_ends += _at_end(planned, bound, sizes, of_rows, side, where)
    at_ends += sole_watches(planned, [c for c in bound if c.where is Where.THROUGHOUT], FEW_SAMPLES, clock)
    at_ends += _integrals(planned, [c for c in bound if c.where is Where.INTEGRAL], of_rows, samples)
    every = watched + all_watches(throughout) + at_ends
    found = [watch.worst(phase.name) for watch in every if watch.values]
    return tuple(sorted((v for v in found if v is not None), key=lambda v: -v.relative))


def _see_throughout(
    planned: PhaseSolutionLike,
    entries: Sequence[Watched],
    samples: int,
    clock: Callable[[], None],
) -> None:
    """Evaluate constraints at few points of every interval, and at many where a row comes nearest to its bounds."""

    def look(count: int, only: Collection[int] | None = None) -> None:
        for part in interval_samples(planned, count, only=only):
            clock()
            see(entries, part.times, points_of(planned, part.times, part.interval))

    look(min(FEW_SAMPLES, samples))
    if samples > FEW_SAMPLES:
        knots = np.asarray(planned.knots, dtype=float)
        nearest = np.array([watch.nearest for watch in all_watches(entries)])
        after = np.searchsorted(knots, nearest, side="right") - 1
        before = np.searchsorted(knots, nearest, side="left") - 1
        look(samples, {int(k) for k in (*after, *before)})
    _see_hidden_peaks(planned, entries, clock)


def _see_hidden_peaks(planned: PhaseSolutionLike, entries: Sequence[Watched], clock: Callable[[], None]) -> None:
    """Evaluate constraints at closer points where a row may violate its bounds between the points seen."""
    knots = np.asarray(planned.knots, dtype=float)
    for begin, end in {peak for watch in all_watches(entries) if (peak := watch.hidden_peak) is not None}:
        clock()
        k = int(np.searchsorted(knots, 0.5 * (begin + end), side="right")) - 1
        times = np.linspace(max(begin, knots[k]), min(end, knots[k + 1]), CLOSER)
        see(entries, times, points_of(planned, times, k))


def _key(row: Row) -> tuple[str, str | None, float, float]:
    return row.name, row.joint, float(row.lower), float(row.upper)


def _limit_rows(planned: PhaseSolutionLike) -> Iterable[tuple[Row, Callable[[RobotSample], Array]]]:
    """Yield the rows of finite joint limits, each with the function that reads its values from a sample."""
    limits, robot = limits_of(planned), planned.phase.robot
    if limits is None or robot is None:
        return
    joints = list(robot.velocity_names)
    shift = int(robot.model.nq) - len(joints)  # A floating root has one position more than velocities, and no limits.
    rates = (
        ("velocity limit", "v", limits.sides("velocity"), RATE_UNITS, joints),
        ("acceleration limit", "a", limits.sides("acceleration"), ACCELERATION_UNITS, joints),
        ("effort limit", "tau", limits.sides("effort"), TORQUE_UNITS, list(robot.actuated)),
    )
    for i, joint in enumerate(joints):
        lower, upper = float(limits.position_lower[i]), float(limits.position_upper[i])
        if np.isfinite(lower) or np.isfinite(upper):
            yield Row("position limit", robot.units[i], lower, upper, joint), _column("q", i + shift)
    for name, kind, bounds, units, moved in rates:
        for column, joint in enumerate(moved):
            i = joints.index(joint)
            lower, upper = (float(side[i]) for side in bounds)
            if np.isfinite(lower) or np.isfinite(upper):
                row = Row(name, units[robot.units[i]], lower, upper, joint)
                yield row, _column(kind, column)
                if kind == "tau" and robot.friction[i] > 0.0 and _starts_against_friction(planned):
                    yield replace(row, name=f"{name} against dry friction"), _against_friction(robot, column, i)


def _starts_against_friction(planned: PhaseSolutionLike) -> bool:
    """Whether the torques of an arm's motion must overcome all of its dry friction.

    Where an integral is minimised, slow joints stand for resting ones, whose friction may be anything.
    """
    phase, robot = planned.phase, planned.phase.robot
    if (
        robot is None
        or robot.root != "fixed"
        or phase.bound_contacts
        or len(robot.actuated) < len(robot.velocity_names)
    ):
        return False
    return phase.objective is None or not any(isinstance(term, Integral) for _, term in phase.objective.terms)


def _against_friction(robot: RobotLike, column: int, joint: int) -> Callable[[RobotSample], Array]:
    """Read a torque as by Coulomb's law: joints that move have their whole dry friction, which plans smooth by tanh.

    A joint at less than ``STILL`` of the speed of that tanh rests.
    """

    def read(sample: RobotSample) -> Array:
        speed = sample.v[:, joint] / robot.friction_speed
        lacking = np.where(np.abs(speed) > STILL, np.sign(speed) - np.tanh(speed), 0.0)
        return np.asarray(sample.tau[:, column] + robot.friction[joint] * lacking)

    return read


def _column(kind: str, index: int) -> Callable[[RobotSample], Array]:
    return lambda sample: np.asarray(getattr(sample, kind)[:, index])


def _at_end(
    planned: PhaseSolutionLike,
    bound: Sequence[BoundConstraint],
    sizes: Mapping[str, float],
    of_rows: RowSizes,
    side: int,
    where: Where,
) -> list[Watch]:
    """Watch the state and the constraints of one end of a phase."""
    phase = planned.phase
    times, point = end_of(planned, side)
    entries = [(c, [Watch(row) for row in c.rows]) for c in bound if c.where is where]
    see(entries, times, [point])
    for constraint, own in entries:
        of_rows.measure(constraint, own)
    watches = all_watches(entries)
    state = phase.joint_ends[where]
    if state is not None:
        units = [v.unit for v in system_of(planned).states] if phase.robot is None else _state_units(phase.robot)
        # States that the objective adds are the last of the bounds; they are not part of the motion.
        count = len(units)
        for name, unit, lower, upper in zip(point.x, units, state.lower[:count], state.upper[:count], strict=True):
            watch = Watch(Row(f"{where.value} state", unit, float(lower), float(upper), name), sizes[name])
            watch.see(times, np.array([float(point.x[name])]))
            watches.append(watch)
    return watches


def _scalars(planned: PhaseSolutionLike) -> list[Watch]:
    """Watch the duration and the parameters of a phase."""
    phase, knots = planned.phase, np.asarray(planned.knots, dtype=float)
    rows = [Row("duration", "s", *phase.duration_bounds)]
    values = [float(knots[-1] - knots[0])]
    # A duration is judged by itself, not by a second or by the range that it may have.
    sizes: list[float | None] = [values[0] if values[0] > 0.0 else None]
    bounds = phase.parameter_bounds
    for name, lower, upper in zip(phase.parameter_names, bounds.lower, bounds.upper, strict=True):
        rows.append(Row("parameter", "", float(lower), float(upper), name))
        values.append(float(planned.parameters[name]))
        sizes.append(None)
    watches = [Watch(row, size) for row, size in zip(rows, sizes, strict=True)]
    for watch, value in zip(watches, values, strict=True):
        watch.see(knots[-1:], np.array([value]))
    return watches


def _integrals(
    planned: PhaseSolutionLike, constraints: Sequence[BoundConstraint], of_rows: RowSizes, samples: int
) -> list[Watch]:
    """Watch the values of integral constraints, by Gauss-Legendre quadrature on every interval."""
    if not constraints:
        return []
    sites, weights = np.polynomial.legendre.leggauss(samples)
    knots = np.asarray(planned.knots, dtype=float)
    totals = [np.zeros(len(c.rows)) for c in constraints]
    for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        half = 0.5 * (end - begin)
        points = points_of(planned, begin + half * (sites + 1.0), k)
        for constraint, total in zip(constraints, totals, strict=True):
            total += half * weights @ values_of(constraint, points)
    watches = []
    for constraint, total in zip(constraints, totals, strict=True):
        own = [Watch(row) for row in constraint.rows]
        for watch, value in zip(own, total, strict=True):
            watch.see(knots[-1:], np.array([value]))
        of_rows.measure(constraint, own)
        watches += own
    return watches


def _state_units(robot: RobotLike) -> list[str]:
    return [*robot.position_units, *(RATE_UNITS[unit] for unit in robot.units)]
