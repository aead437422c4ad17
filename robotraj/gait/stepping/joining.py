"""Motions from rest into a planned gait, and from a planned gait to rest."""

from __future__ import annotations

from robotraj.gait.bounds.upright import Upright
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.stepping.joined_gait import PlannedGait, joined_gait
from robotraj.gait.supports import Support
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.problem.state import State


def start(
    gait: PlannedGait,
    *,
    count: int = 2,
    shift: float | None = None,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = None,
) -> Problem:
    """Return a motion from rest into a planned gait: ``count`` of its periods, the first one shorter.

    The robot starts in the configuration of ``rt.gait.stand``, placed above the standing feet of the first period. It
    ends in the first state of the gait, or in the state before the impact if the gait begins with one. In a single
    period the standing feet do not move, so the robot starts with these feet on their footholds of the gait. Of two
    point feet the other one then starts where the fall into the gait begins (``gait.stepping.capture``), else beside
    them. The sequence of standing feet and the durations are those of the gait.

    Parameters
    ----------
    gait : Solution
        Solution of ``rt.gait.walk``, ``run``, ``trot`` or ``crawl`` on level ground.
    count : int
        Number of periods; a period of a mirrored gait is one step. Give runs on two point feet two steps.
    shift : float
        Duration on all feet at rest [s]; by default 1.4 sqrt(h / g), h the height of the centre of mass at rest.
    clearance, objective, upright
        As for ``rt.gait.walk``; the objective is that of the gait by default. Of a gait that was planned with
        ``clearance=None``, such as that of a walker without knees, feet may pass through the ground here too.

    Raises
    ------
    InputError
        The motion does not repeat, its ground is not level, or a count or duration is not positive. Or the robot
        cannot stand on the footholds of a single period.
    """
    cycle = joined_gait(gait, count, "rt.gait.start")
    supports = [Support(cycle.feet, cycle.rest(shift, "start"), "stand")]
    for k in range(count):
        supports += cycle.period(k - count)
    away = State(q=cycle.resting(-count, last=False, held=count == 1), v=0.0)
    q, v = cycle.entry
    return sequence(cycle.robot, supports, cycle.terms(clearance, objective, upright), None, away, State(q=q, v=v))


def stop(
    gait: PlannedGait,
    *,
    count: int = 2,
    shift: float | None = None,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = None,
) -> Problem:
    """Return a motion from a planned gait to rest: ``count`` of its periods, the last one shorter.

    The robot starts in the first state of the gait. It ends at rest in the configuration of ``rt.gait.stand``, placed
    above the standing feet of the last period. In a single period these feet stay on their footholds of the gait, and
    of two point feet the other one lands where it stops the fall. Parameters and errors are those of ``start``.
    """
    cycle = joined_gait(gait, count, "rt.gait.stop")
    supports = [support for k in range(count) for support in cycle.period(k)]
    supports.append(Support(cycle.feet, cycle.rest(shift, "stop"), "stop"))
    first = gait.at(0.0)
    # The first state determines the first footholds.
    begin = State(q=first.q, v=first.v)
    home = State(q=cycle.resting(count - 1, last=True, held=count == 1), v=0.0)
    return sequence(cycle.robot, supports, cycle.terms(clearance, objective, upright), None, begin, home)
