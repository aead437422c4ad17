"""Cost per iteration against the number of intervals, and the straight line nearest to it.

Kelly's cart-pole by IPOPT on 50 to 800 intervals, ten iterations each, and task T4 (ur5) by `rt.InteriorPoint` on 25 to
1,600, to its end, over its iterations: all of a plan but the imports, in a fresh process, as in the peers' tables; the
iterations alone, of a program that is there; and with the set-up of the stages, in a process that has planned before.
Hermite-Simpson. Processor time, the least of several runs taken in turn, so that other work on the machine counts
little. Run with ``python benchmarks/linearity.py``.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
from roofline import iterations
from scipy.optimize import linprog

import robotraj as rt
from robotraj._util.arrays import Array

CARTPOLE, ARM = (50, 100, 200, 400, 800), (25, 50, 100, 200, 400, 800, 1600)
ITERATIONS = 10
RUNS = 5
START, GOAL = (-1.1, -1.8, 1.6, -1.2, -1.57, 0.0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)


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


def arm() -> rt.Problem:
    """Task T4."""
    ends = rt.State(q=list(START), v=0), rt.State(q=list(GOAL), v=0)
    return rt.Problem([rt.Phase(rt.load("ur5"), 1.0, *ends, rt.Effort())])


def nearest_line(n: Array, seconds: Array) -> Array:
    """Return the line, as (intercept, slope), with the least maximum relative distance from the seconds."""
    rows = np.column_stack([np.ones_like(n), n]) / seconds[:, None]
    one = np.ones((len(n), 1))
    # |rows @ line - 1| <= distance, the third unknown, which is made least.
    within = np.block([[rows, -one], [-rows, -one]])
    limits = np.concatenate([one[:, 0], -one[:, 0]])
    return linprog([0, 0, 1], within, limits, bounds=[(None, None), (None, None), (0, None)]).x[:2]


def report(title: str, counts: Sequence[int], seconds: Array) -> None:
    """Print a line a mesh, and how far they are from a straight line."""
    n = np.array(counts, dtype=float)
    line = nearest_line(n, seconds)
    fitted = line[0] + line[1] * n
    print(f"\n{title}")
    print(f"{'intervals':>9} {'measured [ms]':>14} {'an interval [us]':>17} {'straight line [ms]':>19} {'off':>6}")
    for count, own, near in zip(counts, seconds, fitted, strict=True):
        print(f"{count:9d} {1e3 * own:14.3f} {1e6 * own / count:17.2f} {1e3 * near:19.3f} {own / near - 1:6.1%}")
    slope = np.polyfit(np.log(n), np.log(seconds), 1)[0]
    print(f"worst distance from the line {np.max(np.abs(seconds / fitted - 1)):.1%}; grows as intervals^{slope:.2f}")
    print(f"{n[-1] / n[0]:.0f} times the intervals cost {seconds[-1] / seconds[0]:.1f} times as much")


def by_ipopt() -> None:
    problem, solver = cartpole(), rt.Ipopt(max_iterations=ITERATIONS)
    iterate = np.full((RUNS, len(CARTPOLE)), np.inf)
    for run in range(RUNS):
        for i, count in enumerate(CARTPOLE):
            nlp = rt.transcription.transcribe(problem, rt.Mesh(count), rt.guess.default_guess(problem))
            _ = nlp.functions
            began = time.process_time()
            outcome = solver.solve(nlp)
            iterate[run, i] = (time.process_time() - began) / outcome.iterations
    report("cart-pole, an iteration of IPOPT", CARTPOLE, iterate.min(axis=0))


def first_plan(count: int) -> None:
    """Plan task T4 once and print the processor time over its iterations [s]."""
    # Names are imported on first access; this access counts them among the imports.
    _ = rt.Phase, rt.State, rt.Effort, rt.Mesh, rt.InteriorPoint, rt.load, rt.plan
    began = time.process_time()
    solution = rt.plan(arm(), rt.Mesh(count), solver=rt.InteriorPoint(threads=1), check=False, progress=False)
    print((time.process_time() - began) / solution.iterations)


def in_fresh_processes() -> None:
    seconds = np.full((RUNS, len(ARM)), np.inf)
    for run in range(RUNS):
        for i, count in enumerate(ARM):
            ran = subprocess.run([sys.executable, __file__, str(count)], capture_output=True, text=True, check=True)
            seconds[run, i] = float(ran.stdout)
    report("ur5, build and solve in a fresh process, over the iterations", ARM, seconds.min(axis=0))


def by_stages() -> None:
    problem, solver = arm(), rt.InteriorPoint(threads=1, fallback=None)
    whole, iterate = (np.full((RUNS, len(ARM)), np.inf) for _ in range(2))
    for run in range(RUNS):
        for i, count in enumerate(ARM):
            nlp = rt.transcription.transcribe(
                problem,
                rt.Mesh(count),
                rt.guess.default_guess(problem),
                engine=rt.engines.Native(),
                interval_limits=rt.interval_limits.BernsteinBounds(),
            )
            began = time.process_time()
            outcome = solver.solve(nlp)
            solved = time.process_time()
            whole[run, i] = (solved - began) / outcome.iterations
            iterate[run, i] = min(iterations(solver, nlp, 2))
    report("ur5, an iteration of rt.InteriorPoint", ARM, iterate.min(axis=0))
    report("ur5, set-up of the stages included, over the iterations", ARM, whole.min(axis=0))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        first_plan(int(sys.argv[1]))
    else:
        by_ipopt()
        in_fresh_processes()
        by_stages()
