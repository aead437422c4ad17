"""Efforts of z1 with dry friction by several continuations: proved plans, processor time and objectives.

usage: python benchmarks/friction.py [number of motions] [seed]

Every drawn motion is planned by the default call with one constant of ``planning.proving.soft_friction`` or of
``transcription.smoothness.sticking`` changed. The
objective is relative to the best one of all continuations. Writes benchmarks/friction.md.
"""

from __future__ import annotations

import sys
import time
import warnings
from pathlib import Path

import numpy as np

import robotraj as rt
from robotraj.planning.proving import soft_friction
from robotraj.transcription.smoothness import sticking

VARIANTS = (
    {},
    {"SOFTEST": 1 / 32},
    {"SOFTEST": 1 / 2},
    {"LAST": 2.0},
    {"LAST": 0.25},
    {"FALL": 2.0},
    {"FALL": 10.0},
    {"PRICE": 0.0},
    {"PRICE": 0.1},
)


def motions(count: int, seed: int) -> list[rt.Phase]:
    """Draw motions between random ends in 1.1 to 2.9 times the least duration of the speed limits."""
    robot, rng = rt.load("z1"), np.random.default_rng(seed)
    low = np.maximum(robot.model.lowerPositionLimit, -3.0)
    high = np.minimum(robot.model.upperPositionLimit, 3.0)
    found = []
    for _ in range(count):
        start, end = (low + rng.uniform(0.1, 0.9, robot.nq) * (high - low) for _ in range(2))
        least = float(np.max(np.abs(end - start) / robot.model.upperVelocityLimit))
        duration = least * rng.uniform(1.1, 2.9) + 0.2
        ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
        found.append(rt.Phase(robot, duration, *ends, rt.Effort(), self_collision=False))
    return found


def planned(phase: rt.Phase, changes: dict[str, float]) -> tuple[bool, float, float]:
    """Return whether a plan is proved, its processor time and its objective."""
    rooms = {name: soft_friction if hasattr(soft_friction, name) else sticking for name in changes}
    kept = {name: getattr(room, name) for name, room in rooms.items()}
    began = time.process_time()
    try:
        for name, value in changes.items():
            setattr(rooms[name], name, value)
        # What is known of a phase is kept with it.
        solution = rt.plan(phase.with_(name=str(changes)), check=False, time_limit=60)
    finally:
        for name, value in kept.items():
            setattr(rooms[name], name, value)
    holds = solution.proof is not None and solution.proof.holds
    return holds, time.process_time() - began, solution.objective


def main() -> None:
    """Plan the motions and write the table."""
    warnings.simplefilter("ignore")
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 6
    phases = motions(count, int(sys.argv[2]) if len(sys.argv) > 2 else 4)
    results = [[planned(phase, changes) for phase in phases] for changes in VARIANTS]
    best = [min(row[k][2] for row in results if row[k][0]) for k in range(count)]
    lines = [
        f"Efforts of z1 with dry friction, {count} motions, by `python benchmarks/friction.py`.",
        "",
        "| constant | proved | processor time, sum [s] | objective above the best one, mean and largest [%] |",
        "|---|---|---|---|",
    ]
    for changes, row in zip(VARIANTS, results, strict=True):
        name = ", ".join(f"{key} = {value:.3g}" for key, value in changes.items()) or "as they are"
        above = [100.0 * (cost / least - 1.0) for (holds, _, cost), least in zip(row, best, strict=True) if holds]
        shown = f"{np.mean(above):.2f}, {max(above):.2f}" if above else ""
        lines.append(f"| {name} | {sum(each[0] for each in row)} | {sum(each[1] for each in row):.0f} | {shown} |")
        print(lines[-1], flush=True)
    Path(__file__).with_suffix(".md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
