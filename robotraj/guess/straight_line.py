"""The straight line from start to end: the default guess."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from numbers import Real

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.guess.ends import default_parameters, ends_of, guessed_duration
from robotraj.guess.least_time import fastest_line
from robotraj.guess.reaching.branches import reached_ends
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess, zeros
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.chart import Chart


@dataclass(frozen=True)
class StraightLine(InitialGuess):
    """States on a straight line from start to end, with zero controls.

    The velocities of a robot are the rate of the line, (q_end - q_start) / T, so that positions and velocities are
    consistent. At the ends the velocities are those of the problem. The origin of a floating root moves on the line,
    and the root turns at a constant rate about one axis. Its velocities are in its own axes. Compared with velocities
    on a separate line, this halves the iterations, and minimum-time problems do not collapse to zero duration.

    If the duration is free and limits bound the accelerations of all joints, the fastest motion along the line is
    stretched to T. Let s be from 0 to 1 along the line. The limits of speeds, accelerations and torques give bounds
    s' <= s'_max and abs(s'') <= k. From rest to rest the least time is 1 / p + p / k, p = min(s'_max, sqrt(k)).
    Source: Lynch and Park, Modern Robotics (2017), section 9.2.

    A state of a system that is free at both ends of a phase keeps the value at which ``rt.Continuity`` or
    ``rt.links.Jump`` starts the phase.

    Constraints such as ``rt.AtEnd(rt.FramePose(...))`` may determine the positions of an arm at an end. Inverse
    kinematics from many seeds then computes them. Of the branches, the line ends at those that the slowest joint
    reaches first.

    Parameters
    ----------
    duration : float, optional
        Guessed duration [s] where it is free; by default from the bounds, and at least 1.5 times the least time.
    branch : int
        Rank of the branches of inverse kinematics, 0 for the fastest; further ranks are other starts.
    """

    duration: float | None = None
    branch: int = 0

    def prepared(self, problem: Problem) -> InitialGuess:
        """Compute the first states of phases of systems from links, and the ends that constraints determine."""
        entered, ends = _entered_states(problem), reached_ends(problem, self.branch)
        return _LinkedLine(self.duration, self.branch, entered, ends) if entered or ends else self

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Interpolate between the ends."""
        first, last = self._ends(phase, index)
        duration = guessed_duration(phase, self.duration, (first, last))
        nz = len(phase.dae.algebraic)
        robot = phase.state_robot
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
            if robot is not None and law is not None and duration > 0 and phase.body.algebraic:
                n = robot.nv
                values[:, :n] = law.motion(s)[2][:, None] * (last - first)[:n] / duration**2
            return values

        return PhaseGuess(duration, states, algebraic, zeros(len(phase.dae.controls)), default_parameters(phase))

    def _ends(self, phase: Phase, index: int) -> tuple[Array, Array]:
        return ends_of(phase)


@dataclass(frozen=True, eq=False)
class _LinkedLine(StraightLine):
    """Straight lines between known ends.

    Attributes
    ----------
    entered : mapping of int to ndarray
        First states that follow from links, by the index of the phase.
    reached : mapping of int to (ndarray, ndarray)
        Positions at the start and the end, by the index of the phase; NaN where they are unknown.
    """

    entered: Mapping[int, Array] = field(default_factory=dict)
    reached: Mapping[int, tuple[Array, Array]] = field(default_factory=dict)

    def prepared(self, problem: Problem) -> InitialGuess:
        return self

    def _ends(self, phase: Phase, index: int) -> tuple[Array, Array]:
        return ends_of(phase, self.entered.get(index), self.reached.get(index))


def _entered_states(problem: Problem) -> dict[int, Array]:
    """Return the first states of phases of systems that ``Continuity`` and ``Jump`` determine, by index of phase."""
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
