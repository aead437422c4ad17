"""Plans under their own gains in MuJoCo, 100 seeded runs each: `python benchmarks/tvlqr.py [NAME...]`.

cart-pole, acrobot, ur5 and panda: `rt.witness.monte_carlo` under `solution.gains` with its default disturbances
(initial error, masses, friction, noise, one push, delay). five_link, which stands on a soft foot and moves its
root: a step by `rt.witness.second_opinion` under its time-varying LQR, from a seeded random error of the first state.
Each plan meets smaller disturbances until all of its runs are held.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import fields

import numpy as np

import robotraj as rt

RUNS = 100
SEED = 22
ERROR = 0.01
"""Standard deviation of the first state of the biped [rad, m, rad/s, m/s]."""


def cartpole() -> rt.Solution:
    """Swing up, and move the cart by a metre."""
    robot = rt.load("cartpole")
    return rt.plan(rt.Phase(robot, 2.0, rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0), rt.Effort()))


def acrobot() -> rt.Solution:
    """Swing up from hanging."""
    robot = rt.load("acrobot")
    return rt.plan(rt.Phase(robot, 3.0, rt.State(q=[0, 0], v=0), rt.State(q=[np.pi, 0], v=0), rt.Effort()))


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


SCALES = (1.0, 0.5, 0.25, 0.1)
"""Factors of the default disturbances."""


def biped(scale: float) -> tuple[int, int]:
    """Return how many of the runs of a step ended upright, and how many there were."""
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=2.0)
    step = rt.gait.walk(robot, step_length=0.5, duration=0.7, contact=foot, clearance=0.05, upright=None)
    solution, kept = rt.plan(step, tolerance=1e-4), 0
    for child in np.random.SeedSequence(SEED).spawn(RUNS):
        offset = scale * ERROR * np.random.default_rng(child).standard_normal(2 * robot.nv)
        kept += rt.witness.second_opinion(solution, 1, offset=offset).failure is None
    return kept, RUNS


def main() -> None:
    """Print the table."""
    names = sys.argv[1:] or [*PLANS, "five_link"]
    print("| plan | disturbances | bound | held of 100 | 95 percent interval | median | worst |", flush=True)
    print("|---|---|---|---|---|---|---|", flush=True)
    usual = rt.witness.Disturbances()
    for name in names:
        solution = PLANS[name][0]() if name in PLANS else None
        for scale in SCALES:
            if solution is None:
                kept, _ = biped(scale)
                print(f"| {name} | {scale:g} | upright | {kept} | | | |", flush=True)
            else:
                drawn = rt.witness.Disturbances(
                    **{entry.name: scale * getattr(usual, entry.name) for entry in fields(usual)}
                )
                bound = PLANS[name][1]
                found = rt.witness.monte_carlo(solution, RUNS, disturbances=drawn, bound=bound, seed=SEED)
                kept, (low, high) = int(np.sum(found.worst <= bound)), found.interval
                print(
                    f"| {name} | {scale:g} | {bound:g} | {kept} | {low:.3f} to {high:.3f} | "
                    f"{np.median(found.worst):.3g} | {found.worst.max():.3g} |",
                    flush=True,
                )
            if kept == RUNS:
                break


if __name__ == "__main__":
    main()
