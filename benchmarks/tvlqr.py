"""Plans under their own gains in MuJoCo, 100 seeded runs each: `python benchmarks/tvlqr.py [NAME...]`.

cart-pole, acrobot, ur5 and panda: `rt.witness.monte_carlo` under `solution.gains` with its default disturbances
(initial error, masses, friction, noise, one push, delay). five_link, which stands on a soft foot and moves its
root: a step by `rt.witness.second_opinion` under its time-varying LQR, from a seeded random error of the first state.

A plan meets the default disturbances and, where a run is lost, those that its motors can answer. The rule: in 20 runs
at a fiftieth of the default ones the largest share of the torque reserve that the feedback uses is measured. It
grows in proportion to the disturbances. They are chosen so that it is a half: a gain margin of two. A factor above 1
is 1.
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

Written by `python benchmarks/tvlqr.py`: 100 seeded runs a row. Disturbances are factors of the default ones. Where a
run is lost at the default ones, the second row has those for which the feedback uses half of the torque that the plan
leaves of the limits. A run is held while every position stays within the bound of the plan [rad, m].

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


PROBE, PROBES, SHARE = 0.02, 20, 0.5
"""Factor of the disturbances and number of the runs that measure the reserve; share of it that may be used."""


def within_reserve(solution: rt.Solution, bound: float) -> float:
    """Return the factor of the default disturbances at which the feedback uses half of the torque reserve."""
    small = rt.witness.Disturbances().scaled(PROBE)
    probe = rt.witness.monte_carlo(solution, PROBES, disturbances=small, bound=bound, seed=SEED + 1)
    return float(min(1.0, SHARE * PROBE / probe.used.max()))


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


def rows(name: str) -> Iterator[str]:
    """Rows of a plan: at the default disturbances and, where a run is lost, at those of its torque reserve."""
    if name not in PLANS:
        kept, _ = biped(1.0)
        yield f"| {name} | 1 | upright | {kept} | | | |"
        return
    make, bound = PLANS[name]
    solution = make()
    for attempt in range(2):
        scale = within_reserve(solution, bound) if attempt else 1.0
        drawn = rt.witness.Disturbances().scaled(scale)
        found = rt.witness.monte_carlo(solution, RUNS, disturbances=drawn, bound=bound, seed=SEED)
        kept, (low, high) = int(np.sum(found.worst <= bound)), found.interval
        yield (
            f"| {name} | {scale:.2g} | {bound:g} | {kept} | {low:.3f} to {high:.3f} | "
            f"{np.median(found.worst):.3g} | {found.worst.max():.3g} |"
        )
        if kept == RUNS:
            return


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
