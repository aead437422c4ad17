"""Steps of rt.Replanner in closed loop beside cold solves: python benchmarks/replanning.py writes replanning.md.

A ur5 follows a goal that moves, a step every 20 ms, alone and among obstacles. It follows its plan exactly. Cold is
rt.plan of the same problem on the same mesh, building included. Processor seconds of one thread. The loop has the
real-time priority of a control loop where the system permits it, since its deadline is on the wall clock.
"""

import os
import time
from pathlib import Path

import casadi as ca
import numpy as np

import robotraj as rt

START = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
GOAL = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
NAMES = [f"goal.{i}" for i in range(6)]
DEADLINE, PERIOD, STEPS, COLD = 0.01, 0.02, 300, 10


def goal(t):
    """Goal at time t [rad], (6,)."""
    return GOAL + 0.3 * np.sin(1.5 * t + np.arange(6))


BALL = rt.obstacles.Sphere(0.1, lambda t: (0.7 + 0.03 * ca.sin(3.0 * t), 0.2, 0.42))
BOX = rt.obstacles.Box((0.3, 0.3, 0.4), (-0.5, 0.5, 0.2))


def horizon(robot, q, v, t, constraints=()):
    """Return the problem of one step."""

    def distance(point):
        return sum((point.q[i] - point.p[name]) ** 2 for i, name in enumerate(NAMES))

    return rt.Phase(
        robot,
        duration=1.0,
        start=rt.State(q=q, v=v),
        end=rt.State(v=0),
        objective=rt.Lagrange(distance) + 1e-5 * rt.Effort(),
        constraints=constraints,
        parameters=dict(zip(NAMES, goal(t), strict=True)),
    )


def measured(robot, intervals, constraints=()):
    """Return the column of one loop."""
    solver, mesh = rt.InteriorPoint(threads=1), rt.Mesh(intervals, rt.HermiteSimpson())
    began = time.process_time()
    replanner = rt.Replanner(horizon(robot, START, 0.0, 0.0, constraints), mesh=mesh, deadline=DEADLINE)
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
            phase = horizon(robot, q, v, t, constraints)
            began = time.process_time()
            rt.plan(phase, mesh=mesh, solver=solver)
            cold.append(time.process_time() - began)
        reached = replan.at(t + PERIOD)
        q, v = reached.q, reached.v
    ms = 1e3 * np.array(seconds)
    return [
        ("making the replanner [ms]", f"{1e3 * making:.0f}"),
        ("step, median [ms]", f"{np.median(ms):.2f}"),
        ("step, 99th percentile [ms]", f"{np.percentile(ms, 99):.2f}"),
        ("step on the wall clock, median [ms]", f"{1e3 * np.median(walls):.2f}"),
        ("step on the wall clock, 99th percentile [ms]", f"{1e3 * np.percentile(walls, 99):.2f}"),
        ("iterations, median and most", f"{int(np.median(iterations))}, {max(iterations)}"),
        (f"plans that meet their rows within {1e3 * DEADLINE:g} ms", f"{fresh} of {STEPS}"),
        ("cold solve, median [ms]", f"{1e3 * np.median(cold):.1f}"),
        ("cold / step", f"{np.median(cold) * 1e3 / np.median(ms):.1f}"),
    ]


def has_priority():
    """Ask for real-time priority; return whether the system permits it."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
    except (AttributeError, OSError):
        return False
    return True


def main():
    """Run the loops and write the table."""
    priority = "with real-time priority" if has_priority() else "without real-time priority"
    robot, around = rt.load("ur5"), [rt.CollisionFree([BALL, BOX], margin=0.01)]
    columns = [measured(robot, 50), measured(robot, 50, around), measured(robot, 25, around)]
    lines = [f"| {row[0][0]} | {' | '.join(value for _, value in row)} |" for row in zip(*columns, strict=True)]
    head = [
        "# Replanning",
        "",
        f"Written by `python benchmarks/replanning.py`, {priority}: ur5. Among obstacles the whole arm avoids a ball",
        "that moves, a box and itself.",
        "",
        "| | 50 intervals | 50 intervals among obstacles | 25 intervals among obstacles |",
        "|---|---|---|---|",
    ]
    text = "\n".join([*head, *lines]) + "\n"
    Path(__file__).with_suffix(".md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
