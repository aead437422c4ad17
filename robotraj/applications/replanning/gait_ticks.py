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

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Scalar
from robotraj.gait.feet import foot_contact
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.posture import SHARE
from robotraj.gait.stepping.joined_gait import JoinedGait, joined_gait
from robotraj.gait.supports import Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import height_above
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.expressions import Mayer
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.solution.cycles.gait_cycles import CyclePhase, gait_cycles
from robotraj.solution.solution import Solution

ARRIVAL = 1000.0
"""Weight of the distance of the end from the gait, in posture costs of ``rt.gait.gait_objective`` times sqrt(h / g).

With 1, a horizon of half a second slows down, since the effort that it saves outweighs the distance.
"""


@dataclass(frozen=True)
class Arrival:
    """Squared distance of the end of a horizon from the state of the gait there, position along the ground left out.

    sum w (q - q*)^2 + (h / g) sum w (v - v*)^2,  w = 1 for angles and 1 / h^2 for the root's lengths, with the height h
    of the centre of mass. A quaternion's entries count four times, so that a small angle counts once.

    Attributes
    ----------
    q, v : tuple of float
        State of the gait.
    lengths : int
        Number of the root's lengths, which come first; the height is the last of them.
    height : float
        h [m].
    gravity : float
        g [m/s^2].
    """

    q: tuple[float, ...]
    v: tuple[float, ...]
    lengths: int
    height: float
    gravity: float

    def __call__(self, start: RobotPoint, end: RobotPoint) -> Scalar:
        """Evaluate the distance."""
        length = self.height**-2
        quaternion = range(3, 7) if self.lengths == 3 else ()
        of_q = length * (end.q[self.lengths - 1] - self.q[self.lengths - 1]) ** 2
        for i in range(self.lengths, len(self.q)):
            of_q += (4.0 if i in quaternion else 1.0) * (end.q[i] - self.q[i]) ** 2
        of_v = ca.SX(0)
        for i, each in enumerate(self.v):
            of_v += (length if i < self.lengths else 1.0) * (end.v[i] - each) ** 2
        return of_q + self.height / self.gravity * of_v


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
    stance : BalancedStance
        The contacts that hold now.
    q, v : ndarray (nq,), (nv,)
        State of the gait.
    problem : Problem
        The horizon.
    """

    phase: int
    t: float
    feet: tuple[str, ...]
    following: tuple[str, ...]
    stance: BalancedStance
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
    made: list[Tick] = []
    stances: dict[tuple[str, ...], BalancedStance] = {}
    robot, contact = cycle.joined.robot, cycle.joined.contact
    for number, phase in enumerate(cycle.phases):
        count = max(1, round(phase.duration / period))
        for k in range(count):
            elapsed = phase.duration * k / count
            supports = [cycle.support(number + i) for i in range(ahead + 1)]
            feet, following = supports[0].feet, supports[1].feet
            held = tuple(foot_contact(contact, foot).bound_to(robot) for foot in feet)
            stance = stances.setdefault(feet, BalancedStance(robot, held))
            # Between its knots the gait keeps its contacts to its own accuracy alone.
            q, v = touching(stance, *cycle.state(number, elapsed))
            supports[0] = replace(supports[0], duration=phase.duration - elapsed)
            problem = _horizon(cycle, supports, number + ahead, State(q=q, v=v))
            made.append(Tick(number, phase.t0 - cycle.phases[0].t0 + elapsed, feet, following, stance, q, v, problem))
    return tuple(made)


def _horizon(cycle: Cycle, supports: Sequence[Support], last: int, start: State) -> Problem:
    robot, stance = cycle.joined.robot, cycle.joined.stance
    problem = sequence(robot, supports, cycle.joined.terms(0.0, None, None), None, start)
    q, v = cycle.state(last, cycle.phases[last % len(cycle.phases)].duration)
    com = np.array(pin.centerOfMass(robot.model, stance.data, q))
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    height = height_above(stance, stance.locate(q), com)
    worth = (SHARE * pin.computeTotalMass(robot.model) * gravity * height) ** 2 * np.sqrt(height / gravity)
    lengths = 2 if robot.root == "planar" else 3
    arrival = Arrival(tuple(q.tolist()), tuple(v.tolist()), lengths, float(height), gravity)
    ending = replace(
        problem.phases[-1], objective=problem.phases[-1].objective + float(ARRIVAL * worth) * Mayer(arrival)
    )
    return replace(problem, phases=[*problem.phases[:-1], ending])


def touching(stance: BalancedStance, q: Array, v: Array) -> tuple[Array, Array]:
    """Return the nearest configuration with the feet on the ground, and the velocity after their impact.

    Newton steps of least norm put the feet on the ground. The velocity solves

        v - M^-1 J' (J M^-1 J')^-1 J v,

    of least kinetic energy of the change: measured feet are never quite at rest.

    Parameters
    ----------
    stance : BalancedStance
        The contacts that hold; there may be none.
    q, v : ndarray (nq,), (nv,)
    """
    if not stance.contacts:
        return q, v
    q = stance.settle(q, stance.locate(q), stance.lifted({}))
    jacobian, model = stance.jacobian(q), stance.robot.model
    mass = pin.crba(model, stance.data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    spread = np.linalg.solve(mass, jacobian.T)
    impulse = np.linalg.lstsq(jacobian @ spread, jacobian @ v, rcond=1e-9)[0]
    return q, np.asarray(v - spread @ impulse)
