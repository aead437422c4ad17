"""Planned motions at lower speed and stops on their way, along the path that was planned."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj.dynamics.path_body import ACCELERATION, SPEED
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.planning.plan import plan
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint, symbols_of
from robotraj.problem.constraints.bounds import BoundsLike, between
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.constraints.joint_limits import JointAcceleration, JointEffort, JointVelocity
from robotraj.problem.constraints.motors.rates import JointJerk, RateLimit
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.proof import Goals
from robotraj.solution.settings import Restarts
from robotraj.solution.solution import Solution
from robotraj.solvers.interior_point import InteriorPoint

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import PlanOptions

LONGEST = 1e3
"""Upper bound of the duration of a stop [s]."""
NO_WIDTH = 1e-8
"""Part of a motion below which an interval counts as none."""
SLOWEST = 1e-3
"""Least share of the speed."""
RESTING = 1e-6
"""Largest dq/ds at the end of a path over time at which its joints rest there [rad/s, m/s].

Also the largest share of a plan's speeds at which it rests, and a stop has no duration.
"""
WIDER = 1.0 + Goals().excess
"""Factor of the limits of a stop: a proof lets a plan exceed its limits by this, so a stop must begin there."""


def override(solution: Solution, speed: float, **options: Unpack[PlanOptions]) -> Solution:
    """Plan the same motion at a share of its speed, as the speed override of a controller does.

    The joints pass the positions q(s) of the plan with ds/dt <= speed in the least time. Where all limits hold, this
    is q(speed t): speeds are ``speed``, accelerations ``speed^2`` and jerks ``speed^3`` times those of the plan.
    Torques are those of inverse dynamics at the new speed. The result is a plan like any other, proved by default.

    Parameters
    ----------
    solution : Solution
        A plan of robots with a fixed root and a motor at every joint.
    speed : float
        In (0, 1].
    **options
        Of ``rt.plan``.

    Returns
    -------
    Solution
        With the phases of the plan; a dwell takes longer too. Their limits hold, and their constraints that depend on
        speeds, accelerations or torques. Constraints on positions hold because the path is the same.

    Raises
    ------
    InputError
        The speed is outside its range, or a phase moves a System, or has contacts or another form of dynamics.
    NoSolutionFound
        The limits forbid a lower speed, for example because a joint cannot hold its weight on the path.

    Examples
    --------
    >>> slow = rt.override(solution, 0.1)  # doctest: +SKIP
    """
    if not (is_number(speed) and SLOWEST <= speed <= 1.0):
        percent = f" {speed:g} percent are {0.01 * speed:g}." if is_number(speed) and 1.0 < speed <= 100.0 else ""
        raise InputError(f"The speed of an override is a number between {SLOWEST:g} and 1; got {speed!r}.{percent}")
    phases = []
    for part in solution.phases:
        follow = FollowPath(_over_time(part), None, None, speed=float(speed))
        phases.append(_on_path(part.phase, follow, 10.0 * part.duration / speed))
    links = [Continuity(k, k + 1) for k in range(len(phases) - 1)]
    return plan(Problem(phases, links), **options)


def stop_on_path(
    solution: Solution,
    time: float,
    *,
    limits: Limits | None = None,
    jerk: BoundsLike | float = None,
    **options: Unpack[PlanOptions],
) -> Solution:
    """Plan a stop of least time that stays on the path of a plan, from the plan's motion at a time.

    The robot leaves the plan at that time with its position and speed, and comes to rest in the least time, which is a
    local optimum like that of any plan. Under a limit of jerk or torque rate its acceleration is continuous there too.
    Where no stop before the end of the plan is found, the motion ends there. Time counts from the start of the stop.

    Parameters
    ----------
    solution : Solution
        A plan of robots with a fixed root and a motor at every joint.
    time : float
        Global time [s] within the plan.
    limits : Limits, optional
        Limits of the stop, such as larger torques of brakes; those of the phase by default. They count 1e-3 wider,
        since the proof of the plan allows this excess and the stop begins there.
    jerk : float, Between, sequence or mapping by joint, optional
        Limits of da/dt [rad/s^3, m/s^3] beside those of the phase. The acceleration of a plan without such a limit
        jumps, and may exceed what a limit allows at that time.
    **options
        Of ``rt.plan``.

    Returns
    -------
    Solution
        One phase. Constraints of the plan's phase at that time hold, as for ``rt.override``.

    Raises
    ------
    InputError
        The time is outside the plan or at an instant of rest, or the phase cannot follow a path as in ``rt.override``.
    NoSolutionFound
        The limits allow no stop on the path.

    Examples
    --------
    >>> halt = rt.stop_on_path(solution, 0.35, jerk=2000.0)  # doctest: +SKIP
    """
    first, last = solution.phases[0].t0, solution.phases[-1].t0 + solution.phases[-1].duration
    if not (is_number(time) and first <= time < last):
        raise InputError(f"The time of a stop is within the plan, from {first:g} s to before {last:g} s; got {time!r}.")
    number = max(i for i, part in enumerate(solution.phases) if part.t0 <= time)
    part = solution.phases[number]
    path = _remaining(solution, number).after(float(time))
    speeds = np.abs([path.derivative()(at) for at in path.breaks]).max(axis=-1)
    resting = np.flatnonzero(speeds <= RESTING * speeds.max()).tolist()
    if resting[:1] == [0]:
        raise InputError(f"At {time:g} s the plan is at rest, and there is nothing to stop; choose another time.")
    if resting:
        # No stop lies beyond an instant of rest, such as a dwell: where no joint moves, s is not determined.
        last = resting[0]
        path = PiecewisePolynomial(path.breaks[: last + 1], path.sites[:last], path.values[:last])
    given = part.phase if limits is None else part.phase.with_(limits=limits)
    more = () if jerk is None else (JointJerk(jerk),)
    follow = FollowPath(path, 1.0, 0.0, whole=False, start_acceleration=0.0)
    anywhere = _widened(_on_path(given, follow, LONGEST, more))
    # Beside jumps of the path's jerk Newton's method may circle for a thousand iterations.
    alone: PlanOptions = {"solver": InteriorPoint(tolerance=1e-6).at_most(PATIENCE), "restarts": Restarts(0)}
    alone.update(options)
    alone["check"] = False
    found = plan(anywhere, **alone)
    if found.proved or (found.success and found.proof is None):
        return found
    # The rest of the plan itself is a motion to the end, where the path over time rests at any ds/dt.
    to_the_end = replace(follow, whole=True, end_speed=None if resting else 0.0)
    whole = plan(_followed(anywhere, to_the_end), **(alone if found.success else options))
    return found if found.success and not whole.proved else whole


def _widened(phase: Phase) -> Phase:
    """Return the phase with limits in which the plan is, and not only nearly."""
    robot, limits = phase.robot, phase.limits
    assert robot is not None
    rates = [
        type(each)({joint: between(WIDER * low, WIDER * high) for joint, low, high in each.limited(robot)})
        if isinstance(each, RateLimit)
        else each
        for each in phase.constraints
    ]
    wider = limits.scaled(WIDER) if isinstance(limits, Limits) else None
    return phase.with_(limits=wider, constraints=rates)


def _followed(phase: Phase, follow: FollowPath) -> Phase:
    return phase.with_(constraints=[follow if isinstance(each, FollowPath) else each for each in phase.constraints])


def _over_time(part: PhaseSolution) -> PiecewisePolynomial:
    """Return the positions of the joints over time."""
    if part.phase.robot is None:
        raise InputError(f"Phase {part.phase.name!r} of the plan moves a System, which has no path of joints.")
    curve, count = part.joint_states, part.phase.robot.nq
    # Knots that moved to a switch leave intervals of no width, whose third derivatives are rounding.
    lengths = np.diff(curve.breaks)
    kept = np.flatnonzero(lengths > NO_WIDTH * lengths.sum()).tolist()
    breaks = np.append(curve.breaks[kept], curve.breaks[-1])
    breaks[0] = curve.breaks[0]
    return PiecewisePolynomial(breaks, [curve.sites[k] for k in kept], [curve.values[k][:, :count] for k in kept])


def _remaining(solution: Solution, number: int) -> PiecewisePolynomial:
    """Return the positions over time of a phase and of those that follow it with the same robot."""
    parts = list(solution.phases[number:])
    robot = parts[0].phase.robot
    count = next((i for i, part in enumerate(parts) if part.phase.robot is not robot), len(parts))
    curves = [_over_time(part) for part in parts[:count]]
    breaks = [curves[0].breaks[:1], *(curve.breaks[1:] for curve in curves)]
    return PiecewisePolynomial(
        np.concatenate(breaks),
        [each for curve in curves for each in curve.sites],
        [each for curve in curves for each in curve.values],
    )


def _on_path(phase: Phase, follow: FollowPath, longest: float, more: tuple[Constraint, ...] = ()) -> Phase:
    """Return the phase along the path, in least time."""
    if not isinstance(phase.dynamics, InverseDynamics):
        raise InputError(
            f"Phase {phase.name!r} has {type(phase.dynamics).__name__}(), which do not exist on a path; plan it with "
            "rt.dynamics.InverseDynamics()."
        )
    limits = phase.limits.with_(position=np.inf) if isinstance(phase.limits, Limits) else None
    alone = Phase(
        phase.subject,
        (0.0, longest),
        objective=Duration(),
        constraints=[follow],
        contacts=phase.contacts,
        parameters=phase.parameters,
        design=phase.design,
        limits=limits,
        name=phase.name,
        self_collision=phase.self_collision,
    )
    own = [
        kind({name[len(prefix) :]: bound for name, bound in bounds.items() if name.startswith(prefix)})
        for kind, prefix, bounds in (
            (JointVelocity, "v.", phase.states),
            (JointAcceleration, "a.", phase.algebraic),
            (JointEffort, "tau.", phase.controls),
        )
    ]
    kept = [each for each in (*own, *phase.constraints) if _depends_on_timing(each, alone)]
    return alone.with_(constraints=[follow, *kept, *more])


def _depends_on_timing(constraint: Constraint, on_path: Phase) -> bool:
    """Whether a constraint of the plan applies along its path: it is no equation, and not on positions alone."""
    if isinstance(constraint, FollowPath | AtStart | AtEnd):
        return False
    if constraint.avoids_collisions or isinstance(constraint, RateLimit):
        return True
    bound = constraint.bind(on_path.body, on_path.parameter_names)
    point = symbols_of(on_path.body, on_path.parameter_names)
    value = ca.vertcat(*bound.expression(point))
    timing = ca.vertcat(point.extra[SPEED], point.extra[ACCELERATION])
    limits_rows = bool(bound.rows) and all(row.lower < row.upper for row in bound.rows)
    return limits_rows and bool(ca.depends_on(value, timing))
