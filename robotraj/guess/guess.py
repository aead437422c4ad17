"""Where a solver starts: values that give states, algebraic variables and controls along every phase."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.guess.least_time import fastest_line
from robotraj.problem.constraints.bounds import Bounds
from robotraj.robot.chart import Chart, way
from robotraj.robot.limits import Limits
from robotraj.robot.root import QUATERNION

if TYPE_CHECKING:
    from robotraj.dynamics.variable import Variable
    from robotraj.problem.links.base import BoundLink
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem

Array = NDArray[np.float64]
Curve = Callable[[Array], Array]

SLOWER = 1.5
"""How many times the least time of a straight line a guess takes: a smooth motion then keeps its speed limits."""


@dataclass(frozen=True, eq=False)
class PhaseGuess:
    """A guess of one phase.

    Attributes
    ----------
    duration : float
        [s].
    states, algebraic, controls : callable
        From fractions of the phase (m,) to values (m, n).
    parameters : mapping of str to float
    """

    duration: float
    states: Curve
    algebraic: Curve
    controls: Curve
    parameters: Mapping[str, float]


class Guess(ABC):
    """A value that starts a solver. A new kind is one new class."""

    @abstractmethod
    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Guess phase number ``index`` of the problem."""

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Guess the unknowns of link number ``index`` by name, such as impulses; what is not named is 0."""
        return {}

    def prepared(self, problem: Problem) -> Guess:
        """Do what needs the whole problem, before its phases are guessed; most guesses need nothing."""
        return self


@dataclass(frozen=True)
class StraightLine(Guess):
    """States on a straight line from start to end, no torque.

    A robot's positions run on the line and its velocities are the rate of that line, (q_end - q_start) / T,
    so that the guess moves as its velocities say; the velocities given for the ends hold there. A floating root's
    origin runs on the line and the root turns at one rate about one axis, its velocities in its own axes. Against
    velocities on a line of their own this halves the iterations and keeps minimum-time problems from
    shrinking the duration to nothing.

    Where the duration is free and the limits of all joints tell how fast the line can be run, speeds rise and fall
    along it as in its fastest motion, slowed down to T, and accelerations are those of that motion. With s from 0 to 1
    along the line, from rest to rest, s' at most s'_max and s'' at most k by the limits of speeds, accelerations and
    torques, the least time is 1 / p + p / k, p = min(s'_max, sqrt(k)).
    Source: Lynch and Park, Modern Robotics (2017), section 9.2.

    A state that a system's phase leaves free at both ends stays where ``rt.Continuity`` or ``rt.links.Jump`` brings it.

    Parameters
    ----------
    duration : float, optional
        Guessed duration [s] where it is free; by default from the bounds, and at least 1.5 times the least time.
    """

    duration: float | None = None

    def prepared(self, problem: Problem) -> Guess:
        """Let phases of systems of whose states nothing is said stay where the phase before them ends."""
        reached = _reached(problem)
        return _Following(self.duration, reached) if reached else self

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Interpolate between the ends."""
        first, last = self._ends(phase, index)
        duration = guessed_duration(phase, self.duration)
        robot, nz = phase.robot, len(phase.dae.algebraic)
        low, high = phase.duration_bounds
        law = fastest_line(phase, first, last) if low < high else None

        def states(s: Array) -> Array:
            s = np.asarray(s)
            values = first + s[:, None] * (last - first)
            if robot is not None:
                nq = robot.nq
                chart = Chart.around(robot.model, first[:nq])
                start, end = chart.coordinates(np.array([first[:nq], last[:nq]]))
                place, pace, _ = (s, np.ones_like(s), s) if law is None else law.motion(s)
                y = start + place[:, None] * (end - start)
                values[:, :nq] = chart.positions(y)
                if duration > 0:
                    inside = (s > 0) & (s < 1)
                    rate = pace[inside, None] * (end - start) / duration
                    values[inside, nq : nq + robot.nv] = chart.velocities(y[inside], rate)
            return values

        def algebraic(s: Array) -> Array:
            values = np.zeros((len(s), nz))
            if law is not None and duration > 0 and phase.body.algebraic:
                n = phase.robot.nv  # type: ignore[union-attr]
                values[:, :n] = law.motion(s)[2][:, None] * (last - first)[:n] / duration**2
            return values

        return PhaseGuess(duration, states, algebraic, constant(len(phase.dae.controls)), default_parameters(phase))

    def _ends(self, phase: Phase, index: int) -> tuple[Array, Array]:
        return ends_of(phase)


@dataclass(frozen=True, eq=False)
class _Following(StraightLine):
    """Straight lines, and where phases begin whose states links alone say: by their index."""

    reached: Mapping[int, Array] = field(default_factory=dict)

    def prepared(self, problem: Problem) -> Guess:
        return self

    def _ends(self, phase: Phase, index: int) -> tuple[Array, Array]:
        return ends_of(phase, self.reached.get(index))


def _reached(problem: Problem) -> dict[int, Array]:
    """States that ``Continuity`` and ``Jump`` bring to phases of systems, by the index of the phase."""
    from robotraj.problem.links.continuity import Continuity, Jump

    phases, found = problem.phases, dict[int, Array]()
    joints = [link for link in problem.links if isinstance(link, Continuity | Jump)]
    for link in sorted(joints, key=lambda link: link.second % len(phases)):
        source, target = link.first % len(phases), link.second % len(phases)
        if phases[source].robot is not None or phases[target].robot is not None:
            continue
        _, last = ends_of(phases[source], found.get(source))
        jumps = link.jumps if isinstance(link, Jump) else {}
        given = [jumps.get(state.name, 0.0) for state in phases[target].body.states]
        known = np.array([float(jump) if isinstance(jump, Real) else 0.0 for jump in given])
        found[target] = last[: len(given)] + known
    return found


@dataclass(frozen=True)
class FromSolution(Guess):
    """Start from an earlier solution, on whatever mesh and scheme; variables are matched by name."""

    solution: Any

    def __post_init__(self) -> None:
        if not _is_solution(self.solution):
            raise InputError(f"FromSolution starts from a Solution; got {type(self.solution).__name__}.")

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the earlier solution's phase of the same index.

        Raises
        ------
        InputError
            The earlier solution has no such phase, or none of its states.
        """
        known = self.solution.phases
        if index >= len(known):
            raise InputError(f"The guess is a solution of {len(known)} phases; phase {phase.name!r} is number {index}.")
        source = known[index]
        given, wanted = ([v.name for v in each.dae.states] for each in (source.phase, phase))
        if not set(given) & set(wanted):
            raise InputError(
                f"The guess has none of the states of phase {phase.name!r}: it is a motion of {', '.join(given)}, "
                f"not of {', '.join(wanted)}. Start from a solution of the same robot or system, or from "
                "rt.guess.StraightLine()."
            )
        low, high = phase.duration_bounds
        fallback = default_parameters(phase)
        return PhaseGuess(
            float(np.clip(source.duration, low, high)),
            _sampled(source, phase.dae.states),
            _sampled(source, phase.dae.algebraic),
            _sampled(source, phase.dae.controls),
            {name: source.parameters.get(name, value) for name, value in fallback.items()},
        )

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Impulses of the earlier solution's link of the same index."""
        known = self.solution.impulses
        return known[index] if index < len(known) else {}


def as_guess(value: Any) -> Guess | None:
    """Accept a guess, an earlier solution or None."""
    if value is None or isinstance(value, Guess):
        return value
    if _is_solution(value):
        return FromSolution(value)
    raise InputError(
        f"guess must be None, a guess such as rt.guess.StraightLine(), or a Solution; got {type(value).__name__}."
    )


def _is_solution(value: Any) -> bool:
    return hasattr(value, "phases") and hasattr(value, "status")


def _sampled(source: Any, variables: Sequence[Variable]) -> Curve:
    def curve(s: Array) -> Array:
        times = source.t0 + np.asarray(s) * source.duration
        columns = source.columns(times, [v.name for v in variables])
        return np.column_stack(columns) if columns else np.zeros((len(times), 0))

    return curve


def constant(size: int) -> Curve:
    """Give zeros (m, size)."""
    return lambda s: np.zeros((len(s), size))


def default_parameters(phase: Phase) -> dict[str, float]:
    """Middle of each parameter's bounds, or its finite bound, or 1."""
    values = middle_of(phase.parameter_bounds, 1.0)
    return dict(zip(phase.parameter_names, (float(v) for v in values), strict=True))


def middle_of(bounds: Bounds, free: float) -> Array:
    """Middle of finite bounds, the finite one of two, or ``free``."""
    low, high = bounds
    with np.errstate(invalid="ignore"):
        middle = np.where(
            np.isfinite(low) & np.isfinite(high), 0.5 * (low + high), np.where(np.isfinite(low), low, high)
        )
    return np.where(np.isfinite(middle), middle, free)


def ends_of(phase: Phase, reached: Array | None = None) -> tuple[Array, Array]:
    """States at both ends; one takes from the other what it leaves free, else what was reached, neutral poses or 0."""
    rest = np.zeros(len(phase.dae.states))
    if reached is not None:
        rest[: len(reached)] = reached
    if phase.robot is not None:
        rest[: phase.robot.nq] = phase.robot.neutral
    first, last = middle_of(phase.start_bounds, np.nan), middle_of(phase.end_bounds, np.nan)
    first = np.where(np.isnan(first), np.where(np.isnan(last), rest, last), first)
    last = np.where(np.isnan(last), first, last)
    return turned(phase, first), turned(phase, last)


def turned(phase: Phase, x: Array) -> Array:
    """Scale the quaternion of a guessed state to length 1; the neutral one where nothing is known of it."""
    robot = phase.robot
    if robot is None or robot.root != "floating":
        return x
    x = np.array(x)
    size = np.linalg.norm(x[QUATERNION])
    x[QUATERNION] = x[QUATERNION] / size if size > 0 else robot.neutral[QUATERNION]
    return x


def guessed_duration(phase: Phase, given: float | None) -> float:
    """Duration to start from [s]: the given one, or one from the bounds, at least 1.5 times a straight line's least.

    Shorter guesses break limits everywhere, and the solver has to find that out first; longer ones cost few iterations.
    The least time is that of ``fastest_line``, or of the speed limits where those of torques say nothing.

    Raises
    ------
    InputError
        The given duration lies outside the phase's bounds.
    """
    low, high = phase.duration_bounds
    if given is not None:
        if not low <= given <= high:
            raise InputError(f"The guessed duration {given} s of phase {phase.name!r} lies outside {low} to {high} s.")
        return given
    if low == high:
        return low
    if low > 0:
        guess = np.sqrt(low * high) if np.isfinite(high) else 2 * low
    else:
        guess = min(max(1.0, high / 20), high / 2) if np.isfinite(high) else 1.0
    law = fastest_line(phase, *ends_of(phase))
    if law is not None:
        guess = max(guess, SLOWER * law.duration)
    elif phase.robot is not None and isinstance(phase.limits, Limits):
        first, last = (x[: phase.robot.nq] for x in ends_of(phase))
        gaps = np.abs(way(phase.robot.model, first, last))
        guess = max(guess, SLOWER * float(np.max(gaps / phase.limits.velocity, initial=0.0)))
    return float(np.clip(guess, low, high))
