"""Guesses through key poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass, own_fields
from robotraj.guess.along_path import check_no_path
from robotraj.guess.ends import default_parameters, guessed_duration, middle_of, normalised_state
from robotraj.guess.samples import check_samples, named_samples
from robotraj.problem.initial_guess import Curve, InitialGuess, PhaseGuess, zeros
from robotraj.problem.phase import Phase
from robotraj.problem.state import State
from robotraj.robot.chart import Chart


@dataclass(frozen=True)
class Keyframes(InitialGuess):
    """States through key poses.

    States of a System and controls are interpolated linearly. Positions of a robot follow the monotone piecewise cubic
    through the poses, without overshoot. A joint that changes direction is at rest there. Velocities that a keyframe
    fixes take precedence. Velocities and accelerations are the rates of the curve.
    Source: Fritsch and Butland, SIAM Journal on Scientific and Statistical Computing 5 (1984).

    Parameters
    ----------
    fractions : sequence of float
        Places of the keyframes, ascending from 0 to 1.
    states : sequence of State
        One state per fraction. Positions and states that are left free are 0.
    duration : float, optional
        Guessed duration [s] where it is free.
    controls : array_like or mapping of str to array_like, optional
        One row per fraction (m, nu), torques of the actuated joints [N m, N] for a robot; or (m,) by control or joint.
        0 by default.

    Raises
    ------
    InputError
        The number of states or controls is not that of the fractions, or these do not ascend from 0 to 1.
    """

    fractions: Sequence[float]
    states: Sequence[State]
    duration: float | None = None
    controls: ArrayLike | Mapping[str, ArrayLike] | None = None

    def __post_init__(self) -> None:
        own_fields(self)
        if len(self.fractions) != len(self.states) or len(self.states) < 2:
            raise InputError(
                f"Keyframes needs one state per fraction and at least two; got {len(self.fractions)} "
                f"fractions and {len(self.states)} states."
            )
        if not np.all(np.diff(self.fractions) > 0) or self.fractions[0] != 0 or self.fractions[-1] != 1:
            raise InputError(f"The fractions of Keyframes must ascend from 0 to 1; got {list(self.fractions)}.")
        if self.controls is not None:
            check_samples(self.controls, len(self.fractions), "controls of Keyframes")

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Interpolate between the keyframes.

        Raises
        ------
        InputError
            A name is unknown, or the number of values is wrong.
        """
        check_no_path(phase, "Keyframes")
        duration = guessed_duration(phase, self.duration)
        states, algebraic = self._motion(phase, duration)
        return PhaseGuess(duration, states, algebraic, self._controls(phase), default_parameters(phase))

    def _motion(self, phase: Phase, duration: float) -> tuple[Curve, Curve]:
        """Return curves of the states and of the algebraic variables."""
        import scipy

        fractions, nz, robot = self.fractions, len(phase.dae.algebraic), phase.robot
        bounds = [state.bounds(phase.dae, "keyframe") for state in self.states]
        keys = np.array([normalised_state(phase, middle_of(pair, 0.0)) for pair in bounds])
        if robot is None:
            return cast(Curve, scipy.interpolate.make_interp_spline(fractions, keys, k=1)), zeros(nz)
        nq, nv = robot.nq, robot.nv
        # States that the objective adds come last and start at 0.
        added = len(phase.dae.states) - nq - nv
        pace = duration if duration > 0 else 1.0
        chart = Chart.around(robot.model, keys[0, :nq])
        at = chart.coordinates(keys[:, :nq])
        rates = scipy.interpolate.PchipInterpolator(fractions, at).derivative()(fractions)
        given = np.array([middle_of(pair, np.nan)[nq : nq + nv] for pair in bounds])
        v = np.where(np.isnan(given), chart.velocities(at, rates / pace), given)
        slopes = np.array([chart.slopes(*row) for row in zip(at, v, strict=True)]) * pace
        y = scipy.interpolate.CubicHermiteSpline(fractions, at, slopes)
        rate, second = y.derivative(1), y.derivative(2)

        def states(s: Array) -> Array:
            at, v = chart.positions(y(s)), chart.velocities(y(s), rate(s) / pace)
            return np.column_stack([at, v, np.zeros((len(s), added))])

        def algebraic(s: Array) -> Array:
            values = np.zeros((len(s), nz))
            if phase.body.algebraic:
                values[:, :nv] = chart.accelerations(y(s), rate(s) / pace, second(s) / pace**2)
            return values

        return states, algebraic

    def _controls(self, phase: Phase) -> Curve:
        if self.controls is None:
            return zeros(len(phase.dae.controls))
        count, robot = len(self.fractions), phase.robot
        names, kind = ([c.name for c in phase.body.controls], "control") if robot is None else (robot.actuated, "joint")
        samples = check_samples(self.controls, count, "controls of Keyframes")
        prefix = "" if robot is None else "tau."
        known = {
            f"{prefix}{name}": column
            for name, column in named_samples(samples, names, count, "controls of Keyframes", kind).items()
        }
        zero = np.zeros(count)
        table = [known.get(control.name, zero) for control in phase.dae.controls]

        def curve(s: Array) -> Array:
            columns = [np.interp(s, self.fractions, column) for column in table]
            return np.column_stack(columns or [np.zeros((len(s), 0))])

        return curve
