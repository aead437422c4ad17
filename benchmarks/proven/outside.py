"""Judge a plan of a robot with a motor at every joint from outside: plain Pinocchio, NumPy, and the values of the plan.

The motion is cut into pieces. Each starts from the planned state and is driven by the planned torques. It is integrated
by fixed steps of Runge and Kutta's classical rule, which are halved until the ends agree. The end of a piece is then
compared with the plan. Limits of the URDF are read on a dense grid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj._util.arrays import Array

PIECES, LONGEST = 40, 0.1
"""Least number of pieces of a motion that are simulated on their own, and the greatest length of one [s].

Arms that hold light links upright amplify errors a hundred thousandfold in half a second."""
SAMPLES = 2001
"""Times at which limits are read."""
ALLOWED = 1e-3
"""Largest error of a piece, relative to 1 + |state|, and largest excess, relative to the limit."""
STEPS = (1, 4, 16, 64, 192)
"""Steps between two knots; where the last two do not agree, as with stiff friction, an implicit method takes over."""
AGREED = 1e-4
"""Difference of the ends of a piece below which its steps are short enough."""
UNBOUNDED = 1e20
"""Limits beyond this are none."""


@dataclass(frozen=True)
class Judgement:
    """Result of the check: the largest relative error of a piece, and the largest relative excess."""

    error: float
    excess: float

    @property
    def right(self) -> bool:
        """Whether the plan is a motion of the robot within its limits."""
        return self.error < ALLOWED and self.excess < ALLOWED


def judged(robot: rt.Robot, solution: rt.Solution) -> Judgement:
    """Judge a plan of one phase."""
    return Judgement(_error(robot, solution), _excess(robot, solution))


def _excess(robot: rt.Robot, solution: rt.Solution) -> float:
    model = robot.model
    sample = solution.at(np.linspace(0.0, solution.duration, SAMPLES))
    limits = (
        (sample.q, model.lowerPositionLimit, model.upperPositionLimit),
        (sample.v, -model.upperVelocityLimit, model.upperVelocityLimit),
        (sample.tau, -model.upperEffortLimit, model.upperEffortLimit),
    )
    worst = 0.0
    for values, lower, upper in limits:
        for column, low, high in zip(np.asarray(values).T, lower, upper, strict=True):
            size = max(abs(low), abs(high)) if high < UNBOUNDED else 1.0
            over = max(column.max() - high, low - column.min()) / max(size, 1e-9)
            worst = max(worst, over if np.isfinite(over) else 0.0)
    return float(worst)


def _error(robot: rt.Robot, solution: rt.Solution) -> float:
    count = max(PIECES, int(np.ceil(solution.duration / LONGEST)))
    times = np.linspace(0.0, solution.duration, count + 1)
    planned = solution.at(times)
    states = np.hstack([planned.q, planned.v])
    # Torques may bend or jump at knots: steps end there.
    spans = _distinct(np.concatenate([times, solution.knots]), 1e-9 * solution.duration)
    piece = np.minimum(np.searchsorted(times, 0.5 * (spans[:-1] + spans[1:])) - 1, count - 1)
    before = np.full_like(states[1:], np.inf)
    for steps in STEPS:
        torques = _torques(solution, spans, steps)
        ends = np.array(states[:-1])
        for number, of_span, length in zip(piece, torques, np.diff(spans) / steps, strict=True):
            ends[number] = _through(robot, ends[number], of_span, length)
        if np.max(np.abs(ends - before) / (1.0 + np.abs(ends))) < AGREED:
            break
        before = ends
    else:
        ends = np.array([_stiffly(robot, solution, states[k], times[k], times[k + 1]) for k in range(count)])
    return float(np.max(np.abs(ends - states[1:]) / (1.0 + np.abs(states[1:]))))


def _distinct(times: Array, apart: float) -> Array:
    times = np.sort(times)
    return times[np.append(True, np.diff(times) > apart)]


def _torques(solution: rt.Solution, spans: Array, steps: int) -> Array:
    """Sample torques at the ends and middles of all steps, just inside the spans, (spans, 2 steps + 1, joints)."""
    inside = np.linspace(0.0, 1.0, 2 * steps + 1)
    inside[0], inside[-1] = 1e-9, 1.0 - 1e-9
    at = spans[:-1, None] + np.diff(spans)[:, None] * inside
    return np.asarray(solution.at(at.ravel()).tau).reshape(*at.shape, -1)


def _rate(robot: rt.Robot, data: pin.Data, x: Array, tau: Array) -> Array:
    n = robot.model.nv
    v = x[n:]
    drag = robot.damping * v + robot.friction * np.tanh(v / robot.friction_speed)
    return np.concatenate([v, pin.aba(robot.model, data, x[:n], v, tau - drag)])


def _through(robot: rt.Robot, x: Array, torques: Array, step: float) -> Array:
    data = robot.model.createData()
    for k in range(0, len(torques) - 1, 2):
        first = _rate(robot, data, x, torques[k])
        second = _rate(robot, data, x + 0.5 * step * first, torques[k + 1])
        third = _rate(robot, data, x + 0.5 * step * second, torques[k + 1])
        last = _rate(robot, data, x + step * third, torques[k + 2])
        x = x + step / 6.0 * (first + 2.0 * second + 2.0 * third + last)
        if not np.all(np.abs(x) < 1e6):
            return np.full_like(x, np.inf)
    return x


def _stiffly(robot: rt.Robot, solution: rt.Solution, x: Array, start: float, end: float) -> Array:
    data = robot.model.createData()

    def rate(t: float, state: Array) -> Array:
        return _rate(robot, data, state, np.asarray(solution.at(min(max(t, 0.0), solution.duration)).tau))

    found = solve_ivp(rate, (start, end), x, method="LSODA", rtol=1e-8, atol=1e-9, max_step=(end - start) / 4)
    return np.asarray(found.y[:, -1])
