"""Iterations of the interior-point method on many random swing-ups and reaches, each from the default guess.

python benchmarks/swing_ups.py [seed]     writes benchmarks/swing_ups.md

The path of a swing-up's iterations is chaotic: another duration or torque changes their number severalfold. A change of
the solver is therefore judged by its sum over many problems, and by the problems that it no longer solves.
"""

from __future__ import annotations

import sys
import time
import warnings
from pathlib import Path

import numpy as np

import robotraj as rt

RODS = Path(__file__).with_name("peers") / "rods.urdf"
TABLE = Path(__file__).with_suffix(".md")
COUNTS = {"acrobot": 60, "double pendulum": 30, "cart-pole": 40, "pendulum": 10, "ur5": 20, "panda": 20}
HEAD = """# Random swing-ups and reaches

`python benchmarks/swing_ups.py`: seed {seed}, one solve each on a fixed mesh of Hermite-Simpson from the default guess,
without a fallback. Torques, durations, meshes and goals are random.

| problems | number | solved | iterations, sum | median | largest | processor [s] |
|---|---|---|---|---|---|---|
"""


def swing_up(kind: str, draw: np.random.Generator) -> rt.Phase:
    """Return a swing-up from hanging to upright in a random time with random torques."""
    if kind == "cart-pole":
        robot, motor, torques, times = rt.load("cartpole"), "slider", (10, 40), (1.8, 5.0)
    elif kind == "pendulum":
        robot, motor, torques, times = rt.load("pendulum"), None, (1.5, 4), (3, 8)
    elif kind == "acrobot":
        robot, motor, torques, times = rt.load(RODS, actuated=["elbow"]), "elbow", (8, 20), (3.5, 6.0)
    else:
        robot, motor, torques, times = rt.load(RODS), None, (5, 12), (2.5, 5.0)
    torque, duration = draw.uniform(*torques), draw.uniform(*times)
    limits = robot.limits.with_(effort=torque if motor is None else {motor: torque})
    end = [1.0, np.pi] if kind == "cart-pole" else [np.pi, *[0.0] * (robot.nq - 1)]
    ends = rt.State(q=np.zeros(robot.nq), v=0), rt.State(q=end, v=0)
    return rt.Phase(robot, duration, *ends, rt.Effort(), limits=limits)


def reach(name: str, draw: np.random.Generator) -> rt.Phase:
    """Return a reach of an arm between random configurations: of least effort in 1.5 s, or of least time."""
    robot = rt.load(name)
    low, high = (np.clip(each, -2.5, 2.5) for each in (robot.limits.position_lower, robot.limits.position_upper))
    first, second = (draw.uniform(0.9 * low + 0.1 * high, 0.1 * low + 0.9 * high) for _ in range(2))
    ends = rt.State(q=first, v=0), rt.State(q=0.5 * (first + second), v=0)
    if draw.integers(2):
        return rt.Phase(robot, 1.5, *ends, rt.Effort())
    return rt.Phase(robot, (0.1, 10.0), *ends, rt.Duration())


def row(kind: str, count: int, draw: np.random.Generator) -> str:
    """Solve the problems of a kind; return their row of the table."""
    pose = reach if kind in ("ur5", "panda") else swing_up
    solver = rt.InteriorPoint(fallback=None, threads=1)
    solved, iterations, began = 0, [], time.process_time()
    for _ in range(count):
        phase, mesh = pose(kind, draw), rt.Mesh(10 * int(draw.integers(5, 11)))
        solution = rt.plan(phase, mesh=mesh, solver=solver, check=False, progress=False)
        solved += solution.success
        iterations.append(solution.iterations)
    seconds = time.process_time() - began
    figures = f"{sum(iterations)} | {np.median(iterations):g} | {max(iterations)} | {seconds:.1f}"
    return f"| {kind} | {count} | {solved} | {figures} |"


def main() -> None:
    """Write the table."""
    warnings.simplefilter("ignore")
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    draw, lines = np.random.default_rng(seed), []
    for kind, count in COUNTS.items():
        lines.append(row(kind, count, draw))
        print(lines[-1], flush=True)
    TABLE.write_text(HEAD.format(seed=seed) + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
