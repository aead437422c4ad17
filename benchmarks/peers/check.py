"""Quality of a plan, computed outside the tool that made it: limits between knots, goal, open-loop simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp
from tasks import Task

PIECES = 40
"""Pieces of a motion that are simulated on their own."""
COARSE = slice(0, None, 5)
"""Five of the 21 samples of an interval: they fix a control of degree four or less."""


def excess(values: np.ndarray, lower: Any, upper: Any) -> float:
    """Largest excess over a limit, relative to half the range between the limits."""
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    limited = np.isfinite(lower) & np.isfinite(upper)
    if not limited.any():
        return 0.0
    low, high, x = lower[limited], upper[limited], values.reshape(-1, values.shape[-1])[:, limited]
    return float(np.max(np.maximum(x - high, low - x) / ((high - low) / 2)).clip(0))


def judge(task: Task, urdf: Path, samples: Any) -> dict[str, float]:
    """Figures of one plan.

    Returns
    -------
    dict
        objective of the interpolant, over ...: largest excess over a limit relative to it, goal: distance of the last
        state from the goal, local error: of pieces simulated one by one, drift: of an open-loop simulation from the
        last planned state (largest entries, SI).
    """
    t, q, v, u = (samples[name] for name in "tqvu")
    lengths = t[:, -1] - t[:, 0]
    weights = np.array([7, 32, 12, 32, 7]) / 90  # Boole's rule: exact for squares of quadratics
    effort = float(np.einsum("k,j,kji->", lengths, weights, u[:, COARSE] ** 2))
    speed = np.array(task.velocity)
    motors = np.array(task.effort)
    last = np.r_[q[-1, -1], v[-1, -1]]
    rest = np.zeros(len(task.joints))
    return {
        "objective": effort if task.objective == "effort" else float(t[-1, -1] - t[0, 0]),
        "over position": excess(q, *task.position),
        "over speed": excess(v, -speed, speed),
        "over torque": excess(u, -motors, motors),
        "goal": float(np.max(np.abs(last - np.r_[task.end, rest]))),
        "local error": local_error(task, urdf, t, q, v, u),
        "drift": float(np.max(np.abs(simulate(task, urdf, t, q, v, u) - last))),
    }


def simulate(task: Task, urdf: Path, t: Any, q: Any, v: Any, u: Any) -> np.ndarray:
    """Integrate Pinocchio's forward dynamics under the planned controls, open loop; give the last state."""
    return _through(task, pin.buildModelFromUrdf(str(urdf)), np.r_[q[0, 0], v[0, 0]], t, u)


def local_error(task: Task, urdf: Path, t: Any, q: Any, v: Any, u: Any) -> float:
    """Largest error of a piece of the motion, simulated from the planned state at its start, relative to 1 + |state|.

    A piece is as many intervals as make up a fortieth of the motion, and one where intervals are longer.
    """
    model = pin.buildModelFromUrdf(str(urdf))
    ends = t[:, -1] - t[0, 0]
    whole = np.searchsorted(ends, np.linspace(0, ends[-1], PIECES + 1)[1:] * (1 - 1e-9))
    first, worst = 0, 0.0
    for last in dict.fromkeys(whole.tolist()):
        chosen = slice(first, last + 1)
        found = _through(task, model, np.r_[q[first, 0], v[first, 0]], t[chosen], u[chosen])
        planned = np.r_[q[last, -1], v[last, -1]]
        worst = max(worst, float(np.max(np.abs(found - planned) / (1 + np.abs(planned)))))
        first = last + 1
    return worst


def _through(task: Task, model: pin.Model, x: np.ndarray, t: Any, u: Any) -> np.ndarray:
    """Integrate through intervals."""
    data, nq = model.createData(), model.nv
    damping, tau = model.damping, np.zeros(model.nv)
    motors = list(task.actuated)
    for times, controls in zip(t, u, strict=True):
        h = times[-1] - times[0]
        fit = np.polyfit(np.linspace(0, 1, 5), controls[COARSE], 4)

        def rate(s: float, x: np.ndarray, fit: np.ndarray = fit, h: float = h) -> np.ndarray:
            tau[motors] = np.array([np.polyval(fit[:, i], s) for i in range(fit.shape[1])])
            return h * np.r_[x[nq:], pin.aba(model, data, x[:nq], x[nq:], tau - damping * x[nq:])]

        x = solve_ivp(rate, (0.0, 1.0), x, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    return x
