"""Plans under their own gains in MuJoCo, 100 seeded runs each: `python benchmarks/tvlqr.py [NAME...]`.

cart-pole, acrobot, ur5 and panda: `rt.witness.monte_carlo` under `solution.gains` with its default disturbances
(initial error, masses, friction, noise, one push, delay). five_link, which stands on a soft foot and moves its
root: a step by `rt.witness.second_opinion` under its time-varying LQR, from a seeded random error of the first state.

A plan meets the default disturbances and, where it loses more than one run in 100, the largest ones that it is held
under: factors of the default ones fall by the square root of 2 until 99 of 100 runs are held with each of two seeds.
What a plan can answer depends on the plan: torques that swing a passive joint up must be right to a percent while it
passes configurations at which the motor hardly moves it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import robotraj as rt

RUNS = 100
SEED = 22
ERROR = 0.01
"""Standard deviation of the first state of the biped [rad, m, rad/s, m/s]."""

HEAD = """\
# Plans under their own gains in MuJoCo

Written by `python benchmarks/tvlqr.py`: 100 seeded runs a row. Disturbances are factors of the default ones
(`rt.witness.Disturbances()`). Where a plan loses more than one run at the default ones, the second row has the largest
factor at which 99 of 100 runs are held with each of two seeds; the bound is claimed for those. A run is held while
every position stays within the bound of the plan [rad, m].

| plan | disturbances | bound | held of 100 | 95 percent interval | median | worst |
|---|---|---|---|---|---|---|
"""


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


HELD = 99
"""Runs of 100 that a claimed bound is held in."""
FACTORS = tuple(2.0 ** (-0.5 * k) for k in range(1, 14))
"""Factors of the default disturbances that are tried, one after the other."""


def runs(solution: rt.Solution, scale: float, bound: float, seed: int) -> rt.witness.MonteCarlo:
    """Simulate a plan under scaled disturbances."""
    drawn = rt.witness.Disturbances().scaled(scale)
    return rt.witness.monte_carlo(solution, RUNS, disturbances=drawn, bound=bound, seed=seed)


def kept(found: rt.witness.MonteCarlo) -> int:
    """Return the number of runs that stayed within their bound."""
    return int(np.sum(found.worst <= found.bound))


def held_under(solution: rt.Solution, bound: float) -> tuple[float, rt.witness.MonteCarlo]:
    """Return the largest factor at which enough runs are held with both seeds, and the runs of the first seed."""
    for factor in FACTORS:
        found = runs(solution, factor, bound, SEED)
        if kept(found) >= HELD and kept(runs(solution, factor, bound, SEED + 1)) >= HELD:
            return factor, found
    return factor, found


def biped(scale: float) -> tuple[int, int]:
    """Return how many of the runs of a step ended upright, and how many there were."""
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=2.0)
    step = rt.gait.walk(robot, step_length=0.5, duration=0.7, contact=foot, clearance=0.05, upright=None)
    solution, upright = rt.plan(step, tolerance=1e-4), 0
    for child in np.random.SeedSequence(SEED).spawn(RUNS):
        offset = scale * ERROR * np.random.default_rng(child).standard_normal(2 * robot.nv)
        upright += rt.witness.second_opinion(solution, 1, offset=offset).failure is None
    return upright, RUNS


def rows(name: str) -> Iterator[str]:
    """Rows of a plan: at the default disturbances and, where more than one run is lost, at those it is held under."""
    if name not in PLANS:
        upright, _ = biped(1.0)
        yield f"| {name} | 1 | upright | {upright} | | | |"
        return
    make, bound = PLANS[name]
    solution = make()
    scale, found = 1.0, runs(solution, 1.0, bound, SEED)
    yield row(name, scale, found)
    if kept(found) < HELD:
        yield row(name, *held_under(solution, bound))


def row(name: str, scale: float, found: rt.witness.MonteCarlo) -> str:
    """Return a row of the table."""
    low, high = found.interval
    return (
        f"| {name} | {scale:.2g} | {found.bound:g} | {kept(found)} | {low:.3f} to {high:.3f} | "
        f"{np.median(found.worst):.3g} | {found.worst.max():.3g} |"
    )


def main() -> None:
    """Print the table, and write it beside this file if it has every plan."""
    names = sys.argv[1:]
    lines = HEAD.splitlines()
    print(*lines, sep="\n", flush=True)
    for name in names or [*PLANS, "five_link"]:
        for line in rows(name):
            print(line, flush=True)
            lines.append(line)
    if not names:
        Path(__file__).with_suffix(".md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
