"""Hermite-Simpson as one writes it by hand in CasADi's Opti: forward dynamics, limits at knots and midpoints of u."""

from __future__ import annotations

import math
from typing import Any

import casadi as ca
import numpy as np
from equations import rates_of
from report import Report, inside, requested_task
from tasks import Task


def solve(task: Task) -> None:
    """Transcribe, solve, report."""
    rates = rates_of(task)
    nq, nu, n = len(task.joints), len(task.actuated), task.intervals
    x, u = ca.SX.sym("x", 2 * nq), ca.SX.sym("u", nu)
    f = ca.Function("f", [x, u], [ca.vertcat(x[nq:], rates(x[:nq], x[nq:], u))])
    opti = ca.Opti()
    states, controls, middles = opti.variable(2 * nq, n + 1), opti.variable(nu, n + 1), opti.variable(nu, n)
    duration: Any = task.duration
    if isinstance(duration, tuple):
        duration = opti.variable()
        opti.subject_to(opti.bounded(*task.durations[:1], duration, *task.durations[1:]))
        opti.set_initial(duration, task.guess)
    h = duration / n
    slopes = [f(states[:, k], controls[:, k]) for k in range(n + 1)]
    effort = 0
    for k in range(n):
        middle = (states[:, k] + states[:, k + 1]) / 2 + h / 8 * (slopes[k] - slopes[k + 1])
        opti.subject_to(
            states[:, k + 1] == states[:, k] + h / 6 * (slopes[k] + 4 * f(middle, middles[:, k]) + slopes[k + 1])
        )
        effort += h / 6 * (ca.sumsqr(controls[:, k]) + 4 * ca.sumsqr(middles[:, k]) + ca.sumsqr(controls[:, k + 1]))
    rest = np.zeros(nq)
    opti.subject_to(states[:, 0] == np.r_[task.start, rest])
    opti.subject_to(states[:, n] == np.r_[task.end, rest])
    lower = [*task.position[0], *(-v for v in task.velocity)]
    upper = [*task.position[1], *task.velocity]
    for i, (low, high) in enumerate(zip(lower, upper, strict=True)):
        if math.isfinite(low):
            opti.subject_to(opti.bounded(low, states[i, :], high))
    for i, limit in enumerate(task.effort):
        opti.subject_to(opti.bounded(-limit, controls[i, :], limit))
        opti.subject_to(opti.bounded(-limit, middles[i, :], limit))
    opti.set_initial(states, np.linspace(np.r_[task.start, rest], np.r_[task.end, rest], n + 1).T)
    opti.minimize(effort if task.objective == "effort" else duration)
    opti.solver(
        "ipopt", {"print_time": False, "record_time": True}, {"print_level": 0, "sb": "yes", "max_cpu_time": 120.0}
    )
    solved, read = True, opti
    try:
        read = opti.solve()
    except RuntimeError:
        solved, read = False, opti.debug
    stats = opti.stats()
    values = [np.atleast_2d(read.value(part)) for part in (states, controls, middles)]
    total = float(read.value(duration))
    report = Report((stats["t_wall_total"], stats["t_proc_total"]), stats["iter_count"], solved, stats["return_status"])
    # The interpolant: cubic states that keep the knots' values and slopes, quadratic controls.
    xs, us, ms = (value.T for value in values)
    ds = np.array([np.array(f(a, b)).ravel() for a, b in zip(xs, us, strict=True)])
    t = inside(np.linspace(0, total, n + 1))
    s = np.linspace(0, 1, t.shape[1])[None, :, None]
    x0, x1, d0, d1 = (part[:, None, :] for part in (xs[:-1], xs[1:], ds[:-1] * total / n, ds[1:] * total / n))
    curve = x0 * (1 + 2 * s) * (1 - s) ** 2 + d0 * s * (1 - s) ** 2 + x1 * s**2 * (3 - 2 * s) + d1 * s**2 * (s - 1)
    u0, u1, um = us[:-1, None, :], us[1:, None, :], ms[:, None, :]
    control = u0 * (1 - s) * (1 - 2 * s) + 4 * um * s * (1 - s) + u1 * s * (2 * s - 1)
    report.write(t, curve[..., :nq], curve[..., nq:], control)


if __name__ == "__main__":
    solve(requested_task())
