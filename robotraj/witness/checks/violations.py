"""Bounds of a phase that its planned polynomials break, between the collocation points as well as at them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.problem.constraints.base import Row, Where
from robotraj.solution.violation import Violation, violated
from robotraj.witness.checks.residual import TORQUE_UNITS
from robotraj.witness.numbers import as_numbers
from robotraj.witness.plants.plant import RATE_UNITS
from robotraj.witness.plants.system_plant import columns
from robotraj.witness.point import NumericPoint, system_point
from robotraj.witness.protocols import Array, PhaseSolutionLike
from robotraj.witness.sampling import interval_samples

SOLVER_NOISE = 1e-6
"""Amounts below this, relative to max(1, |limit|), are a solver's tolerance and are not listed."""

FEW_SAMPLES = 9
"""Points of every interval at which constraints are evaluated; where they come nearest to their bounds, more are."""

ACCELERATION_UNITS = {"rad": "rad/s^2", "m": "m/s^2"}


@dataclass
class Watch:
    """A row and the values it was seen to take."""

    row: Row
    times: list[Array] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)

    def see(self, times: Array, values: Array) -> None:
        """Add values (m,) at times (m,)."""
        self.times.append(times)
        self.values.append(values)

    @property
    def nearest(self) -> float:
        """Time [s] at which the row comes nearest to one of its bounds, or breaks it most."""
        values, times = np.concatenate(self.values), np.concatenate(self.times)
        excess = np.maximum(values - float(self.row.upper), float(self.row.lower) - values)
        return float(times[np.argmax(np.nan_to_num(excess, nan=np.inf))])

    def worst(self, phase: str) -> Violation | None:
        """Return the largest violation, None if the row holds."""
        values, times = np.concatenate(self.values), np.concatenate(self.times)
        row, lower, upper = self.row, float(self.row.lower), float(self.row.upper)
        excess = np.nan_to_num(np.maximum(values - upper, lower - values), nan=np.inf)
        i = int(np.argmax(excess))
        amount, limit, side = violated(float(values[i]), lower, upper)
        if amount <= SOLVER_NOISE * max(1.0, abs(limit)):
            return None
        time, size = float(times[i]), size_of(row, limit)
        return Violation(phase, row.name, row.joint, time, amount, row.unit, limit, side, size)


def size_of(row: Row, limit: float) -> float:
    """Size of a row [unit], which a tolerance of 1e-3 allows to break by a thousandth."""
    width = float(row.upper) - float(row.lower)
    return 0.5 * width if 0.0 < width < np.inf else max(1.0, abs(limit))


def violations_of(
    planned: PhaseSolutionLike, samples: int, clock: Callable[[], None] = lambda: None
) -> tuple[Violation, ...]:
    """Every broken bound of a phase, the worst first: joint limits, constraints, and the states at both ends.

    Each is reported once, where it is broken most among ``samples`` points of every interval.

    Raises
    ------
    InputError
        A constraint's expression does not give numbers on a numeric point.
    """
    phase = planned.phase
    limits = [] if phase.limits is None or phase.robot is None else list(_limit_rows(phase))
    watched = [Watch(row) for row, _ in limits]
    checked = {_key(row) for row, _ in limits}
    # A phase may also state its limits as constraints; those rows are seen once.
    # What contacts ask of their forces is measured against the weight, in ``holding_of``.
    contacts = {f"contact {contact.name}" for contact in phase.bound_contacts}
    bound = [
        c for c in phase.bound_constraints if c.name not in contacts and not all(_key(row) in checked for row in c.rows)
    ]
    throughout = [(c, [Watch(row) for row in c.rows]) for c in bound if c.where is Where.THROUGHOUT]
    if limits:
        for part in interval_samples(planned, samples):
            sample = planned.at(part.times, interval=part.interval)
            for watch, (_, read) in zip(watched, limits, strict=True):
                watch.see(part.times, read(sample))
    if throughout:
        _see_throughout(planned, throughout, samples, clock)
    ends = [(0, Where.START, phase.start_bounds), (-1, Where.END, phase.end_bounds)]
    at_ends = [entry for end in ends for entry in _at_end(planned, bound, *end)]
    at_ends += _integrals(planned, [c for c in bound if c.where is Where.INTEGRAL], samples)
    every = watched + [watch for _, watches in throughout for watch in watches] + at_ends
    found = [watch.worst(phase.name) for watch in every if watch.values]
    return tuple(sorted((v for v in found if v is not None), key=lambda v: -v.relative))


def _see_throughout(
    planned: PhaseSolutionLike,
    entries: Sequence[tuple[Any, list[Watch]]],
    samples: int,
    clock: Callable[[], None],
) -> None:
    """Look at a few points of every interval, and at many of those in which a row comes nearest to its bounds."""

    def see(count: int, only: Collection[int] | None = None) -> None:
        for part in interval_samples(planned, count, only=only):
            clock()
            _see(entries, part.times, _points(planned, part.times, part.interval))

    see(min(FEW_SAMPLES, samples))
    if samples > FEW_SAMPLES:
        knots = np.asarray(planned.knots, dtype=float)
        nearest = np.array([watch.nearest for _, watches in entries for watch in watches])
        after = np.searchsorted(knots, nearest, side="right") - 1
        before = np.searchsorted(knots, nearest, side="left") - 1
        see(samples, {int(k) for k in (*after, *before)})


def _key(row: Row) -> tuple[str, str | None, float, float]:
    return row.name, row.joint, float(row.lower), float(row.upper)


def _limit_rows(phase: Any) -> Iterable[tuple[Row, Callable[[Any], Array]]]:
    """Rows of the joint limits that bound something, and how each reads a sample of many times."""
    limits, robot = phase.limits, phase.robot
    joints = list(robot.velocity_names)
    shift = int(robot.model.nq) - len(joints)  # a floating root has one position more than velocities, and no limits
    symmetric = (
        ("velocity limit", "v", limits.velocity, RATE_UNITS, joints),
        ("acceleration limit", "a", limits.acceleration, ACCELERATION_UNITS, joints),
        ("effort limit", "tau", limits.effort, TORQUE_UNITS, list(robot.actuated)),
    )
    for i, joint in enumerate(joints):
        lower, upper = float(limits.position_lower[i]), float(limits.position_upper[i])
        if np.isfinite(lower) or np.isfinite(upper):
            yield Row("position limit", robot.units[i], lower, upper, joint), _column("q", i + shift)
    for name, kind, bounds, units, moved in symmetric:
        for column, joint in enumerate(moved):
            i = joints.index(joint)
            if np.isfinite(bounds[i]):
                bound = float(bounds[i])
                yield Row(name, units[robot.units[i]], -bound, bound, joint), _column(kind, column)


def _column(kind: str, index: int) -> Callable[[Any], Array]:
    return lambda sample: np.asarray(getattr(sample, kind)[:, index])


def _points(planned: PhaseSolutionLike, times: Array, interval: int | NDArray[np.int_]) -> list[Any]:
    """Wrap the plan at times of one interval each as user expressions read it."""
    sample, phase = planned.at(times, interval=interval), planned.phase
    if phase.robot is not None:
        robot = realised(planned)
        held = [force.name for contact in phase.bound_contacts for force in contact.forces]
        return [
            NumericPoint(
                robot,
                t,
                *(getattr(sample, name)[i] for name in ("q", "v", "a", "tau")),
                parameters=planned.parameters,
                forces={name: force[i] for name, force in sample.forces.items()},
                algebraic={name: sample.z[name][i] for name in held},
                columns=True,
            )
            for i, t in enumerate(times)
        ]
    system = phase.system
    x, z, u = (
        columns(named, tuple(v.name for v in kind), len(times))
        for named, kind in (
            (sample.x, system.states),
            (sample.z, system.algebraic),
            (sample.u, system.controls),
        )
    )
    return [system_point(system, t, x[i], z[i], u[i], planned.parameters) for i, t in enumerate(times)]


def _see(entries: Sequence[tuple[Any, list[Watch]]], times: Array, points: Sequence[Any]) -> None:
    """Evaluate constraints on points and show their rows the values."""
    for constraint, watches in entries:
        what = f"expression of {constraint.name!r}"
        values = np.array([as_numbers(constraint.expression(point), what) for point in points])
        if values.shape[1] != len(watches):
            raise InputError(f"The {what} gave {values.shape[1]} numbers for its {len(watches)} rows.")
        for column, watch in enumerate(watches):
            watch.see(times, values[:, column])


def _at_end(planned: PhaseSolutionLike, bound: Sequence[Any], side: int, where: Where, state: Any) -> list[Watch]:
    """Watch the state and the constraints of one end of a phase."""
    phase, knots = planned.phase, np.asarray(planned.knots, dtype=float)
    times, interval = knots[[side]], (0 if side == 0 else len(knots) - 2)
    (point,) = _points(planned, times, interval)
    entries = [(c, [Watch(row) for row in c.rows]) for c in bound if c.where is where]
    _see(entries, times, [point])
    watches = [watch for _, ends in entries for watch in ends]
    if state is not None:
        units = [v.unit for v in phase.system.states] if phase.robot is None else _state_units(phase.robot)
        # States that the objective added come last in the bounds, and are none of the motion's.
        count = len(units)
        for name, unit, lower, upper in zip(point.x, units, state.lower[:count], state.upper[:count], strict=True):
            watch = Watch(Row(f"{where.value} state", unit, float(lower), float(upper), name))
            watch.see(times, np.array([float(point.x[name])]))
            watches.append(watch)
    return watches


def _integrals(planned: PhaseSolutionLike, constraints: Sequence[Any], samples: int) -> list[Watch]:
    """Watch what integral constraints add up to, by Gauss-Legendre quadrature on every interval."""
    if not constraints:
        return []
    sites, weights = np.polynomial.legendre.leggauss(samples)
    knots = np.asarray(planned.knots, dtype=float)
    totals = [np.zeros(len(c.rows)) for c in constraints]
    for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        half = 0.5 * (end - begin)
        points = _points(planned, begin + half * (sites + 1.0), k)
        for constraint, total in zip(constraints, totals, strict=True):
            what = f"expression of {constraint.name!r}"
            rates = np.array([as_numbers(constraint.expression(point), what) for point in points])
            total += half * weights @ rates
    watches = []
    for constraint, total in zip(constraints, totals, strict=True):
        for row, value in zip(constraint.rows, total, strict=True):
            watch = Watch(row)
            watch.see(knots[-1:], np.array([value]))
            watches.append(watch)
    return watches


def _state_units(robot: Any) -> list[str]:
    return [*robot.position_units, *(RATE_UNITS[unit] for unit in robot.units)]
