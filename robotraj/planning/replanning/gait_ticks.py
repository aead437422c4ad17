"""The horizons of a gait that moves: one for every instant of its period at which a control loop plans.

A horizon is the rest of the current phase and the phases after it. A step leaves it when it is done, and another one
enters at its end. The end is free. Its distance from the planned gait is part of the objective.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Scalar
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.posture import SHARE
from robotraj.gait.stepping.joined_gait import JoinedGait, joined_gait
from robotraj.gait.supports import Support
from robotraj.guess.legs.standing_posture import height_above
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.expressions import Mayer
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.solution.cycles.gait_cycles import CyclePhase, gait_cycles
from robotraj.solution.solution import Solution

Array = NDArray[np.float64]

ARRIVAL = 1000.0
"""Weight of the distance of the end from the gait, in posture costs of ``rt.gait.gait_objective`` times sqrt(h / g).

With 10, a horizon of half a second slows down, since the effort that it saves outweighs the distance.
"""


@dataclass(frozen=True)
class Arrival:
    """Squared distance of the end of a horizon from the state of the gait there, position along the ground left out.

    sum (q - q*)^2 + (h / g) sum (v - v*)^2, quaternions counted twice in each entry, so that a small angle counts once.

    Attributes
    ----------
    q, v : tuple of float
        State of the gait.
    skipped : int
        Number of coordinates along the ground, which come first.
    doubled : tuple of int
        Entries of a quaternion.
    pace : float
        h / g [s^2].
    """

    q: tuple[float, ...]
    v: tuple[float, ...]
    skipped: int
    doubled: tuple[int, ...]
    pace: float

    def __call__(self, start: RobotPoint, end: RobotPoint) -> Scalar:
        """Evaluate the distance."""
        weights = [4.0 if i in self.doubled else 1.0 for i in range(len(self.q))]
        places = range(self.skipped, len(self.q))
        of_q = sum((weights[i] * (end.q[i] - self.q[i]) ** 2 for i in places), ca.SX(0))
        return of_q + self.pace * sum(((end.v[i] - each) ** 2 for i, each in enumerate(self.v)), ca.SX(0))


@dataclass(frozen=True, eq=False)
class Tick:
    """One instant of the gait.

    Attributes
    ----------
    phase : int
        Number of the current phase in the cycle.
    t : float
        Time since the start of the cycle [s].
    feet, following : tuple of str
        Frames that stand now, and in the next phase.
    q, v : ndarray (nq,), (nv,)
        State of the gait.
    problem : Problem
        The horizon.
    """

    phase: int
    t: float
    feet: tuple[str, ...]
    following: tuple[str, ...]
    q: Array
    v: Array
    problem: Problem


@dataclass(frozen=True, eq=False)
class Cycle:
    """A planned gait until it repeats without a mirror."""

    gait: Solution
    joined: JoinedGait
    phases: tuple[CyclePhase, ...]

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return sum(phase.duration for phase in self.phases)

    def support(self, number: int) -> Support:
        """Return a phase, counted from the start of the cycle."""
        period, index = divmod(number, len(self.gait.phases))
        return self.joined.period(period)[index]

    def state(self, number: int, elapsed: float) -> tuple[Array, Array]:
        """Return configuration and velocity of the gait, after a time [s] in a phase; x of the first cycle."""
        phase = self.phases[number % len(self.phases)]
        sample = phase.at(phase.t0 + elapsed)
        return np.asarray(sample.q), np.asarray(sample.v)


def repeats(problem: Problem) -> bool:
    """Whether a link closes the problem to a gait of a robot."""
    return problem.phases[0].robot is not None and any(
        isinstance(getattr(link, "repeat", None) or link, Periodic | Mirror) for link in problem.links
    )


def cycle_of(gait: Solution) -> Cycle:
    """Return the cycle of a planned gait.

    Raises
    ------
    InputError
        The motion does not repeat, or its ground is not level.
    """
    joined = joined_gait(gait, 1, "rt.Replanner")
    once = gait_cycles(gait)
    whole = gait_cycles(gait, 2) if once.cycle_map is not None and once.cycle_map.mirrors else once
    return Cycle(gait, joined, whole.phases)


def ticks_of(cycle: Cycle, period: float, ahead: int) -> tuple[Tick, ...]:
    """Return the instants of a cycle, about every ``period`` [s].

    Their horizons have ``ahead`` phases after the current one.
    """
    made = []
    for number, phase in enumerate(cycle.phases):
        count = max(1, round(phase.duration / period))
        for k in range(count):
            elapsed = phase.duration * k / count
            q, v = cycle.state(number, elapsed)
            supports = [cycle.support(number + i) for i in range(ahead + 1)]
            feet, following = supports[0].feet, supports[1].feet
            supports[0] = replace(supports[0], duration=phase.duration - elapsed)
            problem = _horizon(cycle, supports, number + ahead, State(q=q, v=v))
            made.append(Tick(number, phase.t0 - cycle.phases[0].t0 + elapsed, feet, following, q, v, problem))
    return tuple(made)


def _horizon(cycle: Cycle, supports: Sequence[Support], last: int, start: State) -> Problem:
    robot, stance = cycle.joined.robot, cycle.joined.stance
    problem = sequence(robot, supports, cycle.joined.terms(0.0, None, None), None, start)
    planar = robot.root == "planar"
    q, v = cycle.state(last, cycle.phases[last % len(cycle.phases)].duration)
    com = np.array(pin.centerOfMass(robot.model, stance.data, q))
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    height = height_above(stance, stance.locate(q), com)
    pace = height / gravity
    worth = (SHARE * pin.computeTotalMass(robot.model) * gravity * height) ** 2 * np.sqrt(pace)
    arrival = Arrival(
        tuple(q.tolist()), tuple(v.tolist()), 1 if planar else 2, () if planar else (3, 4, 5, 6), float(pace)
    )
    ending = replace(
        problem.phases[-1], objective=problem.phases[-1].objective + float(ARRIVAL * worth) * Mayer(arrival)
    )
    return replace(problem, phases=[*problem.phases[:-1], ending])
