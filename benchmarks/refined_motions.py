"""Arms refined to a tolerance, and solved again from their own solution: `python benchmarks/refined_motions.py`.

Robots move in turn between random positions (seeded), planned from the straight line. The objectives are least time,
least time with effort, and effort in 1.3 times the least time. The solver is `rt.InteriorPoint` on one thread without a
fallback. Prints meshes, iterations and processor time of ``tolerance=1e-4``. Prints also the iterations of plans on 40
intervals, from the straight line and from their own solution.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

import robotraj as rt

ROBOTS, MOTIONS, SEED, SLOWER = ("ur3", "ur10_limited", "panda", "kinova", "two_link_arm"), 1, 5, 1.3
SOLVER = rt.InteriorPoint(threads=1, fallback=None)
TOLERANCE = 1e-4


def motions() -> Iterator[tuple[str, rt.Phase]]:
    """Every robot from one random position to another, for each objective."""
    random = np.random.default_rng(SEED)
    for _ in range(MOTIONS):
        for name in ROBOTS:
            robot = rt.load(name)
            low, high = np.maximum(robot.model.lowerPositionLimit, -2), np.minimum(robot.model.upperPositionLimit, 2)
            start, end = (rt.State(q=random.uniform(low, high), v=0) for _ in range(2))
            fastest = rt.Phase(robot, (0.05, 60.0), start, end, rt.Duration())
            least = rt.plan(fastest, rt.Mesh(30), solver=SOLVER, check=False, progress=False).objective
            yield f"{name}, time", fastest
            yield (
                f"{name}, time and effort",
                rt.Phase(robot, (0.05, 60.0), start, end, rt.Duration() + 1e-3 * rt.Effort()),
            )
            yield f"{name}, effort", rt.Phase(robot, SLOWER * least, start, end, rt.Effort())


def plan(phase: rt.Phase) -> tuple[rt.Solution, float]:
    """Refine; also give the processor time [s]."""
    began = time.process_time()
    solution = rt.plan(phase, tolerance=TOLERANCE, solver=SOLVER, check=False, progress=False)
    return solution, time.process_time() - began


def again(phase: rt.Phase) -> tuple[int, int]:
    """Count iterations from the straight line and from the solution, on one mesh."""
    first = rt.plan(phase, rt.Mesh(40), solver=SOLVER, check=False, progress=False)
    return first.iterations, rt.plan(phase, rt.Mesh(40), first, SOLVER, check=False, progress=False).iterations


def main() -> None:
    """Print a line a motion, then the sums."""
    print("| motion | status | meshes | iterations | processor [s] | objective | iterations on 40 intervals | again |")
    print("|---|---|---|---|---|---|---|---|")
    sums = np.zeros(5)
    for name, phase in motions():
        solution, seconds = plan(phase)
        iterations = sum(step.iterations for step in solution.refinement)
        own = (len(solution.refinement), iterations, seconds, *again(phase))
        sums += own
        status = solution.status.value
        row = f"{own[0]} | {iterations} | {seconds:.2f} | {solution.objective:.6g} | {own[3]} | {own[4]}"
        print(f"| {name} | {status} | {row} |", flush=True)
    total = f"{sums[0]:.0f} | {sums[1]:.0f} | {sums[2]:.1f} |"
    print(f"| all | | {total} | {sums[3]:.0f} | {sums[4]:.0f} |")


if __name__ == "__main__":
    main()
