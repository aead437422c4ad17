"""Numeric points along a plan, at which constraints and links are evaluated."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.point import Point
from robotraj.problem.augmentation import free_of
from robotraj.problem.constraints.base import BoundConstraint
from robotraj.problem.constraints.motors.rates import RateLimit
from robotraj.robot.robot import Robot
from robotraj.witness.checks.watch import Watch
from robotraj.witness.numbers import as_numbers
from robotraj.witness.planned import RobotSample, robot_sample, system_of
from robotraj.witness.plants.system_plant import columns
from robotraj.witness.point import NumericPoint, system_point
from robotraj.witness.protocols import PhaseSolutionLike

STEP = 1e-3
"""Step of central differences for rates, relative to the length of the interval."""

Watched = tuple[BoundConstraint, list[Watch]]
"""A constraint and the watches of its rows."""


def points_of(planned: PhaseSolutionLike, times: Array, interval: int | NDArray[np.int_]) -> Sequence[Point]:
    """Return the points of a phase at times (m,), each of one interval."""
    phase = planned.phase
    if phase.robot is not None:
        robot, motion = realised(planned), robot_sample(planned, times, interval)
        held = [force.name for contact in phase.bound_contacts for force in contact.forces]
        points = [
            NumericPoint(
                robot,
                t,
                motion.q[i],
                motion.v[i],
                motion.a[i],
                motion.tau[i],
                parameters=planned.parameters,
                forces={name: force[i] for name, force in motion.forces.items()},
                algebraic={name: np.asarray(motion.z[name])[i] for name in held},
                columns=True,
            )
            for i, t in enumerate(times)
        ]
        for name, values in added_variables(planned, times, interval).items():
            for point, value in zip(points, values, strict=True):
                point.extra[name] = value
        return points
    system, sample = system_of(planned), planned.at(times, interval=interval)
    x, z, u = (
        columns(named, tuple(v.name for v in kind), len(times))
        for named, kind in (
            (sample.x, system.states),
            (sample.z, system.algebraic),
            (sample.u, system.controls),
        )
    )
    return [system_point(system, t, x[i], z[i], u[i], planned.parameters) for i, t in enumerate(times)]


def added_variables(
    planned: PhaseSolutionLike, times: Array, interval: int | NDArray[np.int_]
) -> dict[str, NDArray[np.float64]]:
    """Return the variables (m,) that the objective or a constraint added to the dynamics of a robot, by name.

    Rates of accelerations, and of torques without dry friction, that have bounds are central differences of the planned
    values.
    """
    phase = planned.phase
    bounded = [
        f"{bound.source.prefix}.{row.joint}"
        for bound in phase.bound_constraints
        if isinstance(bound.source, RateLimit)
        for row in bound.rows
    ]
    free = free_of(phase.body)
    if phase.robot is None or (phase.dae is free and not bounded):
        return {}
    sample = planned.at(times, interval=interval)
    own = {v.name for kind in (free.states, free.algebraic, free.controls) for v in kind}
    found = {
        name: np.asarray(values)
        for named in (sample.x, sample.z, sample.u)
        for name, values in named.items()
        if name not in own
    }
    if bounded:
        knots = np.asarray(planned.knots, dtype=float)
        at = np.broadcast_to(interval, np.shape(times))
        step = STEP * (knots[at + 1] - knots[at])
        middle = np.clip(times, knots[at] + step, knots[at + 1] - step)
        behind, ahead = (
            _smooth(phase.robot, robot_sample(planned, middle + sign * step, interval)) for sign in (-1.0, 1.0)
        )
        found |= {f"rate.{name}": (ahead[name] - behind[name]) / (2.0 * step) for name in bounded}
    return found


def _smooth(robot: Robot, sample: RobotSample) -> dict[str, Array]:
    """Return the accelerations, and the torques without dry friction, (m,) by name."""
    found = {f"a.{joint}": sample.a[:, i] for i, joint in enumerate(robot.velocity_names)}
    for column, joint in enumerate(robot.actuated):
        i = robot.velocity_names.index(joint)
        friction = robot.friction[i] * np.tanh(sample.v[:, i] / robot.friction_speed)
        found[f"tau.{joint}"] = sample.tau[:, column] - friction
    return found


def end_of(planned: PhaseSolutionLike, side: int) -> tuple[Array, Point]:
    """Return the time (1,) [s] and the point of the start (0) or the end (-1) of a phase."""
    knots = np.asarray(planned.knots, dtype=float)
    (point,) = points_of(planned, knots[[side]], 0 if side == 0 else len(knots) - 2)
    return knots[[side]], point


def values_of(constraint: BoundConstraint, points: Sequence[Point]) -> Array:
    """Evaluate a constraint at points, (len(points), rows).

    Raises
    ------
    InputError
        The expression does not return numbers, or not one for each row.
    """
    what = f"expression of {constraint.name!r}"
    values = np.array([as_numbers(constraint.expression(point), what) for point in points])
    if values.shape[1] != len(constraint.rows):
        raise InputError(f"The {what} gave {values.shape[1]} numbers for its {len(constraint.rows)} rows.")
    return values


def see(entries: Sequence[Watched], times: Array, points: Sequence[Point]) -> None:
    """Evaluate constraints at points and add the values to the watches of their rows."""
    for constraint, watches in entries:
        for watch, values in zip(watches, values_of(constraint, points).T, strict=True):
            watch.see(times, values)


def all_watches(entries: Sequence[Watched]) -> list[Watch]:
    """Return the watches of all rows."""
    return list(chain.from_iterable(watches for _, watches in entries))
