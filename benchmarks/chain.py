"""A sweep along a chain beside cold plans: `python benchmarks/chain.py` writes chain.md.

Fifteen trots of solo12 of rising speed by default calls, in one process, after a plan that imports everything. Cold
and chained sweeps alternate; processor seconds are the least of the rounds.
"""

from __future__ import annotations

import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import robotraj as rt

SPEEDS = np.linspace(0.1, 0.8, 15)
"""Speeds [m/s]."""
ROUNDS = 3
TABLE = Path(__file__).with_suffix(".md")


def trots(robot: rt.Robot) -> list[rt.Problem]:
    """Return half strides of 0.25 s, new ones at every call."""
    return [rt.gait.trot(robot, speed=speed, duration=0.25, clearance=0.03) for speed in SPEEDS]


def main() -> None:
    """Write the table."""
    warnings.simplefilter("ignore")
    robot = rt.load("solo12", root="floating")
    rt.plan(trots(robot)[0], progress=False)
    seconds: dict[str, list[float]] = {"cold": [], "chain": []}
    found: dict[str, list[rt.Solution]] = {}
    for _ in range(ROUNDS):
        for name, took in seconds.items():
            problems = trots(robot)
            began = time.process_time()
            if name == "cold":
                with ThreadPoolExecutor(1) as here:
                    found[name] = rt.sweep(problems, executor=here)
            else:
                found[name] = rt.sweep(problems, chain=True)
            took.append(time.process_time() - began)
    lines = []
    for name, solutions in found.items():
        proved = sum(solution.proof is not None and solution.proof.holds for solution in solutions)
        meshes = sum(len(solution.refinement) for solution in solutions)
        iterations = sum(solution.iterations for solution in solutions)
        lines.append(f"| {name} | {proved} | {meshes} | {iterations} | {min(seconds[name]):.2f} |")
    pairs = zip(found["cold"], found["chain"], strict=True)
    apart = max(abs(one.objective / other.objective - 1.0) for one, other in pairs)
    ratio = min(seconds["chain"]) / min(seconds["cold"])
    head = f"`python benchmarks/chain.py`: {len(SPEEDS)} trots of solo12, {SPEEDS[0]:g} to {SPEEDS[-1]:g} m/s."
    table = ["| sweep | proved | meshes | iterations | processor [s] |", "|---|---|---|---|---|", *lines]
    end = f"The chain takes {ratio:.2f} of the time; objectives differ by {apart:.1e} at most."
    TABLE.write_text("\n".join(["# Sweeps along a chain", "", head, "", *table, "", end, ""]))
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
