"""Guesses from the bounds of a phase: its ends, its parameters and its duration."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.guess.least_time import fastest_line
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.phase import Phase
from robotraj.robot.chart import coordinate_difference
from robotraj.robot.limits import Limits
from robotraj.robot.root import QUATERNION

MARGIN = 1.5
"""Ratio of a guessed duration to the least time of a straight line, so that smooth motions keep their speed limits."""


def default_parameters(phase: Phase) -> dict[str, float]:
    """Return the middle of each parameter's bounds, or its finite bound, or 1."""
    values = middle_of(phase.parameter_bounds, 1.0)
    return dict(zip(phase.parameter_names, (float(v) for v in values), strict=True))


def middle_of(bounds: Bounds, free: float) -> Array:
    """Return the middle of two finite bounds, the only finite bound, or ``free``, (n,)."""
    low, high = bounds
    with np.errstate(invalid="ignore"):
        middle = np.where(
            np.isfinite(low) & np.isfinite(high), 0.5 * (low + high), np.where(np.isfinite(low), low, high)
        )
    return np.where(np.isfinite(middle), middle, free)


def ends_of(
    phase: Phase, entered: Array | None = None, positions: tuple[Array, Array] | None = None
) -> tuple[Array, Array]:
    """Return guesses of the first and last state, (nx,) each.

    A value that is free at one end is taken from the other end. A value that is free at both ends is that of
    ``entered`` if given. Otherwise positions of robots are neutral and all other values 0.

    Parameters
    ----------
    phase : Phase
    entered : ndarray, optional
        First entries of the state at which a link starts the phase; a path determines its own ends.
    positions : (ndarray, ndarray), optional
        Positions (nq,) of the robot at both ends, which replace those of the bounds; NaN where they are unknown.
    """
    rest = np.zeros(len(phase.dae.states))
    if phase.path is not None:
        entered = positions = None
    if entered is not None:
        rest[: len(entered)] = entered
    if phase.state_robot is not None:
        rest[: phase.state_robot.nq] = phase.state_robot.neutral
    first, last = middle_of(phase.start_bounds, np.nan), middle_of(phase.end_bounds, np.nan)
    for state, known in zip((first, last), positions or (), strict=False):
        state[: len(known)] = np.where(np.isnan(known), state[: len(known)], known)
    first = np.where(np.isnan(first), np.where(np.isnan(last), rest, last), first)
    last = np.where(np.isnan(last), first, last)
    return normalised_state(phase, first), normalised_state(phase, last)


def normalised_state(phase: Phase, x: Array) -> Array:
    """Scale the root's quaternion in a state (nx,) to length 1; a zero quaternion becomes the neutral one."""
    robot = phase.robot
    if robot is None or robot.root != "floating":
        return x
    x = np.array(x)
    size = np.linalg.norm(x[QUATERNION])
    x[QUATERNION] = x[QUATERNION] / size if size > 0 else robot.neutral[QUATERNION]
    return x


def guessed_duration(phase: Phase, given: float | None, ends: tuple[Array, Array] | None = None) -> float:
    """Return a guess of the duration [s]: the given one, or one between the bounds.

    The latter is at least ``MARGIN`` times the least time of a straight line. This time is that of ``fastest_line``, or
    that of the speed limits if the torque limits bound no acceleration. A guess that is too short violates limits
    everywhere; one that is too long costs few iterations.

    Raises
    ------
    InputError
        The given duration lies outside the phase's bounds.
    """
    low, high = phase.duration_bounds
    if given is not None:
        if not low <= given <= high:
            raise InputError(
                f"The guessed duration {given} s of phase {phase.name!r} lies outside {low} to {high} s; give one "
                "inside."
            )
        return given
    if low == high:
        return low
    if low > 0:
        guess = np.sqrt(low * high) if np.isfinite(high) else 2 * low
    else:
        guess = min(max(1.0, high / 20), high / 2) if np.isfinite(high) else 1.0
    ends = ends or ends_of(phase)
    law = fastest_line(phase, *ends)
    if law is not None:
        guess = max(guess, MARGIN * law.duration)
    elif phase.state_robot is not None and isinstance(phase.limits, Limits):
        robot = phase.state_robot
        first, last = (x[: robot.nq] for x in ends)
        gaps = np.abs(coordinate_difference(robot.model, first, last))
        guess = max(guess, MARGIN * float(np.max(gaps / phase.limits.largest("velocity"), initial=0.0)))
    return float(np.clip(guess, low, high))
