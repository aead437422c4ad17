"""Iterations of one step of legged robots, by the weight of accelerations in the default objective of gaits.

    python benchmarks/gait_objective.py [robot ...]

Prints the table of benchmarks/gait_objective.md: iterations (and processor seconds) of a step of ``proven/legs.py`` for
each factor c of c (h / g)^2 (0.2 m g h)^2 sum a^2, h the height of the centre of mass. A dash: not solved in LIMIT
iterations.
"""

from __future__ import annotations

import sys
import time
import warnings
from pathlib import Path

import robotraj as rt
from robotraj.gait import posture

LIMIT = 300
FACTORS = (0.0, 2e-4, 2e-3, 2e-2)
ROBOTS = ("solo12", "bolt", "anymal", "hyq", "a1", "go1", "b1", "laikago", "g1", "talos_legs", "icub", "alexander")


def main() -> None:
    """Print a row a robot and speed."""
    sys.path.insert(0, str(Path(__file__).parent / "proven"))
    from legs import step

    warnings.simplefilter("ignore")
    names = sys.argv[1:] or ROBOTS
    print("| robot | speed / sqrt(g h) |" + "".join(f" c = {c:g} |" for c in FACTORS), flush=True)
    print("|---|---|" + "---|" * len(FACTORS), flush=True)
    for name in names:
        for froude in (0.1, 0.25):
            cells = []
            for factor in FACTORS:
                posture.CALM = factor
                try:
                    problem = step(name, froude)
                except rt.InputError as error:
                    cells.append(str(error)[:60])
                    break
                began = time.process_time()
                plan = rt.plan(
                    problem,
                    rt.Mesh(10),
                    solver=rt.Ipopt(max_iterations=LIMIT),
                    restarts=rt.planning.Restarts(0),
                    check=False,
                )
                took = time.process_time() - began
                cells.append(f"{plan.iterations if plan.success else '-'} ({took:.1f} s)")
            print(f"| {name} | {froude:g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
