"""Cost per iteration against the number of intervals, and the straight line nearest to it.

Kelly's cart-pole by Hermite-Simpson on 50 to 800 intervals, ten iterations of IPOPT each. Processor time, the least of
several runs taken in turn, so that other work on the machine counts little. Run with
``python benchmarks/linearity.py``.
"""

from __future__ import annotations

import time
from typing import Any

import casadi as ca
import numpy as np

import robotraj as rt

INTERVALS = (50, 100, 200, 400, 800)
ITERATIONS = 10
RUNS = 9


def cartpole() -> rt.Problem:
    """Kelly, SIAM Review 59 (2017), section 6."""

    def rates(point: Any) -> list[ca.SX]:
        q, dq, u = point.x["q"], point.x["dq"], point.u["u"]
        s, c = ca.sin(q), ca.cos(q)
        d = 1 + 0.3 * s**2
        ddx = (u + 9.81 * 0.3 * c * s + 0.15 * s * dq**2) / d
        ddq = -(u * c + 1.3 * 9.81 * s + 0.15 * c * s * dq**2) / (0.5 * d)
        return [point.x["dx"], dq, ddx, ddq]

    system = rt.System(["x", "q", "dx", "dq"], ["u"], rates)
    ends = rt.State([0, 0, 0, 0]), rt.State([1, np.pi, 0, 0])
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    bounds = {"states": {"x": rt.between(-2, 2)}, "controls": {"u": rt.between(-20, 20)}}
    return rt.Problem([rt.Phase(system, 2.0, *ends, effort, **bounds)])


def main() -> None:
    problem = cartpole()
    solver = rt.Ipopt(max_iterations=ITERATIONS)
    build = np.full((RUNS, len(INTERVALS)), np.inf)
    iterate = np.full((RUNS, len(INTERVALS)), np.inf)
    for run in range(RUNS):
        for i, count in enumerate(INTERVALS):
            began = time.process_time()
            nlp = rt.transcribe(problem, rt.Mesh(count))
            _ = nlp.functions
            built = time.process_time()
            outcome = solver.solve(nlp)
            build[run, i] = built - began
            iterate[run, i] = (time.process_time() - built) / outcome.iterations
    seconds, building = iterate.min(axis=0), build.min(axis=0)
    n = np.array(INTERVALS, dtype=float)
    # A straight line that minimises the relative deviations.
    line = np.linalg.lstsq(np.column_stack([np.ones_like(n), n]) / seconds[:, None], np.ones_like(n), rcond=None)[0]
    fitted = line[0] + line[1] * n
    print(f"{'intervals':>9} {'build [s]':>10} {'per iteration [ms]':>19} {'straight line [ms]':>19} {'off':>6}")
    for row in zip(INTERVALS, building, 1e3 * seconds, 1e3 * fitted, seconds / fitted - 1, strict=True):
        print(f"{row[0]:9d} {row[1]:10.3f} {row[2]:19.3f} {row[3]:19.3f} {row[4]:6.1%}")
    worst = float(np.max(np.abs(seconds / fitted - 1)))
    slope = np.polyfit(np.log(n), np.log(seconds), 1)[0]
    print(f"worst distance from the line {worst:.1%}; grows as intervals^{slope:.2f}")
    print(f"16 times the intervals cost {seconds[-1] / seconds[0]:.1f} times as much per iteration")


if __name__ == "__main__":
    main()
