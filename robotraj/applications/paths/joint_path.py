"""Joint paths as piecewise polynomials, from configurations, splines or planned motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.curves.splines import through
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError, warn
from robotraj.robot.limits import Limits
from robotraj.robot.loading.other_units import doubt_of_unit
from robotraj.robot.robot import Robot
from robotraj.solution.solution import Solution

JointPath: TypeAlias = "ArrayLike | Solution | PiecewisePolynomial | Callable[[Array], ArrayLike]"
"""What ``as_path`` takes."""
HIGHEST = 5
"""Degree of the spline through configurations, which has continuous jerks; lower with fewer than six of them."""
NEARLY_A_TURN = 1.5 * np.pi
"""Jump between two configurations above which an angle was wrapped [rad]."""
PLACES = np.linspace(0.0, 1.0, 17)
"""Places of every piece of a path at which positions are compared with their limits."""
ROUNDING = 1e-6
"""Largest violation of a limit of position that is rounding [rad, m]."""
PIECES = 32
"""Number of pieces by which a function of the parameter is approximated."""


def as_path(path: JointPath, parameters: ArrayLike | None = None) -> PiecewisePolynomial:
    """Return a path q(s) of joints.

    Parameters
    ----------
    path : array (m, nq), Solution, PiecewisePolynomial, spline or callable
        An array of configurations [rad, m] is interpolated by a spline of degree 5, or lower with fewer than six. A
        solution gives its positions over time. Splines of SciPy are converted exactly. Other functions of s return
        (nq,) and are interpolated. Their interval is ``path.path_interval``, as in TOPP-RA, else [0, 1].
    parameters : array (m,), optional
        Ascending parameters of the configurations. The default is the length of the polygon through them, scaled to
        [0, 1].

    Returns
    -------
    PiecewisePolynomial
        From s to q (nq,).

    Raises
    ------
    InputError
        The path has another type or shape, equal neighbours or numbers that are not finite, or parameters that do not
        ascend.
    """
    if isinstance(path, PiecewisePolynomial):
        return path
    if isinstance(path, Solution):
        return _of_solution(path)
    if callable(path):
        return _of_function(path)
    return _through(_numbers(path), parameters)


def _numbers(points: object) -> Array:
    try:
        return np.array(points, dtype=float)
    except (TypeError, ValueError) as error:
        entry = f" of {type(points[0]).__name__} entries" if isinstance(points, list | tuple) and points else ""
        raise InputError(
            f"A path is an array (m, nq) of numbers, a spline or a solution; got a {type(points).__name__}{entry}."
        ) from error


def unwrapped(points: ArrayLike, robot: Robot, limits: Limits) -> ArrayLike:
    """Return configurations without jumps by nearly a turn, which files have whose angles are wrapped to [-pi, pi].

    Only joints without position limits are unwrapped.

    Raises
    ------
    InputError
        The configurations have another number of joints than the robot.

    Warns
    -----
    UserWarning
        A joint was unwrapped. The message names it and the configuration.
    """
    found = _numbers(points)
    if found.ndim != 2 or robot.nq != robot.nv:
        return points
    if found.shape[1] != robot.nq:
        raise InputError(
            f"A path of {robot.name!r} is an array (m, {robot.nq}), a column for each of "
            f"{', '.join(robot.position_names)}; got shape {found.shape}."
        )
    low, high = limits.positions
    jumped = []
    for i, name in enumerate(robot.position_names):
        jumps = np.abs(np.diff(found[:, i])) > NEARLY_A_TURN
        if robot.position_units[i] == "rad" and np.isinf([low[i], high[i]]).all() and jumps.any():
            jumped.append(f"{name!r} at configuration {int(np.argmax(jumps)) + 1}")
            found[:, i] = np.unwrap(found[:, i])
    if jumped:
        warn(f"The path jumps by nearly a turn, which was read as the short way: {', '.join(jumped)}.")
    return found


def check_positions(path: PiecewisePolynomial, limits: Limits, units: Sequence[str]) -> None:
    """Raise an InputError that names the joint and the parameter s at which a path exceeds a limit of position.

    ``units`` has "rad" or "m" of each joint.
    """
    q = path.inside(PLACES)
    if q.shape[-1] != len(limits.joints):
        raise InputError(f"The path has {q.shape[-1]} joints, but the robot {len(limits.joints)}.")
    beyond = np.maximum(limits.position_lower - q, q - limits.position_upper)
    piece, place, joint = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
    if beyond[piece, place, joint] > ROUNDING:
        s = path.breaks[piece] + PLACES[place] * (path.breaks[piece + 1] - path.breaks[piece])
        low, high = (float(side[joint]) for side in limits.positions)
        doubt = doubt_of_unit(float(q[piece, place, joint]), low, high, units[int(joint)])
        raise InputError(
            f"The path has {limits.joints[joint]!r} at {q[piece, place, joint]:.6g} at s = {s:.4g}, outside its "
            f"position limit [{low:g}, {high:g}]. Move the path, or give other limits=.{doubt}"
        )


def _through(points: Array, parameters: ArrayLike | None) -> PiecewisePolynomial:
    if points.ndim != 2 or len(points) < 2 or not np.isfinite(points).all():
        raise InputError(f"A path is a finite array (m, nq) of at least two configurations; got shape {points.shape}.")
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if not (steps > 0).all():
        raise InputError(f"Configurations {int(np.argmin(steps))} and the next of the path are equal; leave one out.")
    s = np.append(0.0, np.cumsum(steps) / steps.sum()) if parameters is None else np.array(parameters, dtype=float)
    if s.shape != (len(points),) or not (np.diff(s) > 0).all():
        raise InputError(f"The path needs {len(points)} ascending parameters; got {s.tolist()}.")
    degree = min(HIGHEST, len(points) - 1)
    if degree % 2 == 0:
        # Too few points for the odd degree above: one polynomial passes through three or five of them.
        if len(points) == degree + 1:
            return PiecewisePolynomial(s[[0, -1]], [(s - s[0]) / (s[-1] - s[0])], [points])
        degree -= 1
    spline = through(s, points, degree)
    return _sampled(spline, np.unique(spline.knots), degree)


def _of_solution(solution: Solution) -> PiecewisePolynomial:
    alone = solution.phases[0].phase.path if len(solution.phases) == 1 else None
    if alone is not None:
        return alone.curve
    breaks, sites, values = [np.array([solution.phases[0].t0])], list[Array](), list[Array]()
    for part in solution.phases:
        if part.phase.robot is None:
            raise InputError(f"Phase {part.phase.name!r} of the solution moves a System, which has no path of joints.")
        curve = part.joint_states
        breaks.append(curve.breaks[1:])
        sites += list(curve.sites)
        values += [each[:, : part.phase.robot.nq] for each in curve.values]
    return PiecewisePolynomial(np.concatenate(breaks), sites, values)


def _of_function(path: Callable[[Array], ArrayLike]) -> PiecewisePolynomial:
    coefficients, places = getattr(path, "c", None), getattr(path, "x", None)
    if isinstance(places, np.ndarray) and isinstance(coefficients, np.ndarray) and coefficients.ndim == 3:
        return _sampled(path, places, coefficients.shape[0] - 1)
    knots, degree = getattr(path, "t", None), getattr(path, "k", None)
    if isinstance(knots, np.ndarray) and isinstance(degree, int):
        return _sampled(path, np.unique(knots[degree : len(knots) - degree]), degree)
    first, last = getattr(path, "path_interval", (0.0, 1.0))
    return _sampled(path, np.linspace(first, last, PIECES + 1), HIGHEST)


def _sampled(path: Callable[[Array], ArrayLike], breaks: Array, degree: int) -> PiecewisePolynomial:
    """Interpolate a path on every interval by a polynomial of that degree."""
    sites = np.linspace(0.0, 1.0, degree + 1) if degree else np.array([0.5])
    values = []
    for start, end in zip(breaks[:-1], breaks[1:], strict=True):
        found = np.array([np.asarray(path(start + (end - start) * site), dtype=float) for site in sites])
        if found.ndim != 2 or not np.isfinite(found).all():
            raise InputError(f"The path must give finite configurations (nq,); got shape {found.shape[1:]}.")
        values.append(found)
    return PiecewisePolynomial(np.array(breaks, dtype=float), [sites] * len(values), values)
