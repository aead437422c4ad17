"""Budgets of work and limits of power and effort that contradict the energy of two given states, whatever lies between.

The work of the motors changes the energy of a robot E(q, v) and covers its losses. Between given states, with damping
d, dry friction f tanh(v / v_s) and travels D_j of the joints in the time T,

    W = int tau' v dt = E_1 - E_0 + losses,    losses >= sum_j (d_j D_j^2 / T + f_j (D_j - 0.2785 v_s T)+),

since int v^2 dt >= D^2 / T and |v| (1 - tanh(|v| / v_s)) <= 0.2785 v_s. A rate r >= c tau' v, such as the sum of all
|tau_j v_j|, integrates to c W at least. Drawn states and torques give c, which must be the same at all sizes of power.

Motors of limited powers P_j do the work T sum_j P_j at most. Motors of limited efforts F_j do, less the losses,

    T sum_j h_j(s_j),    h_j(s) = (F_j - f_j) s - d_j s^2 + 0.2785 f_j v_s

at most, with s_j >= D_j / T the mean of |v_j|, since h_j is concave. It grows with T, since h_j(0) >= 0.

The stated values suffice for the straight motion at rest at both ends, if nothing else limits it. On a coarse mesh
torques that oscillate between the points seem to need less, so that a solve would not find the conflict.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import cast

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.precision import MET, SAMPLES
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import ForwardRigidBody, InverseRigidBody
from robotraj.guess.ends import default_parameters
from robotraj.guess.joint_motion import joint_motion
from robotraj.problem.constraints.motors.drive import MotorPower
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.problem import Problem
from robotraj.robot.coupling.dynamics import kinetic_energy, potential_energy
from robotraj.robot.robot import Robot
from robotraj.robot.tangent import difference
from robotraj.solution.conflict import NOTICED, ROOM_OF_DURATION, Conflict, with_room

SIZES = (1e-2, 1.0, 1e2)
"""Sizes of the speeds and torques that are drawn [SI]."""
DRAWN = 64
"""Number of states with all joints moving that are drawn for each size."""
SMOOTHED = 0.27847
"""Largest value of x (1 - tanh(x))."""


def exceeded_budgets(problem: Problem) -> tuple[Conflict, ...]:
    """Return the rows of work, power and effort that contradict the balance of energy, the largest excess first."""
    found = [conflict for phase in problem.phases for conflict in _exceeded(phase)]
    return tuple(sorted(found, key=lambda conflict: -conflict.relative))


def _exceeded(phase: Phase) -> Iterator[Conflict]:
    robot, body = phase.robot, phase.body
    powers = [(n, each) for n, each in enumerate(phase.rows.constraints) if isinstance(each.source, MotorPower)]
    if robot is None or phase.contacts or phase.design or phase.path is not None:
        return
    size = robot.nq + robot.nv
    ends = [np.array([each.lower[:size], each.upper[:size]], dtype=float) for each in phase.joint_ends.values()]
    given = all(np.array_equal(*end) and np.isfinite(end).all() for end in ends)
    if not given or type(body) not in (ForwardRigidBody, InverseRigidBody):
        return
    (begin, _), (end, _) = ends
    gain, losses = _work(robot, begin, end, phase.duration_bounds[1])
    for row in phase.rows.integrals:
        yield from _exceeded_budget(phase, row, begin, end, gain, losses)
    for constraint, _ in powers:
        rows = [row for row in phase.rows if row.constraint == constraint]
        if _exceed_powers(robot, rows, gain, losses, phase.duration_bounds[1]):
            yield from _needed_values(phase, rows, begin, end, gain, losses)
    if gain > _greatest_gain(phase, begin, end):
        rows = [row for row in phase.rows.throughout if row.variable in _names("tau", robot.actuated)]
        yield from _needed_values(phase, rows, begin, end, gain, losses)


def _exceeded_budget(
    phase: Phase, row: PhaseRow, begin: Array, end: Array, gain: float, losses: float
) -> Iterator[Conflict]:
    """Yield the conflict of a budget that the work between both ends exceeds."""
    robot = phase.robot
    assert robot is not None
    for sign, bound in ((1.0, row.upper), (-1.0, -row.lower)):
        low, high = _ratios(phase, row, sign) if np.isfinite(bound) else (np.nan, np.nan)
        if not low <= high + MET * abs(high):
            continue
        # Every factor between both ratios bounds the rate; losses above their least need one above zero.
        factor = high if gain + losses > 0.0 else low
        if factor < 0.0 and np.any((robot.damping, robot.friction)):
            continue
        least = factor * (gain + losses)
        if least - bound > NOTICED * max(abs(bound), abs(least)):
            times, rates = _straight(phase, (row,), begin, end)
            along = sign * np.trapezoid(rates[:, 0], times) if len(times) else -np.inf
            enough = sign * max(least, float(along))
            yield _conflict(phase, row, phase.duration_bounds[1], sign * bound, enough, _reason(gain, losses))


def _exceed_powers(robot: Robot, rows: Sequence[PhaseRow], gain: float, losses: float, longest: float) -> bool:
    """Whether the motors do less work within their limits of power than the ends take."""
    of_joints = {row.joint: row.upper for row in rows if row.joint is not None}
    each = sum(of_joints[joint] for joint in robot.actuated) if set(robot.actuated) <= set(of_joints) else np.inf
    together = min((row.upper for row in rows if row.joint is None), default=np.inf)
    work = gain + losses
    too_much = work - min(each, together) * longest > NOTICED * abs(work)
    lossless = not np.any((robot.damping, robot.friction))
    return bool(too_much or (lossless and -gain - each * longest > NOTICED * abs(gain)))


def _greatest_gain(phase: Phase, begin: Array, end: Array) -> float:
    """Bound the work that motors of limited efforts do between two states, less the losses [J]."""
    robot, longest = phase.robot, phase.duration_bounds[1]
    assert robot is not None
    driven = np.isin(robot.velocity_names, robot.actuated)
    effort, fastest = np.where(driven, _sizes(phase, "tau"), 0.0), _sizes(phase, "v")
    if not np.isfinite(effort).all() or not 0.0 < longest < np.inf:
        return np.inf
    spare, damping = effort - robot.friction, robot.damping
    damped = damping > 0.0
    best = np.where(spare > 0.0, np.inf, 0.0)
    best[damped] = 0.5 * spare[damped] / damping[damped]
    speeds = np.maximum(
        np.minimum(best, fastest), np.abs(difference(robot.model, begin[: robot.nq], end[: robot.nq])) / longest
    )
    if not np.isfinite(speeds).all():
        return np.inf
    most = spare * speeds - damping * speeds**2 + SMOOTHED * robot.friction * robot.friction_speed
    return float(longest * most.sum() + NOTICED * longest * np.abs(most).sum())


def _sizes(phase: Phase, quantity: str) -> Array:
    """Return the largest size that a quantity of each joint may have in a phase, (nv,); inf without a limit."""
    robot = phase.robot
    assert robot is not None
    names, sizes = _names(quantity, robot.velocity_names), np.full(robot.nv, np.inf)
    for row in phase.rows.throughout:
        if row.variable in names:
            k = names.index(row.variable)
            sizes[k] = min(sizes[k], max(abs(row.lower), abs(row.upper)))
    return sizes


def _names(quantity: str, joints: Sequence[str]) -> list[str]:
    return [f"{quantity}.{joint}" for joint in joints]


def _needed_values(
    phase: Phase, rows: Sequence[PhaseRow], begin: Array, end: Array, gain: float, losses: float
) -> Iterator[Conflict]:
    """Yield the limits of power or effort that the straight motion exceeds, with those that it needs."""
    times, values = _straight(phase, rows, begin, end)
    if not len(times):
        return
    for row, along in zip(rows, values.T, strict=True):
        excess = np.maximum(along - row.upper, row.lower - along)
        worst = int(np.argmax(excess))
        if excess[worst] > 0.0:
            bound = row.upper if along[worst] > 0.0 else row.lower
            yield _conflict(phase, row, float(times[worst]), bound, float(along[worst]), _reason(gain, losses))


def _reason(gain: float, losses: float) -> str:
    """State the energy that both ends differ by, and the losses."""
    lost = f", and friction takes at least {losses:.4g} J" if losses > NOTICED * abs(gain) else ""
    return f"the end has {abs(gain):.4g} J {'more' if gain >= 0.0 else 'less'} energy than the start{lost}"


def _conflict(phase: Phase, row: PhaseRow, time: float, bound: float, enough: float, reason: str) -> Conflict:
    """Describe a row, and a bound that suffices."""
    needed = with_room(bound, enough, ROOM_OF_DURATION)
    relative = abs(needed - bound) / max(abs(bound), NOTICED * abs(needed))
    return Conflict(phase.name, row.label, time, bound, needed, row.unit, relative, False, reason, True)


def _work(robot: Robot, begin: Array, end: Array, longest: float) -> tuple[float, float]:
    """Return the gain of energy between two states, and the least losses [J]."""
    model, data, nq = robot.model, robot.model.createData(), robot.nq

    def energy(x: Array) -> float:
        stored = potential_energy(model, data, x[:nq]) + robot.spring_energy(x[:nq])
        return kinetic_energy(model, data, x[:nq], x[nq:]) + stored

    travels = np.abs(difference(model, begin[:nq], end[:nq]))
    losses = np.zeros(robot.nv)
    if np.isfinite(longest) and longest > 0.0:
        slow = SMOOTHED * robot.friction_speed * longest
        losses = robot.damping * travels**2 / longest + robot.friction * np.maximum(travels - slow, 0.0)
    return energy(end) - energy(begin), float(losses.sum())


def _ratios(phase: Phase, row: PhaseRow, sign: float) -> tuple[float, float]:
    """Return the greatest ratio of ``sign`` times the rate to a power below zero, and the least one to one above zero.

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
            ratio = np.where(work == 0.0, np.nan, sign * rate / work)
        if not np.isfinite(ratio[work != 0.0]).all() or not (work < 0.0).any() or not (work > 0.0).any():
            return np.nan, np.nan
        found.append((ratio[work < 0.0].max(), ratio[work > 0.0].min()))
    low, high = np.array(found).T
    alike = all(np.ptp(each) <= MET * np.abs(each).max() for each in (low, high))
    return (float(low[0]), float(high[0])) if alike else (np.nan, np.nan)


def _straight(phase: Phase, rows: Sequence[PhaseRow], begin: Array, end: Array) -> tuple[Array, Array]:
    """Return times (m,) and values of rows (m, rows) along the cubic motion from rest to rest; none for other ends."""
    robot, duration = phase.robot, phase.duration_bounds[1]
    assert robot is not None
    nq = robot.nq
    if robot.nu != robot.nv or begin[nq:].any() or end[nq:].any() or not np.isfinite(duration):
        return np.zeros(0), np.zeros((0, len(rows)))
    step = difference(robot.model, begin[:nq], end[:nq])

    def cubic(s: Array) -> tuple[Array, Array, Array]:
        place = np.array([pin.integrate(robot.model, begin[:nq], each * step) for each in 3.0 * s**2 - 2.0 * s**3])
        speed = 6.0 * (s - s**2) / duration
        return place, np.outer(speed, step), np.outer(6.0 * (1.0 - 2.0 * s) / duration**2, step)

    parameters = default_parameters(phase)
    guess = joint_motion(phase, duration, cubic, parameters)
    s = np.linspace(0.0, 1.0, SAMPLES)
    values = (guess.states(s), guess.algebraic(s), guess.controls(s))
    return duration * s, phase.rows.sample(rows, duration * s, *values, np.array(list(parameters.values())))
