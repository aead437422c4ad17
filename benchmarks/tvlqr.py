"""Plans under their own gains in MuJoCo, 100 seeded runs each: `python benchmarks/tvlqr.py [NAME...]`.

cart-pole, acrobot, ur5 and panda run in `rt.witness.monte_carlo` under `solution.gains`. Disturbances are the default
ones (initial error, masses, friction, noise, one push, delay), and those of `rt.witness.disturbance_margin`, which are
stated for the plan. five_link, which stands on a soft foot and moves its root, is simulated by
`rt.witness.second_opinion`. It takes a step under its time-varying LQR, from a seeded random error of the first state.

The acrobot's plan is, among the optima of 20 starts, the one with the largest margin.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import robotraj as rt

RUNS = 100
SEED, OTHER = 22, 23
ERROR = 0.01
"""Standard deviation of the first state of the biped [rad, m, rad/s, m/s]."""
STARTS, TRIALS = 20, 20
"""Starts of the acrobot, and runs that compare its optima."""

HEAD = """\
# Plans under their own gains in MuJoCo

Written by `python benchmarks/tvlqr.py`: 100 runs for each of two seeds. A run is held while every position stays within
the bound of the plan [rad, m]. Disturbances are factors of the default ones. The stated ones are those that
`rt.witness.disturbance_margin` found by other runs than these. The acrobot's plan is, among the optima of 20 starts,
the one with the largest margin.

| plan | disturbances | bound | held of 100, two seeds | 95 percent interval, first seed | median | worst |
|---|---|---|---|---|---|---|
"""


def cartpole() -> rt.Solution:
    """Swing up, and move the cart by a metre."""
    robot = rt.load("cartpole")
    return rt.plan(rt.Phase(robot, 2.0, rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0), rt.Effort()))


def acrobot() -> rt.Solution:
    """Swing up from hanging, by the optimum that is held best."""
    robot = rt.load("acrobot")
    swing_up = rt.Phase(robot, 3.0, rt.State(q=[0, 0], v=0), rt.State(q=[np.pi, 0], v=0), rt.Effort())
    found = rt.multistart(swing_up, STARTS, seed=SEED, executor=ThreadPoolExecutor(1))
    return max((optimum.solution for optimum in found.optima), key=_margin)


def _margin(solution: rt.Solution) -> float:
    return rt.witness.disturbance_margin(solution, TRIALS, bound=0.3, seed=OTHER + 1).factor


def arm(name: str, start: list[float], end: list[float]) -> rt.Solution:
    """Reach from rest to rest."""
    robot = rt.load(name)
    return rt.plan(rt.Phase(robot, 1.5, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort()))


def ur5() -> rt.Solution:
    """Swing from one side to the other."""
    return arm("ur5", [-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


def panda() -> rt.Solution:
    """Reach with closed fingers."""
    robot = rt.load("panda")
    start = [0.0, -0.8, 0.0, -2.0, 0.0, 1.6, 0.8]
    spare = list(robot.neutral[7:])
    return arm("panda", start + spare, [0.8, 0.2, 0.3, -1.4, 0.4, 2.0, 0.2] + spare)


PLANS: dict[str, tuple[Callable[[], rt.Solution], float]] = {
    "cartpole": (cartpole, 0.3),
    "acrobot": (acrobot, 0.3),
    "ur5": (ur5, 0.1),
    "panda": (panda, 0.1),
}
"""Plans, and the largest deviation that counts as held [rad, m]."""


def biped(seed: int) -> int:
    """Return how many of the runs of a step ended upright."""
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=2.0)
    step = rt.gait.walk(robot, step_length=0.5, duration=0.7, contact=foot, clearance=0.05, upright=None)
    solution, kept = rt.plan(step, tolerance=1e-4), 0
    for child in np.random.SeedSequence(seed).spawn(RUNS):
        offset = ERROR * np.random.default_rng(child).standard_normal(2 * robot.nv)
        kept += rt.witness.second_opinion(solution, 1, offset=offset).failure is None
    return kept


def rows(name: str) -> Iterator[str]:
    """Rows of a plan: at the default disturbances, and at those that are stated for it."""
    if name not in PLANS:
        yield f"| {name} | 1 | upright | {biped(SEED)}, {biped(OTHER)} | | | |"
        return
    make, bound = PLANS[name]
    solution = make()
    margin = rt.witness.disturbance_margin(solution, RUNS, bound=bound, seed=SEED)
    for label, drawn in (("1", rt.witness.Disturbances()), (f"{margin.factor:.2g}, stated", margin.disturbances)):
        first, second = (
            rt.witness.monte_carlo(solution, RUNS, disturbances=drawn, bound=bound, seed=seed) for seed in (SEED, OTHER)
        )
        held = ", ".join(str(round(RUNS * found.held)) for found in (first, second))
        low, high = first.interval
        yield (
            f"| {name} | {label} | {bound:g} | {held} | {low:.3f} to {high:.3f} | "
            f"{np.median(first.worst):.3g} | {first.worst.max():.3g} |"
        )


def main() -> None:
    """Print the table, and write it beside this file if it has every plan."""
    names = sys.argv[1:]
    lines = HEAD.splitlines()
    print(*lines, sep="\n", flush=True)
    for name in names or [*PLANS, "five_link"]:
        for row in rows(name):
            print(row, flush=True)
            lines.append(row)
    if not names:
        Path(__file__).with_suffix(".md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
