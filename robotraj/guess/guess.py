"""A guess from arrays over time, and one guess for each phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.precision import MET
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.guess.along_path import check_no_path
from robotraj.guess.ends import default_parameters
from robotraj.guess.robot_samples import RobotSamples
from robotraj.guess.samples import Samples, ascending_times, check_samples, named_samples
from robotraj.guess.straight_line import StraightLine
from robotraj.problem.initial_guess import Curve, PhaseGuess
from robotraj.problem.initial_guess import InitialGuess as InitialGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem

ROBOT = ("q", "v", "a", "tau", "forces")
SYSTEM = ("states", "controls", "algebraic")


@dataclass(frozen=True, eq=False)
class Guess(InitialGuess):
    """Arrays over time for one phase, such as those of another planner, a simulation or a measurement.

    The phase's duration starts as ``times[-1] - times[0]``. States are interpolated by monotone piecewise cubics,
    positions by the cubics that have the velocities as slopes, controls and algebraic variables linearly.

    Missing values are completed. Missing states are those of ``rt.guess.StraightLine``. Missing velocities and
    accelerations are central differences. Missing contact forces balance the robot in the least-squares sense, and
    torques follow from the inverse dynamics. Other controls and algebraic variables start at 0.

    Parameters
    ----------
    times : (m,) array_like
        Ascending times [s]; only differences matter.
    q, v, a : array_like or mapping of str to array_like
        Motion of a robot, (m, nq) [rad, m], (m, nv) [rad/s, m/s] and (m, nv) [rad/s^2, m/s^2], or (m,) by joint name.
        Quaternions (x, y, z, w) must have length 1. Their signs are chosen so that consecutive samples are near each
        other. A number applies to all times.
    tau : array_like or mapping of str to array_like
        Torques of the actuated joints, (m, nu) [N m, N].
    forces : mapping of str to array_like
        Forces by contact name, world axes: (m, 3) [N], or (m, 6) [N, N m] with moments.
    states, controls, algebraic : array_like or mapping of str to array_like
        Values of a System, (m, n) in its order, or (m,) by name.
    parameters : mapping of str to float
        Parameters of the phase; the others start in the middle of their bounds.

    Raises
    ------
    InputError
        The times do not ascend, a shape is wrong, or a number is not finite.

    Examples
    --------
    ``rt.plan(phase, guess=rt.Guess(times, q=positions, tau=torques))``. Several phases take a sequence, one guess each:
    ``rt.plan(problem, guess=[rt.Guess(...), rt.Guess(...)])``.
    """

    times: ArrayLike
    q: Samples | None = None
    v: Samples | None = None
    a: Samples | None = None
    tau: Samples | None = None
    forces: Mapping[str, ArrayLike] | None = None
    states: Samples | None = None
    controls: Samples | None = None
    algebraic: Samples | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        times = ascending_times(self.times, "rt.Guess")
        object.__setattr__(self, "times", times)
        for name in (*ROBOT, *SYSTEM):
            value = getattr(self, name)
            if value is None:
                continue
            if name != "forces":
                value = check_samples(value, len(times), f"{name} of rt.Guess")
            elif isinstance(value, Mapping):
                value = {
                    contact: check_samples(force, len(times), f"forces of rt.Guess of contact {contact!r}")
                    for contact, force in value.items()
                }
            else:
                raise InputError(
                    'forces of rt.Guess must be a mapping by contact name, such as {"foot": (m, 3) array}.'
                )
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        times = self._times
        given = [name for name in (*ROBOT, *SYSTEM) if getattr(self, name) is not None]
        return f"Guess({len(times)} times from {times[0]:g} to {times[-1]:g} s: {', '.join(given) or 'no values'})"

    @property
    def _times(self) -> Array:
        return cast(Array, self.times)

    def prepared(self, problem: Problem) -> InitialGuess:
        """Check that the problem has one phase."""
        return EachPhase((self,)).prepared(problem)

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Interpolate the samples.

        Raises
        ------
        InputError
            The span of the times is no duration of the phase, a name is unknown, or the number of columns is wrong.
            Values of a robot are given for a System or the reverse, or a quaternion's length is not 1.
        """
        check_no_path(phase, "rt.Guess")
        self._check_kind(phase)
        times, duration = self._times, self._duration(phase)
        line = StraightLine(duration).of(phase, index)
        fractions = (times - times[0]) / (times[-1] - times[0])
        values = line.states(fractions)
        known = {state.name: values[:, i] for i, state in enumerate(phase.dae.states)}
        parameters = self._parameters(phase)
        robot = None
        if phase.robot is None:
            for what, variables in self._groups(phase).items():
                given = getattr(self, what)
                if given is not None:
                    names = [variable.name for variable in variables]
                    known |= named_samples(given, names, len(times), f"{what} of rt.Guess", _KINDS[what])
        else:
            robot = RobotSamples(phase, fractions, duration, parameters)
            known |= robot.completed({name: getattr(self, name) for name in ROBOT}, values)

        import scipy

        def columns(variables: Sequence[Variable], smooth: bool) -> Curve:
            zero = np.zeros(len(times))
            table = np.column_stack([known.get(x.name, zero) for x in variables] or [np.zeros((len(times), 0))])
            if smooth and table.shape[1]:
                return cast(Curve, scipy.interpolate.PchipInterpolator(fractions, table))
            return lambda s: np.column_stack(
                [np.interp(s, fractions, column) for column in table.T] or [np.zeros((len(s), 0))]
            )

        dae = phase.dae
        states = columns(dae.states, True)
        if robot is not None:
            states = robot.with_positions(states, known)
        return PhaseGuess(duration, states, columns(dae.algebraic, False), columns(dae.controls, False), parameters)

    def _check_kind(self, phase: Phase) -> None:
        """Refuse values of a robot for a System and the reverse."""
        wrong, right = (ROBOT, SYSTEM) if phase.robot is None else (SYSTEM, ROBOT)
        for name in wrong:
            if getattr(self, name) is not None:
                moved = "a System" if phase.robot is None else f"robot {phase.robot.name!r}"
                raise InputError(
                    f"rt.Guess has {name}=, but phase {phase.name!r} moves {moved}; "
                    f"give {', '.join(f'{other}=' for other in right)}."
                )

    def _groups(self, phase: Phase) -> dict[str, tuple[Variable, ...]]:
        return {"states": phase.body.states, "controls": phase.body.controls, "algebraic": phase.body.algebraic}

    def _duration(self, phase: Phase) -> float:
        span, (low, high) = float(self._times[-1] - self._times[0]), phase.duration_bounds
        if not low - MET * span <= span <= high + MET * span:
            raise InputError(
                f"times of rt.Guess span {span:g} s, but the duration of phase {phase.name!r} lies between {low:g} and "
                f"{high:g} s. Scale the times and the velocities, or change the duration."
            )
        return float(np.clip(span, low, high))

    def _parameters(self, phase: Phase) -> dict[str, float]:
        for name in self.parameters:
            if name not in phase.parameter_names:
                raise unknown_name("parameter", name, phase.parameter_names, "Correct the name in rt.Guess.")
        return default_parameters(phase) | {name: float(value) for name, value in self.parameters.items()}


_KINDS = {"states": "state", "controls": "control", "algebraic": "algebraic variable"}


@dataclass(frozen=True, eq=False)
class EachPhase(InitialGuess):
    """One guess for each phase; ``rt.plan(problem, guess=[...])`` makes it from a sequence.

    Parameters
    ----------
    guesses : sequence of InitialGuess
    """

    guesses: Sequence[InitialGuess]

    def prepared(self, problem: Problem) -> InitialGuess:
        """Check the number of phases, and prepare every guess.

        Raises
        ------
        InputError
            The problem has another number of phases.
        """
        if len(self.guesses) != len(problem.phases):
            names = ", ".join(repr(phase.name) for phase in problem.phases)
            raise InputError(
                f"The problem has {len(problem.phases)} phases ({names}), and guess= describes {len(self.guesses)}; "
                "give a sequence with one guess a phase."
            )
        return EachPhase([g if isinstance(g, Guess) else g.prepared(problem) for g in self.guesses])

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the guess of the phase of the same number."""
        return self.guesses[index].of(phase, index)

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Return the values of the first guess that has any."""
        return next((found for g in self.guesses if (found := g.of_link(link, index))), {})
