"""opty's midpoint collocation on the tasks with short equations, compiled as by its default."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import sympy as sm
from opty import Problem, create_objective_function
from report import SAMPLES, Clock, Report, inside, requested_task
from tasks import Task

t, h = sm.symbols("t, h", real=True)
G = 9.81


def equations(task: Task, q: list[Any], v: list[Any], u: list[Any]) -> list[Any]:
    """Newton's equations, zero where they hold; their mass matrix is left unsolved."""
    a = [rate.diff(t) for rate in v]
    if task.urdf == "block":
        return [a[0] - u[0]]
    s, c = sm.sin(q[1]), sm.cos(q[1])
    if task.urdf == "cartpole":
        cart, pole, length = 1.0, 0.3, 0.5
        return [
            (cart + pole) * a[0] + pole * length * (c * a[1] - s * v[1] ** 2) - u[0],
            length * a[1] + c * a[0] + G * s,
        ]
    rod, half = 1 / 3, 0.5
    off, lower = rod + half * c, half * G * sm.sin(q[0] + q[1])
    return [
        (2 * rod + 1 + 2 * half * c) * a[0] + off * a[1]
        - half * s * v[1] * (2 * v[0] + v[1]) + (1 + half) * G * sm.sin(q[0]) + lower,
        off * a[0] + rod * a[1] + half * s * v[0] ** 2 + lower - u[0],
    ]  # fmt: skip


def solve(task: Task) -> None:
    """Transcribe, solve, report."""
    nq, nu, nodes = len(task.joints), len(task.actuated), task.intervals + 1
    least, most = task.durations
    free = most > least
    q, v, u = ([sm.Function(f"{name}{i}")(t) for i in range(n)] for name, n in (("q", nq), ("v", nq), ("u", nu)))
    motion = sm.Matrix([a.diff(t) - b for a, b in zip(q, v, strict=True)] + equations(task, q, v, u))
    step: Any = h if free else least / task.intervals
    end = (nodes - 1) * h if free else least
    start = 0 * h if free else 0.0
    ends = [x.subs(t, start) - value for x, value in zip(q + v, (*task.start, *[0.0] * nq), strict=True)]
    ends += [x.subs(t, end) - value for x, value in zip(q + v, (*task.end, *[0.0] * nq), strict=True)]
    limits = [*zip(*task.position, strict=True), *((-s, s) for s in task.velocity), *((-e, e) for e in task.effort)]
    bounds = {x: pair for x, pair in zip(q + v + u, limits, strict=True) if np.isfinite(pair).all()}
    if free:
        bounds[h] = (least / task.intervals, most / task.intervals)

        def cost(found: np.ndarray) -> float:
            return float(task.intervals * found[-1])

        def gradient(found: np.ndarray) -> np.ndarray:
            slope = np.zeros_like(found)
            slope[-1] = task.intervals
            return slope
    else:
        effort = sm.Integral(sum(x**2 for x in u), t)
        cost, gradient = create_objective_function(effort, q + v, u, (), nodes, step, "midpoint", t)
    problem = Problem(
        cost, gradient, motion, q + v, nodes, step,
        instance_constraints=ends, bounds=bounds, time_symbol=t, integration_method="midpoint",
        backend=os.environ["PEERS_BACKEND"],
    )  # fmt: skip
    for name, value in (("print_level", 0), ("sb", "yes"), ("max_cpu_time", 120.0), ("max_iter", 3000)):
        problem.add_option(name, value)
    line = np.linspace(np.r_[task.start, np.zeros(nq)], np.r_[task.end, np.zeros(nq)], nodes).T
    guess = np.r_[line.ravel(), np.zeros(nu * nodes), [task.guess / task.intervals] * free]
    with Clock() as clock:
        found, info = problem.solve(guess)
    solved = info["status"] in (0, 1)
    report = Report((clock.wall, clock.processor), len(problem.obj_value) - 1, solved, info["status_msg"].decode())
    total = task.intervals * found[-1] if free else least
    x = found[: 2 * nq * nodes].reshape(2 * nq, nodes).T
    controls = found[2 * nq * nodes : (2 * nq + nu) * nodes].reshape(nu, nodes).T
    # What was collocated: at the middle of an interval, states on lines and the mean of its controls.
    s = np.linspace(0, 1, SAMPLES)[None, :, None]
    states = x[:-1, None] * (1 - s) + x[1:, None] * s
    held = np.repeat((controls[:-1, None] + controls[1:, None]) / 2, SAMPLES, axis=1)
    report.write(inside(np.linspace(0, total, nodes)), states[..., :nq], states[..., nq:], held)


if __name__ == "__main__":
    solve(requested_task())
