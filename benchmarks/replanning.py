"""Steps of rt.Replanner in closed loop beside cold solves: python benchmarks/replanning.py writes replanning.md.

A ur5 follows a goal that moves, with 50 intervals of horizon, a step every 20 ms. It follows its plan exactly. Cold is
rt.plan of the same problem on the same mesh, building included. Processor seconds of one thread.
"""

import time
from pathlib import Path

import numpy as np

import robotraj as rt

START = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
GOAL = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
NAMES = [f"goal.{i}" for i in range(6)]
DEADLINE, PERIOD, STEPS, COLD = 0.01, 0.02, 500, 10


def goal(t):
    """Goal at time t [rad], (6,)."""
    return GOAL + 0.3 * np.sin(1.5 * t + np.arange(6))


def horizon(robot, q, v, t):
    """Return the problem of one step."""

    def distance(point):
        return sum((point.q[i] - point.p[name]) ** 2 for i, name in enumerate(NAMES))

    return rt.Phase(
        robot,
        duration=1.0,
        start=rt.State(q=q, v=v),
        end=rt.State(v=0),
        objective=rt.Lagrange(distance) + 1e-5 * rt.Effort(),
        parameters=dict(zip(NAMES, goal(t), strict=True)),
    )


def main():
    """Run the loop and write the table."""
    robot, solver = rt.load("ur5"), rt.InteriorPoint(threads=1)
    mesh = rt.Mesh(50, rt.HermiteSimpson())
    began = time.process_time()
    replanner = rt.Replanner(horizon(robot, START, 0.0, 0.0), mesh=mesh, deadline=DEADLINE)
    making = time.process_time() - began
    q, v, seconds, walls, iterations, fresh, cold = START, np.zeros(6), [], [], [], 0, []
    for k in range(STEPS):
        t = k * PERIOD
        began = time.process_time()
        replan = replanner.step(t, rt.State(q=q, v=v), parameters=dict(zip(NAMES, goal(t), strict=True)))
        seconds.append(time.process_time() - began)
        walls.append(replan.seconds)
        iterations.append(replan.iterations)
        fresh += replan.fresh
        if k % (STEPS // COLD) == 0:
            phase = horizon(robot, q, v, t)
            began = time.process_time()
            rt.plan(phase, mesh=mesh, solver=solver)
            cold.append(time.process_time() - began)
        reached = replan.at(t + PERIOD)
        q, v = reached.q, reached.v
    ms = 1e3 * np.array(seconds)
    rows = [
        ("making the replanner [ms]", f"{1e3 * making:.0f}"),
        ("step, median [ms]", f"{np.median(ms):.2f}"),
        ("step, 99th percentile [ms]", f"{np.percentile(ms, 99):.2f}"),
        ("step on the wall clock, median [ms]", f"{1e3 * np.median(walls):.2f}"),
        ("iterations, median and most", f"{int(np.median(iterations))}, {max(iterations)}"),
        (f"plans that meet their rows within {1e3 * DEADLINE:g} ms", f"{fresh} of {STEPS}"),
        ("cold solve, median [ms]", f"{1e3 * np.median(cold):.1f}"),
        ("cold / step", f"{np.median(cold) * 1e3 / np.median(ms):.1f}"),
    ]
    table = "\n".join(f"| {name} | {value} |" for name, value in rows)
    head = "# Replanning\n\nWritten by `python benchmarks/replanning.py`: ur5, 50 intervals.\n\n| | |\n|---|---|\n"
    Path(__file__).with_suffix(".md").write_text(head + table + "\n", encoding="utf-8")
    print(table)


if __name__ == "__main__":
    main()
