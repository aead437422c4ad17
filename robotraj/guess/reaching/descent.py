"""Damped least squares within bounds: the one search of configurations at which errors vanish or are least.

Steps dq = J' (J J' + m 1)^-1 e reduce the norm of errors e with slopes J. The damping m falls after a step that helps
and grows after one that does not, separately for each of several configurations.

Sources: Nakamura and Hanafusa, Journal of Dynamic Systems, Measurement, and Control 108 (1986); the damping follows
Marquardt, Journal of the Society for Industrial and Applied Mathematics 11 (1963).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.precision import ROUND_OFF, SAME
from robotraj.robot.root import QUATERNION
from robotraj.robot.tangent import PLACE, REST, TURN

Errors = Callable[[Array], tuple[Array, Array]]
"""From configurations (m, nq) to errors (m, rows), by which values should rise, and their slopes (m, rows, nv)."""

SEEDS = 48
"""Number of configurations from which a search starts: the given one and seeded random ones within the bounds."""
STEPS = 60
"""Largest number of steps from one configuration. Convergence takes some ten; the others leave a bad start."""
DAMPING, EASED, RAISED = 1e-3, 0.2, 4.0
"""First damping relative to the largest squared slope, and its ratio after a step that helps and after another one.

As Marquardt's, they matter little: any decrease and any larger increase converge.
"""


def descended(
    errors: Errors,
    q: Array,
    bounds: tuple[Array, Array],
    steps: int = STEPS,
    model: pin.Model | None = None,
) -> tuple[Array, Array]:
    """Return configurations (m, nq) of least errors near given ones, and the errors (m, rows) there.

    Joints at bounds that a step would violate are fixed. A floating root whose position or quaternion is bounded to one
    value keeps it.

    Parameters
    ----------
    errors : callable
    q : ndarray (m, nq)
        First configurations.
    bounds : (ndarray (nq,), ndarray (nq,))
        Of the positions [rad, m].
    steps : int
    model : pinocchio.Model, optional
        Moves configurations with a quaternion; others are moved by a sum.
    """
    q = np.clip(q, *bounds)
    error, slopes = errors(q)
    size = np.linalg.norm(error, axis=1)
    first = np.square(slopes).sum(axis=2).max(axis=1, initial=0.0)
    # Errors without slopes stay as they are; their damping only keeps the equations of all regular.
    damping, active = DAMPING * np.where(first > 0.0, first, 1.0), (size > ROUND_OFF) & (first > 0.0)
    for _ in range(steps):
        if not active.any():
            break
        along = np.einsum("mrv,mr->mv", slopes, error)
        step = _step(slopes * _free(q, along, bounds)[:, None], error, damping)
        trial = np.clip(_moved(model, q, step), *bounds)
        error_there, slopes_there = errors(trial)
        size_there = np.linalg.norm(error_there, axis=1)
        better = active & (size_there < size)
        active &= (size_there < (1.0 - SAME) * size) & (size_there > ROUND_OFF) | ~better & (damping < first / SAME)
        q = np.where(better[:, None], trial, q)
        error = np.where(better[:, None], error_there, error)
        slopes = np.where(better[:, None, None], slopes_there, slopes)
        size = np.where(better, size_there, size)
        damping = np.where(better, np.maximum(EASED * damping, ROUND_OFF * first), RAISED * damping)
    return q, error


def _moved(model: pin.Model | None, q: Array, step: Array) -> Array:
    if model is None:
        return q + step
    return np.array([pin.integrate(model, *each) for each in zip(q, step, strict=True)])


def _step(slopes: Array, error: Array, damping: Array) -> Array:
    """Return J' (J J' + m 1)^-1 e, or the same by (J' J + m 1)^-1 J' e where the columns are fewer than the rows."""
    across = slopes.swapaxes(1, 2)
    if slopes.shape[1] <= slopes.shape[2]:
        square = slopes @ across + damping[:, None, None] * np.eye(slopes.shape[1])
        return np.asarray((across @ np.linalg.solve(square, error[..., None]))[..., 0])
    square = across @ slopes + damping[:, None, None] * np.eye(slopes.shape[2])
    return np.asarray(np.linalg.solve(square, across @ error[..., None])[..., 0])


def _free(q: Array, along: Array, bounds: tuple[Array, Array]) -> NDArray[np.bool_]:
    """Return which entries of v (m, nv) move no position beyond a bound."""
    lower, upper = bounds
    floating = q.shape[1] > along.shape[1]
    places, rates = (slice(QUATERNION.stop, None), REST) if floating else (slice(None), slice(None))
    at, ahead = q[:, places], along[:, rates]
    free = np.ones(along.shape, dtype=bool)
    free[:, rates] = ~((at <= lower[places]) & (ahead < 0) | (at >= upper[places]) & (ahead > 0))
    if floating:
        for part, own in ((PLACE, PLACE), (QUATERNION, TURN)):
            free[:, own] = not np.array_equal(lower[part], upper[part])
    return free
