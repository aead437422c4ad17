"""The motion of a system from its start under constant controls."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.precision import MET, SAMPLES
from robotraj._util.values import dataclass
from robotraj.guess.ends import default_parameters, ends_of, guessed_duration, middle_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.phase import Phase


@dataclass(frozen=True)
class Simulated(InitialGuess):
    """States of a System simulated from the start of its phase, with controls in the middle of their bounds.

    The motion satisfies xdot = f(x, u, p, t), and may miss all other conditions. It is a guess for reactors and other
    systems whose ends are free: a straight line is far from any of their motions. Where the states grow without
    limit, they stay at the last values.

    Controls without bounds are 0, and with one bound they have its value. Parameters are in the middle of their bounds.

    Parameters
    ----------
    duration : float, optional
        Guessed duration [s] where it is free; by default that of ``rt.guess.StraightLine``.
    """

    duration: float | None = None

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Simulate the phase.

        Raises
        ------
        InputError
            The phase moves a robot, or has algebraic variables.
        """
        dae = phase.dae
        if phase.robot is not None or dae.algebraic:
            raise InputError(
                f"rt.guess.Simulated: phase {phase.name!r} is no System without algebraic variables; "
                "use rt.guess.StraightLine()."
            )
        import scipy

        ends, parameters = ends_of(phase), default_parameters(phase)
        duration = guessed_duration(phase, self.duration, ends)
        controls = middle_of(Bounds(*phase.rows.limits_of(dae.controls)), 0.0)
        fractions = np.linspace(0.0, 1.0, SAMPLES)
        values = _simulated(_rates(phase), ends[0], controls, np.array(list(parameters.values())), duration * fractions)
        states = scipy.interpolate.PchipInterpolator(fractions, values)
        return PhaseGuess(
            duration,
            lambda s: np.asarray(states(s)),
            lambda s: np.zeros((len(s), 0)),
            lambda s: np.tile(controls, (len(s), 1)),
            parameters,
        )


def _rates(phase: Phase) -> ca.Function:
    """Return f(t, x, u, p) of a phase."""
    dae, names = phase.dae, phase.parameter_names
    t, x, u, p = (
        ca.SX.sym(name, size)
        for name, size in zip("txup", (1, len(dae.states), len(dae.controls), len(names)), strict=True)
    )
    point = dae.point(t, x, ca.SX(0, 1), u, p, names)
    return ca.Function("rates", [t, x, u, p], [ca.densify(dae.rates(point))])


def _simulated(rates: Callable[..., ca.DM], first: Array, controls: Array, parameters: Array, times: Array) -> Array:
    """Integrate the rates from ``first`` (nx,) and return the states at the times, (m, nx)."""
    import scipy

    # Beyond this growth the error that is allowed at the start may be as large as the state was.
    most = np.maximum(1.0, np.abs(first)) / MET

    def rate(t: float, x: Array) -> Array:
        return np.asarray(rates(t, x, controls, parameters)).ravel()

    def within(t: float, x: Array) -> float:
        return float(np.min(most - np.abs(x)))

    within.terminal = True  # type: ignore[attr-defined]
    tolerances = {"rtol": MET, "atol": MET}
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # LSODA warns of states that grow without limit.
        warnings.simplefilter("ignore")
        found = scipy.integrate.solve_ivp(
            rate, (times[0], times[-1]), first, "LSODA", times, events=within, **tolerances
        )
    values = np.vstack([first, np.asarray(found.y).T.reshape(-1, len(first))[1:]])
    values = values[np.all(np.isfinite(values), axis=1)]
    return np.vstack([values, np.tile(values[-1], (len(times) - len(values), 1))])
