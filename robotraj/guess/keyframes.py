"""Guesses through key poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.guess.guess import (
    Curve,
    Guess,
    PhaseGuess,
    constant,
    default_parameters,
    guessed_duration,
    middle_of,
    turned,
)
from robotraj.problem.state import State
from robotraj.robot.chart import Chart

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Keyframes(Guess):
    """States through key poses.

    States of a System run on straight lines. A robot's positions run on the monotone piecewise cubic through
    the poses, without overshoot and at rest where they turn; velocities and accelerations are that curve's
    own.
    Source: Fritsch and Butland, SIAM Journal on Scientific and Statistical Computing 5 (1984).

    Parameters
    ----------
    fractions : sequence of float
        Where the keyframes are, ascending from 0 to 1.
    states : sequence of State
        One state per fraction; entries left free are 0. Of a robot's keyframes only the positions are read.
    duration : float, optional
        Guessed duration [s] where it is free.
    """

    fractions: Sequence[float]
    states: Sequence[State]
    duration: float | None = None

    def __post_init__(self) -> None:
        if len(self.fractions) != len(self.states) or len(self.states) < 2:
            raise InputError(
                f"Keyframes needs one state per fraction and at least two; got {len(self.fractions)} "
                f"fractions and {len(self.states)} states."
            )
        if not np.all(np.diff(self.fractions) > 0) or self.fractions[0] != 0 or self.fractions[-1] != 1:
            raise InputError(f"The fractions of Keyframes must ascend from 0 to 1; got {list(self.fractions)}.")

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Interpolate between the keyframes."""
        keys = np.array([turned(phase, middle_of(state.bounds(phase.dae, "keyframe"), 0.0)) for state in self.states])
        duration = guessed_duration(phase, self.duration)
        states, algebraic = _through(phase, self.fractions, keys, duration)
        return PhaseGuess(duration, states, algebraic, constant(len(phase.dae.controls)), default_parameters(phase))


def _through(phase: Phase, fractions: Sequence[float], keys: Array, duration: float) -> tuple[Curve, Curve]:
    """States and algebraic variables of a motion through key states (m, nx)."""
    nz = len(phase.dae.algebraic)
    import scipy

    if phase.robot is None:
        return scipy.interpolate.make_interp_spline(fractions, keys, k=1), constant(nz)
    # What an objective added comes last and starts from 0.
    nq, nv, further = phase.robot.nq, phase.robot.nv, len(phase.dae.states) - len(phase.body.states)
    chart = Chart.around(phase.robot.model, keys[0, :nq])
    y = scipy.interpolate.PchipInterpolator(fractions, chart.coordinates(keys[:, :nq]))
    rate, second = y.derivative(1), y.derivative(2)
    pace = duration if duration > 0 else 1.0

    def states(s: Array) -> Array:
        at = y(s)
        return np.column_stack([chart.positions(at), chart.velocities(at, rate(s) / pace), np.zeros((len(s), further))])

    def algebraic(s: Array) -> Array:
        values = np.zeros((len(s), nz))
        if phase.body.algebraic:
            values[:, :nv] = chart.accelerations(y(s), rate(s) / pace, second(s) / pace**2)
        return values

    return states, algebraic
