"""A plan run through several times: every period displaced from the last, and mirrored if the plan is half a gait.

The plan's closing link says how its start x_0 sees its end x_T: x_0 = P x_T + d, with P a permutation with signs (the
identity, or left and right swapped). So the next period starts where the last one ended if it follows
F(x) = P' (x - d), the one after F(F(x)), and so on.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from robotraj.design import realised
from robotraj.errors import InputError
from robotraj.links import Mirror, Periodic
from robotraj.witness.protocols import Array, SolutionLike

QUATERNION = slice(3, 7)
"""Where q of a free-flyer at the root holds the quaternion."""


@dataclass(frozen=True)
class Return:
    """How the start of a plan sees its end: q_0 = P q_T + d, v_0 = P_v v_T.

    Attributes
    ----------
    positions : ndarray (nq, nq)
        P.
    shift : ndarray (nq,)
        d [m, rad]; zero for a quaternion.
    velocities : ndarray (nv, nv)
        P_v.
    partners : mapping of str to str
        Contacts, or their frames, that change places.
    """

    positions: Array
    shift: Array
    velocities: Array
    partners: Mapping[str, str] = field(default_factory=dict)

    def onwards(self, q: Array) -> Array:
        """Position (..., nq) as it is a period later."""
        return (q - self.shift) @ self.positions


class Passage(NamedTuple):
    """One phase of one period.

    Attributes
    ----------
    phase : int
    period : int
    begin : float
        When it starts, counted from the start of the first period [s].
    """

    phase: int
    period: int
    begin: float


class Reference(NamedTuple):
    """The plan at some times, in the coordinates of the plan: q (m, nq), v (m, nv), tau (m, nu)."""

    q: Array
    v: Array
    tau: Array


class Course:
    """What is to be followed.

    Parameters
    ----------
    solution : Solution
        Of a robot.
    periods : int or None
        How often; None: three times if the plan is periodic, else once.

    Attributes
    ----------
    robot : Robot
        In plain numbers.
    phases : tuple of PhaseSolution
    periods : int
    closing : Return or None
        How the plan closes on itself, None if it does not.

    Raises
    ------
    InputError
        The solution moves a System, or robots that differ between phases; several periods of a plan that does not
        end as it starts.
    """

    def __init__(self, solution: SolutionLike, periods: int | None = None) -> None:
        self.phases = tuple(solution.phases)
        robots = [planned.phase.robot for planned in self.phases]
        if not robots or any(robot is None for robot in robots):
            raise InputError("second_opinion() simulates robots; use validate() for Systems.")
        self.robot = realised(self.phases[0])
        names = list(self.robot.model.names)
        if any(list(robot.model.names) != names for robot in robots):
            raise InputError("The phases move different robots; second_opinion() follows one robot.")
        self.closing = _closing(solution)
        self.periods = _count(periods, self.closing)
        self.floating = self.robot.model.nq > self.robot.model.nv

    @property
    def starts(self) -> tuple[float, ...]:
        """Start of each phase [s]."""
        return tuple(float(planned.knots[0]) for planned in self.phases)

    @property
    def durations(self) -> tuple[float, ...]:
        """Duration of each phase [s]."""
        return tuple(float(planned.knots[-1] - planned.knots[0]) for planned in self.phases)

    @property
    def passages(self) -> Iterator[Passage]:
        """All phases of all periods, in the order they are passed through."""
        begin = 0.0
        for period in range(self.periods):
            for phase, duration in enumerate(self.durations):
                yield Passage(phase, period, begin)
                begin += duration

    def reference(self, phase: int, times: Array) -> Reference:
        """Sample a phase at times (m,) since its start [s]."""
        planned, start, duration = self.phases[phase], self.starts[phase], self.durations[phase]
        sample = planned.at(start + np.clip(times, 0.0, duration))
        return Reference(self._unit(sample.q), np.asarray(sample.v), np.asarray(sample.tau))

    def onwards(self, q: Array, v: Array, periods: int) -> tuple[Array, Array]:
        """Positions (..., nq) and velocities (..., nv) of the plan as they are ``periods`` later."""
        for _ in range(periods):
            q, v = self._return.onwards(q), v @ self._return.velocities
        return self._unit(q), v

    def torques_onwards(self, tau: Array, periods: int) -> Array:
        """Torques (..., nu) of the plan as they are ``periods`` later."""
        return tau @ self._torques(periods)

    def gains_onwards(self, gains: Array, periods: int) -> Array:
        """Gains (..., nu, 2 nv) of the plan as they are ``periods`` later."""
        if periods == 0:
            return gains
        moved = np.linalg.matrix_power(self._return.velocities, periods)
        return np.asarray(self._torques(periods).T @ gains @ np.kron(np.eye(2), moved))

    def foot_onwards(self, name: str, periods: int) -> tuple[str, Array]:
        """Contact that stands for another one ``periods`` later, and the signs (3,) of its force."""
        if not self.mirrored(periods):
            return name, np.ones(3)
        return self._return.partners.get(name, name), np.array([1.0, -1.0, 1.0])

    def _torques(self, periods: int) -> Array:
        """Matrix (nu, nu) from torques (rows) of the plan to those ``periods`` later."""
        actuation = np.asarray(self.robot.actuation, dtype=float)
        once = np.eye(actuation.shape[1]) if periods == 0 else actuation.T @ self._return.velocities @ actuation
        return np.linalg.matrix_power(once, periods)

    def mirrored(self, periods: int) -> bool:
        """Whether left and right are swapped after so many periods."""
        return (
            bool(periods % 2)
            and self.closing is not None
            and not np.array_equal(self.closing.velocities, np.eye(self.robot.model.nv))
        )

    @property
    def _return(self) -> Return:
        assert self.closing is not None, "a plan that does not close on itself is followed once"
        return self.closing

    def _unit(self, q: Array) -> Array:
        q = np.array(q, dtype=float)
        if self.floating:
            q[..., QUATERNION] /= np.linalg.norm(q[..., QUATERNION], axis=-1, keepdims=True)
        return q


def _count(periods: int | None, closing: Return | None) -> int:
    if periods is None:
        return 1 if closing is None else 3
    if not isinstance(periods, int) or isinstance(periods, bool) or periods < 1:
        raise InputError(f"periods = {periods!r}; give a whole number, 1 or more.")
    if periods > 1 and closing is None:
        raise InputError(
            f"periods = {periods}, but the plan ends elsewhere than it starts: no rt.Periodic, rt.Mirror or "
            "rt.Touchdown(repeat=...) closes it. Follow it once."
        )
    return periods


def _closing(solution: SolutionLike) -> Return | None:
    """Find the link from the last phase to the first, and how far the plan gets in a period."""
    phases = solution.phases
    for link in getattr(solution.problem, "links", ()):
        if isinstance(link, Periodic | Mirror):
            repeat, first, last = link, link.first, link.last
        elif getattr(link, "repeat", None) is not None:
            repeat, first, last = link.repeat, link.second, link.first
        else:
            continue
        if first % len(phases) == 0 and last % len(phases) == len(phases) - 1:
            return _read(repeat, phases[0], phases[-1])
    return None


def _read(repeat: Periodic | Mirror, opening: Any, closing: Any) -> Return:
    """Write a repetition as matrices."""
    model = opening.phase.robot.model
    nq, nv = model.nq, model.nv
    names = [state.name for state in opening.phase.body.states][: nq + nv]
    seen = repeat.of(closing.phase, names, type(repeat).__name__)
    matrix = np.zeros((nq + nv, nq + nv))
    for row, (source, sign) in enumerate(seen.sources[: nq + nv]):
        matrix[row, names.index(source)] = sign
    positions = matrix[:nq, :nq]
    start, end = opening.at(opening.knots[0]), closing.at(closing.knots[-1])
    shift = np.asarray(start.q) - positions @ np.asarray(end.q)
    if nq > nv:
        shift[QUATERNION] = 0.0
    return Return(positions, shift, matrix[nq:, nq:], seen.partners)
