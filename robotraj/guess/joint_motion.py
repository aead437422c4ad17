"""Guesses from motions of the joints, with the torques of the inverse dynamics."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeAlias, cast

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.precision import SAME
from robotraj.dynamics.variable import Variable
from robotraj.problem.initial_guess import Curve, PhaseGuess
from robotraj.problem.phase import Phase
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot

Motion: TypeAlias = Callable[[Array], tuple[Array, ...]]
"""From fractions of the phase (m,) to positions (m, nq), velocities and accelerations (m, nv) [SI]."""


def joint_motion(phase: Phase, duration: float, motion: Motion, parameters: Mapping[str, float]) -> PhaseGuess:
    """Return the guess of a motion of the joints.

    Torques are those of the inverse dynamics, tau = B' (RNEA(q, v, a) + d(v)), with damping and friction d. If all
    joints have motors, the guess satisfies the equations of motion.

    Parameters
    ----------
    phase : Phase
        Phase of a robot.
    duration : float
        Duration [s].
    motion : callable
        From fractions of the phase (m,) to positions (m, nq), velocities and accelerations (m, nv) [SI].
    parameters : mapping of str to float
    """
    robot = designed(phase, parameters)
    model, data = robot.model, robot.model.createData()

    def columns(variables: Sequence[Variable]) -> Curve:
        torques = any(variable.name.startswith("tau.") for variable in variables)

        def curve(s: Array) -> Array:
            parts = dict(zip("qva", motion(s), strict=True))
            names = {"q": robot.position_names, "v": robot.velocity_names, "a": robot.velocity_names}
            known = {
                f"{kind}.{name}": values[:, i] for kind, values in parts.items() for i, name in enumerate(names[kind])
            }
            if torques:
                rows = zip(*parts.values(), strict=True)
                needed = np.array([pin.rnea(model, data, *row) + robot.resistance(*row[:2]) for row in rows])
                for i, joint in enumerate(robot.velocity_names):
                    known[f"tau.{joint}"] = needed[:, i]
            # Slacks, rates and forces start at 0.
            zero = np.zeros(len(s))
            return np.column_stack([known.get(x.name, zero) for x in variables] or [np.zeros((len(s), 0))])

        return curve

    dae = phase.dae
    return PhaseGuess(duration, columns(dae.states), columns(dae.algebraic), columns(dae.controls), parameters)


def designed(phase: Phase, parameters: Mapping[str, float]) -> Robot:
    """Return the robot of a phase; the parameters of its design have the given values."""
    assert phase.robot is not None
    design = phase.bound_design
    return phase.robot if design is None else design.realise(parameters)


class Differentiable(Protocol):
    """A curve from fractions (m,) to values (m, n) that has derivatives, as SciPy's splines."""

    def __call__(self, s: Array) -> Array: ...  # noqa: D102
    def derivative(self, order: int) -> Differentiable: ...  # noqa: D102


def quintic(fractions: Array, keys: Array, first: Array, last: Array) -> Differentiable:
    """Return the minimum-jerk curve through keys (m, n) at fractions (m,), with given slopes at its ends.

    The curve that minimises the integral of the squared third derivative is the quintic spline with four continuous
    derivatives. Through two keys it is one quintic. Sources: Flash and Hogan, Journal of Neuroscience 5 (1985); de
    Boor, A Practical Guide to Splines (2001), chapter XIII.
    """
    # Importing SciPy's splines takes longer than computing most guesses.
    import scipy

    zero = np.zeros(keys.shape[1])
    ends = [(1, first), (2, zero)], [(1, last), (2, zero)]
    return cast(Differentiable, scipy.interpolate.make_interp_spline(fractions, keys, k=5, bc_type=ends))


def fractions_of(given: Sequence[float] | None, keys: Array, speeds: Array, what: str) -> Array:
    """Return the fractions of the keys: those given, or in proportion to the time at full speed.

    Raises
    ------
    InputError
        The number of fractions is wrong, or they do not ascend from 0 to 1.
    """
    if given is None:
        gaps = np.abs(np.diff(keys, axis=0)) / np.where(np.isfinite(speeds), speeds, 1.0)
        # Equal keys take a small part of the time, so that fractions ascend.
        steps = np.maximum(gaps.max(axis=1), 1e-2 * max(gaps.max(), SAME))
        return np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
    fractions = np.asarray(given, dtype=float)
    sorted_ends = len(fractions) == len(keys) and fractions[0] == 0.0 and fractions[-1] == 1.0
    if not sorted_ends or not np.all(np.diff(fractions) > 0):
        raise InputError(
            f"The fractions of {what} must ascend from 0 to 1, one for the start, each waypoint and the end "
            f"({len(keys)}); got {list(given)}."
        )
    return fractions


def speeds_of(phase: Phase, robot: Robot) -> Array:
    """Return the largest speeds that a phase allows either way (nv,), infinite where there are no limits."""
    limits = phase.limits
    return limits.largest("velocity") if isinstance(limits, Limits) else np.full(robot.nv, np.inf)
