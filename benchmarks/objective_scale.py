"""Iterations of `rt.InteriorPoint` with and without the scale of the objective: `python benchmarks/objective_scale.py`.

Arms by effort, in 1.15, 1.5 and 3 times the least time of each motion, between random positions (seeded), on equal
intervals of Hermite-Simpson, one thread, without a fallback; then task T4 on finer and finer meshes, and its
objective in other units. A scale of 1 leaves the objective as the problem gives it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from linearity import ARM, arm

import robotraj as rt

ROBOTS, MOTIONS, SEED = ("ur5", "panda", "ur10", "kinova", "ur3"), 4, 31
INTERVALS, SLOWER, UNITS = (25, 50, 150), (1.15, 1.5, 3.0), (1e-3, 1.0, 1e3)
SOLVER = rt.InteriorPoint(threads=1, fallback=None, max_iterations=500)
EQUAL = 1e-4
"""Objectives that differ by no more than this share are the same optimum."""


def planned(phase: rt.Phase, intervals: int) -> dict[bool, rt.Solution]:
    """Plan with the scale and without."""
    solvers = {True: SOLVER, False: replace(SOLVER, objective_scale=1.0)}
    return {
        scaled: rt.plan(phase, rt.Mesh(intervals), solver=solver, check=False, progress=False)
        for scaled, solver in solvers.items()
    }


def motions() -> Iterator[rt.Phase]:
    """Every robot from one random position to another, in each of the durations."""
    random = np.random.default_rng(SEED)
    for _ in range(MOTIONS):
        for name in ROBOTS:
            robot = rt.load(name)
            low, high = np.maximum(robot.model.lowerPositionLimit, -2), np.minimum(robot.model.upperPositionLimit, 2)
            ends: Any = rt.State(q=random.uniform(low, high), v=0), rt.State(q=random.uniform(low, high), v=0)
            fastest = rt.Phase(robot, (0.05, 60.0), *ends, rt.Duration())
            least = rt.plan(fastest, rt.Mesh(30), solver=SOLVER, check=False, progress=False).objective
            for slower in SLOWER:
                yield rt.Phase(robot, slower * least, *ends, rt.Effort())


def means(phases: list[rt.Phase]) -> None:
    """Print geometric means of the iterations, and whose optimum is the better."""
    print("| intervals | motions | iterations, without | with | failed | better optimum with | worse |")
    print("|---|---|---|---|---|---|---|")
    for count in INTERVALS:
        found = [planned(phase, count) for phase in phases]
        solved = [each for each in found if each[True].success and each[False].success]
        iterations = [np.exp(np.mean([np.log(each[scaled].iterations) for each in solved])) for scaled in (False, True)]
        failed = [sum(not each[scaled].success for each in found) for scaled in (False, True)]
        gains = np.array([each[True].objective / each[False].objective - 1.0 for each in solved])
        print(
            f"| {count} | {len(found)} | {iterations[0]:.1f} | {iterations[1]:.1f} | {failed[0]}, {failed[1]} | "
            f"{np.sum(gains < -EQUAL)} | {np.sum(gains > EQUAL)} |",
            flush=True,
        )


def meshes() -> None:
    """Print T4's iterations on every mesh and in every unit."""
    (phase,) = arm().phases
    print(f"\n| T4, intervals | {' | '.join(map(str, ARM))} |\n|{'---|' * (len(ARM) + 1)}")
    for unit in UNITS:
        found = [planned(phase.with_(objective=unit * rt.Effort()), count) for count in ARM]
        for scaled in (False, True):
            name = f"{unit:g} effort, {'with' if scaled else 'without'}"
            print(f"| {name} | {' | '.join(str(each[scaled].iterations) for each in found)} |", flush=True)


if __name__ == "__main__":
    means(list(motions()))
    meshes()
