"""The inverted pendulum: the default guess of robots that walk, run and jump."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from itertools import accumulate, pairwise

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.curves.splines import through
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.guess.ends import default_parameters
from robotraj.guess.legs.footsteps import Footsteps
from robotraj.guess.legs.given_ends import GivenEnds
from robotraj.guess.legs.schedule import schedule_of
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.support import support
from robotraj.problem.initial_guess import Curve, InitialGuess, PhaseGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.chart import Chart
from robotraj.robot.root import QUATERNION

KEYS = 11
"""Number of configurations of a phase that inverse kinematics computes; splines interpolate them."""
LANDING = 0.02
"""Guessed impulse of a touchdown, as a fraction of the robot's weight times one second."""


@dataclass(frozen=True)
class InvertedPendulum(InitialGuess):
    """A linear inverted pendulum above the scheduled feet, with legs by inverse kinematics.

    This is the default guess of problems in which a robot with a free root stands on contacts. The contacts of the
    phases give the schedule of the feet; the links give the repetition and the displacement. A foothold is under the
    position of the hip halfway through the stance (Raibert, Legged Robots That Balance, 1986). Swinging feet move on
    arcs. Velocities and accelerations are the rates of a spline through the configurations, on the manifold of a
    floating root. Contact forces and torques balance that motion in the least-squares sense.

    Parameters
    ----------
    height : float, optional
        Height of the centre of mass above the feet [m]; by default that of ``rt.gait.stand``.
    apex : float, optional
        Apex of swinging feet [m]. By default it is the largest of three values: a twentieth of that height, the rise of
        the centre of mass in flight, and 1.2 times an ``apex`` of the clearances.
    durations : mapping of int to float
        Guessed durations [s] of phases whose duration is free.
    """

    height: float | None = None
    apex: float | None = None
    durations: Mapping[int, float] = field(default_factory=dict)

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the guess of a problem of this phase alone."""
        return self.prepared(Problem([phase])).of(phase, 0)

    def prepared(self, problem: Problem) -> InitialGuess:
        """Compute the schedule, the footholds and the pendulum of the whole problem.

        Raises
        ------
        InputError
            The problem moves no robot with a free root, or no phase has contacts with the ground.
        """
        robot = problem.phases[0].robot
        if robot is None or robot.root == "fixed":
            raise InputError("InvertedPendulum needs a robot with root='floating' or root='planar'; use another guess.")
        schedule = schedule_of(problem, self.durations)
        if not any(contact.stands for contact in schedule.contacts):
            raise InputError("InvertedPendulum needs contacts with the ground, but no phase has any.")
        stance = BalancedStance(robot, schedule.contacts)
        return _ScheduledMotion(Footsteps(problem, schedule, stance, self.height, self.apex))


@dataclass(frozen=True, eq=False)
class _ScheduledMotion(InitialGuess):
    """The motion of one problem."""

    steps: Footsteps

    @property
    def _stance(self) -> BalancedStance:
        return self.steps.stance

    @cached_property
    def _keys(self) -> list[Array]:
        """Return the configurations of every phase, (KEYS, nq) each."""
        q, found, turn = self.steps.home, [], self.steps.somersault
        for start, end in pairwise(self.steps.schedule.times):
            times = np.linspace(start, end, KEYS)
            if turn is not None and turn.start == start:
                last = self._reached(q, end)
                rows = [self._reached(q, start), *(self._turning(q, last, t) for t in times[1:-1]), last]
            else:
                rows = list(accumulate(times, self._reached, initial=q))[1:]
            q = rows[-1]
            found.append(np.array(rows))
        return found

    @cached_property
    def _given(self) -> GivenEnds:
        return GivenEnds(self.steps)

    def _reached(self, q: Array, t: float) -> Array:
        """Return the configuration (nq,) at a time [s] by inverse kinematics, near that of an earlier time."""
        (places, lifts), com = self.steps.feet(float(t)), self._given.com(float(t))
        if self._stance.robot.root == "planar":
            com[1] = np.nan
        near, posture = np.array(q), self._given.posture(float(t))
        near[0] += com[0] - pin.centerOfMass(self._stance.robot.model, self._stance.data, q)[0]
        if self.steps.somersault is not None or self.steps.heading(1.0):
            near[self._attitude] = posture[self._attitude]
        return self._stance.reach(near, places, com, lifts, posture)

    def _turning(self, first: Array, last: Array, t: float) -> Array:
        """Return the configuration (nq,) at a time of a somersault [s]: feet that turn have no places in the world."""
        turn = self.steps.somersault
        assert turn is not None
        share = (t - turn.start) / (turn.end - turn.start)
        q, joints = self._given.posture(t), slice(self._attitude.stop, None)
        q[joints] = first[joints] + share**2 * (3.0 - 2.0 * share) * (last - first)[joints]
        away = self._given.com(t) - pin.centerOfMass(self._stance.robot.model, self._stance.data, q)
        q[: self._attitude.start] += away[[0, 2]] if self._stance.robot.root == "planar" else away
        return q

    @property
    def _attitude(self) -> slice:
        """Return the entries of q that are the attitude of the root."""
        return QUATERNION if self._stance.robot.root == "floating" else slice(2, 3)

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return splines through the configurations of a phase."""
        keys, robot = self._keys[index], self._stance.robot
        duration = self.steps.schedule.times[index + 1] - self.steps.schedule.times[index]
        pace = duration if duration > 0 else 1.0
        fractions = np.linspace(0.0, 1.0, KEYS)
        chart = Chart.around(robot.model, keys[0])
        y = through(fractions, chart.coordinates(keys), 5)
        rate, second = y.derivative(1), y.derivative(2)
        motions: dict[str, Curve] = {
            "q": lambda s: chart.positions(y(s)),
            "v": lambda s: chart.velocities(y(s), rate(s) / pace),
            "a": lambda s: chart.accelerations(y(s), rate(s) / pace, second(s) / pace**2),
        }

        parameters = default_parameters(phase)
        middle, _ = self.steps.feet(0.5 * (self.steps.schedule.times[index] + self.steps.schedule.times[index + 1]))
        low, high = phase.parameter_bounds
        for name, least, most in zip(phase.parameter_names, low, high, strict=True):
            if name in middle:
                parameters[name] = float(np.clip(middle[name], least, most))
        held = [c.name for c in self.steps.schedule.contacts if c.name in self.steps.schedule.held[index]]
        loads = _loads(self._stance, held, [motion(fractions) for motion in motions.values()])

        def columns(variables: Sequence[Variable]) -> Curve:
            def curve(s: Array) -> Array:
                s, still = np.asarray(s, dtype=float), np.zeros(len(s))
                known: dict[str, Array] = {}
                for kind in motions.keys() & {x.name.partition(".")[0] for x in variables}:
                    names, values = robot.position_names if kind == "q" else robot.velocity_names, motions[kind](s)
                    known |= {f"{kind}.{n}": values[:, i] for i, n in enumerate(names)}
                known |= {x.name: np.interp(s, fractions, loads[x.name]) for x in variables if x.name in loads}
                return np.column_stack([known.get(x.name, still) for x in variables] or [np.zeros((len(s), 0))])

            return curve

        dae = phase.dae
        return PhaseGuess(duration, columns(dae.states), columns(dae.algebraic), columns(dae.controls), parameters)

    def of_link(self, link: BoundLink, index: int) -> dict[str, float]:
        """Return upward impulses, a small part of the weight times one second."""
        weight = pin.computeTotalMass(self._stance.robot.model) * float(
            np.linalg.norm(self._stance.robot.model.gravity.linear)
        )
        up = [unknown.name for unknown in link.unknowns if unknown.name.endswith(".z")]
        return {name: LANDING * weight / len(up) for name in up}


def _loads(stance: BalancedStance, held: Sequence[str], motion: Sequence[Array]) -> dict[str, Array]:
    """Return contact forces and torques (m,) by variable name, for samples of q, v and a (m, n)."""
    robot = stance.robot
    names = [force.name for contact in stance.contacts if contact.name in held for force in contact.forces]
    rows = [support(stance, held, *row) for row in zip(*motion, strict=True)]
    forces, torques = (np.array([row[k] for row in rows]) for k in (0, 1))
    return {name: forces[:, i] for i, name in enumerate(names)} | {
        f"tau.{joint}": torques[:, i] for i, joint in enumerate(robot.actuated)
    }
