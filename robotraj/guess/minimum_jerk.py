"""Minimum-jerk motions from start to end, through waypoints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.guess.along_path import check_no_path
from robotraj.guess.ends import default_parameters, ends_of, guessed_duration
from robotraj.guess.joint_motion import fractions_of, joint_motion, quintic, speeds_of
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess, zeros
from robotraj.problem.phase import Phase
from robotraj.robot.chart import Chart


@dataclass(frozen=True)
class MinimumJerk(InitialGuess):
    """The motion of least integrated squared jerk from start to end, through waypoints.

    From rest to rest without waypoints, q = q_0 + (q_1 - q_0) (10 s^3 - 15 s^4 + 6 s^5), s the fraction of
    the phase. The end velocities are those of the problem, the end accelerations are zero. Velocities and
    accelerations of a robot are the rates of the curve, and its torques are those of the inverse dynamics. The guess
    therefore satisfies the equations of motion if all joints have motors. Each state of a System follows such a curve
    from rest to rest, with zero controls.

    Parameters
    ----------
    waypoints : sequence, optional
        Positions between start and end, each a sequence or a mapping by joint name (others are neutral); for a System,
        states.
    fractions : sequence of float, optional
        Places of start, waypoints and end in the phase, ascending from 0 to 1; by default in proportion to the time
        between them at the speed limits.
    duration : float, optional
        Guessed duration [s] where it is free.
    """

    waypoints: Sequence[ArrayLike | Mapping[str, float]] = ()
    fractions: Sequence[float] | None = None
    duration: float | None = None

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Interpolate between the ends of a phase.

        Raises
        ------
        InputError
            A waypoint has a wrong size or an unknown name, or the fractions do not fit the waypoints.
        """
        check_no_path(phase, "MinimumJerk")
        if phase.robot is None:
            return self._of_system(phase)
        robot = phase.robot
        middle = [robot.configuration(value, f"waypoint {i}") for i, value in enumerate(self.waypoints)]
        return through(phase, middle, self.fractions, self.duration, "MinimumJerk")

    def _of_system(self, phase: Phase) -> PhaseGuess:
        first, last = ends_of(phase)
        names = [s.name for s in phase.body.states]
        middle = []
        for value in self.waypoints:
            row = first.copy()
            if isinstance(value, Mapping):
                row[: len(names)] = [value[n] for n in names]
            else:
                row[: len(names)] = np.asarray(value, dtype=float)
            middle.append(row)
        keys = np.array([first, *middle, last])
        rest = np.zeros(keys.shape[1])
        fractions = fractions_of(self.fractions, keys, np.full(keys.shape[1], np.inf), "MinimumJerk")
        return PhaseGuess(
            guessed_duration(phase, self.duration),
            quintic(fractions, keys, rest, rest),
            zeros(len(phase.dae.algebraic)),
            zeros(len(phase.dae.controls)),
            default_parameters(phase),
        )


def through(
    phase: Phase,
    waypoints: Sequence[Array],
    fractions: Sequence[float] | None,
    duration: float | None,
    what: str,
    end: Array | None = None,
) -> PhaseGuess:
    """Return a robot's minimum-jerk motion through joint positions; ``end`` replaces the end of the phase."""
    robot = phase.robot
    assert robot is not None
    nq, nx = robot.nq, robot.nq + robot.nv
    first, last = ends_of(phase)
    time = guessed_duration(phase, duration)
    pace = time if time > 0 else 1.0
    chart = Chart.around(robot.model, first[:nq])
    keys = chart.coordinates(np.array([first[:nq], *waypoints, last[:nq] if end is None else end]))
    at = fractions_of(fractions, keys, speeds_of(phase, robot), what)
    ends = chart.slopes(keys[0], first[nq:nx]) * pace, chart.slopes(keys[-1], last[nq:nx]) * pace
    y = quintic(at, keys, *ends)
    rate, second = y.derivative(1), y.derivative(2)

    def motion(s: Array) -> tuple[Array, Array, Array]:
        at_s, speed, acceleration = y(s), rate(s) / pace, second(s) / pace**2
        return chart.positions(at_s), chart.velocities(at_s, speed), chart.accelerations(at_s, speed, acceleration)

    return joint_motion(phase, time, motion, default_parameters(phase))
