"""Budgets of work that the motion between two given states exceeds, whatever its course.

The work of the motors changes the energy of a robot E(q, v) and covers its losses. Between given states, with damping
d, dry friction f tanh(v / v_s) and travels D_j of the joints in the time T,

    W = int tau' v dt = E_1 - E_0 + losses,    losses >= sum_j (d_j D_j^2 / T + f_j (D_j - 0.2785 v_s T)+),

since int v^2 dt >= D^2 / T and |v| (1 - tanh(|v| / v_s)) <= 0.2785 v_s. A rate r >= c tau' v, such as the sum of all
|tau_j v_j|, integrates to c W at least. Drawn states and torques tell c: it is the same at all sizes of the power.

The stated budget suffices for the straight motion at rest at both ends, if nothing else limits it. On a coarse mesh
torques that oscillate between the points seem to need less, so that a solve would not find the conflict.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import ForwardRigidBody, InverseRigidBody
from robotraj.guess.ends import default_parameters
from robotraj.guess.joint_motion import joint_motion
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.tangent import difference
from robotraj.solution.conflict import Conflict, with_room

Array = NDArray[np.float64]

SIZES = (1e-2, 1.0, 1e2)
"""Sizes of the speeds and torques that are drawn [SI]."""
DRAWN = 64
"""Number of states with all joints moving that are drawn for each size."""
ALIKE = 1e-6
"""Relative difference of ratios that are equal."""
EXCEEDED = 1e-3
"""Excess relative to the budget or to the work that counts."""
SMOOTHED = 0.27847
"""Largest value of x (1 - tanh(x))."""
ROOM_OF_WORK = 4e-2
"""What a stated budget leaves beyond the work of the straight motion, since tight budgets need fine meshes."""
TIMES = 201
"""Number of times at which the rate along the straight motion is integrated."""


def exceeded_budgets(problem: Problem) -> tuple[Conflict, ...]:
    """Return the integrals whose bounds contradict the balance of energy, the largest relative excess first."""
    found = [conflict for phase in problem.phases for conflict in _exceeded(phase)]
    return tuple(sorted(found, key=lambda conflict: -conflict.relative))


def _exceeded(phase: Phase) -> Iterator[Conflict]:
    robot, body, table = phase.robot, phase.body, phase.rows
    if not table.integrals or robot is None or phase.contacts or phase.design or phase.path is not None:
        return
    size = robot.nq + robot.nv
    ends = [np.array([each.lower[:size], each.upper[:size]], dtype=float) for each in phase.joint_ends.values()]
    given = all(np.array_equal(*end) and np.isfinite(end).all() for end in ends)
    if not given or type(body) not in (ForwardRigidBody, InverseRigidBody):
        return
    (begin, _), (end, _) = ends
    gain, losses = _work(robot, begin, end, phase.duration_bounds[1])
    for row in table.integrals:
        ratios = _ratios(phase, row)
        for sign, bound in ((1.0, row.upper), (-1.0, -row.lower)):
            low, high = ratios if sign > 0.0 else (-ratios[1], -ratios[0])
            if not np.isfinite(bound) or not low <= high + ALIKE * abs(high):
                continue
            # Every factor between both ratios bounds the rate; losses above their least need one above zero.
            factor = high if gain + losses > 0.0 else low
            if factor < 0.0 and np.any((robot.damping, robot.friction)):
                continue
            least = factor * (gain + losses)
            if least - bound > EXCEEDED * max(abs(bound), abs(least)):
                enough = max(least, sign * _straight(phase, row, begin, end))
                yield _conflict(phase, row, sign * bound, sign * enough, gain, losses)


def _conflict(phase: Phase, row: PhaseRow, bound: float, enough: float, gain: float, losses: float) -> Conflict:
    """Describe a budget, and one that suffices."""
    lost = f", and friction takes at least {losses:.4g} J" if losses > EXCEEDED * abs(gain) else ""
    more, size = ("more" if gain >= 0.0 else "less"), abs(gain)
    reason = f"the end has {size:.4g} J {more} energy than the start{lost}"
    needed = with_room(bound, enough, ROOM_OF_WORK)
    relative = abs(needed - bound) / max(abs(bound), EXCEEDED * abs(needed))
    time = phase.duration_bounds[1]
    return Conflict(phase.name, row.label, time, bound, needed, row.unit, relative, False, reason, True)


def _work(robot: Robot, begin: Array, end: Array, longest: float) -> tuple[float, float]:
    """Return the gain of energy between two states, and the least losses [J]."""
    model, data, nq = robot.model, robot.model.createData(), robot.nq

    def energy(x: Array) -> float:
        inertia = np.triu(pin.crba(model, data, x[:nq]))
        inertia += np.triu(inertia, 1).T
        return float(0.5 * x[nq:] @ inertia @ x[nq:] + pin.computePotentialEnergy(model, data, x[:nq]))

    travels = np.abs(difference(model, begin[:nq], end[:nq]))
    losses = np.zeros(robot.nv)
    if np.isfinite(longest) and longest > 0.0:
        slow = SMOOTHED * robot.friction_speed * longest
        losses = robot.damping * travels**2 / longest + robot.friction * np.maximum(travels - slow, 0.0)
    return energy(end) - energy(begin), float(losses.sum())


def _ratios(phase: Phase, row: PhaseRow) -> tuple[float, float]:
    """Return the greatest ratio of the rate to a power below zero, and the least one to a power above zero.

    Both are NaN unless they are the same for powers of all sizes.
    """
    table, rng = phase.rows, np.random.default_rng(0)
    robot = phase.robot
    assert robot is not None
    index = [robot.velocity_names.index(joint) for joint in robot.actuated]
    point = cast(RobotPoint, table.point)
    power = sum(point.tau[k] * point.v[i] for k, i in enumerate(index))
    evaluate = ca.Function("rate", list(table.symbols), [ca.vertcat(table.expressions((row,))[0], power)])
    found = []
    for size in SIZES:
        # One joint after the other moves either way, then all.
        alone = np.repeat(np.eye(robot.nv), 2, axis=0)
        count = len(alone) + DRAWN
        columns = [rng.normal(size=(symbol.numel(), count)) for symbol in table.symbols]
        moving = size * np.vstack([alone * rng.normal(size=alone.shape), rng.normal(size=(DRAWN, robot.nv))])
        columns[1][robot.nq : robot.nq + robot.nv] = moving.T
        columns[3] *= size
        rate, work = np.array(evaluate(*columns))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(work == 0.0, np.nan, rate / work)
        if not np.isfinite(ratio[work != 0.0]).all() or not (work < 0.0).any() or not (work > 0.0).any():
            return np.nan, np.nan
        found.append((ratio[work < 0.0].max(), ratio[work > 0.0].min()))
    low, high = np.array(found).T
    alike = all(np.ptp(each) <= ALIKE * np.abs(each).max() for each in (low, high))
    return (float(low[0]), float(high[0])) if alike else (np.nan, np.nan)


def _straight(phase: Phase, row: PhaseRow, begin: Array, end: Array) -> float:
    """Return the integral along the cubic motion from rest to rest; minus infinity where it says nothing."""
    robot, duration = phase.robot, phase.duration_bounds[1]
    assert robot is not None
    nq = robot.nq
    if robot.nu != robot.nv or begin[nq:].any() or end[nq:].any() or not np.isfinite(duration):
        return -np.inf
    step = difference(robot.model, begin[:nq], end[:nq])

    def cubic(s: Array) -> tuple[Array, Array, Array]:
        place = np.array([pin.integrate(robot.model, begin[:nq], each * step) for each in 3.0 * s**2 - 2.0 * s**3])
        speed = 6.0 * (s - s**2) / duration
        return place, np.outer(speed, step), np.outer(6.0 * (1.0 - 2.0 * s) / duration**2, step)

    parameters = default_parameters(phase)
    guess = joint_motion(phase, duration, cubic, parameters)
    s = np.linspace(0.0, 1.0, TIMES)
    values = (guess.states(s), guess.algebraic(s), guess.controls(s))
    rates = phase.rows.sample((row,), duration * s, *values, np.array(list(parameters.values())))[:, 0]
    return float(np.trapezoid(rates, duration * s))
