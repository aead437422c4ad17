"""Least times of arms between random free configurations: how many pass through the arm, and what avoiding that costs.

python benchmarks/self_collision.py [count] [seed]     writes benchmarks/self_collision.md

Each motion is planned with and without ``self_collision``. Pinocchio judges both at every millisecond with the exact
shapes, neighbours and pairs that touch in every one of 20 random configurations left out.
"""

from __future__ import annotations

import sys
import time
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

import robotraj as rt

TABLE = Path(__file__).with_suffix(".md")
ARMS = ("ur5", "panda", "xarm7", "kinova")
WITHIN = 30.0
"""Time limit of a plan [s]."""
HEAD = """# Least times of arms that keep off themselves

`python benchmarks/self_collision.py {count} {seed}`: {count} least times of each arm between free configurations.
"Through itself" counts plans that overlap at some millisecond by Pinocchio and coal, "without" and "with"
`self_collision`. The last columns are medians of processor time: the ratio of both where plans do not overlap anyway,
and the seconds of plans that had to avoid an overlap.

| arm | plans | through itself, without | with | proved, without | with | longer by up to | ratio | avoiding [s] |
|---|---|---|---|---|---|---|---|---|
"""


class Judge:
    """Counts the milliseconds at which links of a robot overlap, by ``pin.computeCollisions``."""

    def __init__(self, robot: rt.Robot) -> None:
        self.model, self.shapes = robot.model, robot.collision_model.copy()
        self.shapes.removeAllCollisionPairs()
        joints = [shape.parentJoint for shape in self.shapes.geometryObjects]
        for i, a in enumerate(joints):
            for j, b in enumerate(joints[:i]):
                if a != b and self.model.parents[a] != b and self.model.parents[b] != a:
                    self.shapes.addCollisionPair(pin.CollisionPair(j, i))
        self.data, self.found = self.model.createData(), self.shapes.createData()
        rng = np.random.default_rng(0)
        low, high = bounds(robot)
        self.always = np.all([self.touching(rng.uniform(low, high)) for _ in range(20)], axis=0)

    def touching(self, q: np.ndarray) -> np.ndarray:
        """Return which pairs overlap in a configuration."""
        pin.computeCollisions(self.model, self.data, self.shapes, self.found, q, False)
        return np.array([result.isCollision() for result in self.found.collisionResults])

    def overlaps(self, q: np.ndarray) -> bool:
        """Whether a pair overlaps that does not always."""
        return bool(np.any(self.touching(q) & ~self.always))

    def count(self, solution: rt.Solution) -> int:
        """Return the number of milliseconds of a plan with an overlap."""
        times = np.append(np.arange(0.0, solution.duration, 1e-3), solution.duration)
        return sum(map(self.overlaps, solution.at(times).q))


class Plan(NamedTuple):
    """A plan with its verdicts."""

    seconds: float
    duration: float
    proved: bool
    overlaps: int


def bounds(robot: rt.Robot) -> tuple[np.ndarray, np.ndarray]:
    """Return bounds of random configurations, within 3 rad."""
    return np.maximum(robot.limits.position_lower, -3.0), np.minimum(robot.limits.position_upper, 3.0)


def drawn(robot: rt.Robot, judge: Judge, rng: np.random.Generator) -> rt.Phase:
    """Return a least time between two random configurations without overlaps."""
    low, high = bounds(robot)
    ends: list[np.ndarray] = []
    while len(ends) < 2:
        q = rng.uniform(low, high)
        if not judge.overlaps(q):
            ends.append(q)
    return rt.Phase(robot, (0.1, 10.0), *(rt.State(q=q, v=0) for q in ends), rt.Duration())


def planned(phase: rt.Phase, judge: Judge) -> Plan:
    """Plan a phase and judge the plan."""
    began = time.process_time()
    solution = rt.plan(phase, check=False, progress=False, time_limit=WITHIN)
    seconds = time.process_time() - began
    proved = solution.success and solution.proof is not None and solution.proof.holds
    return Plan(seconds, solution.duration, proved, judge.count(solution))


def row(name: str, count: int, seed: int) -> str:
    """Plan the motions of one arm, and return a row of the table."""
    robot, rng = rt.load(name), np.random.default_rng(seed)
    judge, every = Judge(robot), []
    for number in range(count):
        phase = drawn(robot, judge, rng)
        every.append((planned(phase.with_(self_collision=False), judge), planned(phase, judge)))
        without, kept = every[-1]
        print(f"{name} {number}: {without} -> {kept}", file=sys.stderr, flush=True)
    through = [(a, b) for a, b in every if a.overlaps]
    # The first plan of a process reads meshes and compiles functions.
    ratios = [b.seconds / a.seconds for a, b in every[1:] if not a.overlaps]
    longer = max((b.duration / a.duration - 1.0 for a, b in every if b.proved), default=0.0)
    cells = [
        name,
        count,
        len(through),
        sum(b.overlaps > 0 for _, b in every),
        sum(a.proved for a, _ in every),
        sum(b.proved for _, b in every),
        f"{100 * longer:.1f} %",
        f"{np.median(ratios):.3f}" if ratios else "",
        f"{np.median([b.seconds for _, b in through]):.2f}" if through else "",
    ]
    return "| " + " | ".join(map(str, cells)) + " |"


def main() -> None:
    """Plan for every arm and write the table."""
    warnings.simplefilter("ignore")
    count, seed = (int(sys.argv[k]) if len(sys.argv) > k else default for k, default in ((1, 75), (2, 0)))
    text = HEAD.format(count=count, seed=seed) + "\n".join(row(name, count, seed) for name in ARMS) + "\n"
    TABLE.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
