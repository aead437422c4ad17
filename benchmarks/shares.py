"""Where kinks and dry friction begin to matter: `python benchmarks/shares.py`, which writes shares.md.

Each row is a ur5's reach in 2.5 s, with a share of kinks or of friction (``robotraj.fixed_mesh.sizes.shares``). It is
planned twice: as a problem in which they matter, and as one in which they do not.
"""

from __future__ import annotations

import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

import robotraj as rt
from robotraj.fixed_mesh.sizes import shares

HEAD = """# Shares from which kinks and dry friction matter

`python benchmarks/shares.py`: iterations, processor seconds and objective where a plan ignores them or not.

| changed | share | ignored: iterations | s | objective | not ignored: iterations | s | objective |
|---|---:|---:|---:|---:|---:|---:|---:|
"""


def reach(seed: int, work: float, friction: float) -> rt.Phase:
    """Move a ur5 with a weight of absolute power, and dry friction relative to its limits of effort."""
    ur5 = rt.load("ur5")
    draw = np.random.default_rng(seed)
    first, last = (-2.0 + 4.0 * draw.random(6) for _ in range(2))
    robot = replace(ur5, friction=friction * ur5.limits.effort)
    objective = rt.Effort() + work * rt.objectives.AbsolutePower() if work else rt.Effort()
    return rt.Phase(robot, 2.5, rt.State(q=first, v=0), rt.State(q=last, v=0), objective, self_collision=False)


def cells(phase: rt.Phase, matters: bool) -> str:
    """Plan with other thresholds."""
    kept = shares.KINKED, shares.STICKING
    shares.KINKED = shares.STICKING = 0.0 if matters else np.inf
    if matters:
        # What is not there does not matter.
        problem = rt.Problem([phase])
        shares.KINKED = kept[0] if shares.shares_of(problem).kinks == 0.0 else 0.0
        shares.STICKING = kept[1] if shares.shares_of(problem).friction == 0.0 else 0.0
    began = time.process_time()
    try:
        solution = rt.plan(phase, check=False, progress=False, time_limit=30.0)
    finally:
        shares.KINKED, shares.STICKING = kept
    return f"{solution.iterations} | {time.process_time() - began:.2f} | {solution.objective:.6g}"


def main() -> None:
    """Write the table."""
    warnings.simplefilter("ignore")
    lines = []
    cases = [("work", weight, 0.0) for weight in (1e-6, 1e-1, 1.0, 3.0, 10.0)]
    cases += [("friction", 0.0, size) for size in (1e-5, 1e-4, 1e-3, 1e-2, 3e-2)]
    for seed in range(2):
        for name, work, friction in cases:
            phase = reach(seed, work, friction)
            found = shares.shares_of(rt.Problem([phase]))
            share = found.kinks if work else found.friction
            row = f"| {name}, seed {seed} | {share:.1e} | {cells(phase, False)} | {cells(phase, True)} |"
            print(row, flush=True)
            lines.append(row)
    Path(__file__).with_suffix(".md").write_text(HEAD + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
