"""Many starts: the lowest optimum of T3 and T2 after 5, 10, 15 and 20 of them, for ten seeds; writes starts.md.

    python benchmarks/starts.py

The acrobot's swing-up (T3) has dozens of optima. One seed is no measure; ten seeds are.
"""

from __future__ import annotations

import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "peers"), str(HERE / "peers" / "scripts")]

import urdf  # noqa: E402
from tasks import task_of  # noqa: E402

import robotraj as rt  # noqa: E402

SEEDS, STARTS, AFTER = 10, 20, (1, 5, 10, 15, 20)
SOLVER = rt.InteriorPoint(threads=1, fallback=None)


def search(key: str, seed: int) -> tuple[list[str], rt.applications.Multistart]:
    """Search with one seed: cells of the table, and what was found."""
    task = task_of(key)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(1) as here:
        urdf.write(task.urdf, Path(folder))
        robot = rt.load(str(Path(folder) / f"{task.urdf}.urdf"), actuated=[task.joints[i] for i in task.actuated])
        began = time.process_time()
        phase = rt.Phase(
            robot,
            duration=task.duration,
            start=rt.State(q=task.start, v=0),
            end=rt.State(q=task.end, v=0),
            objective=rt.Effort(),
        )
        found = rt.multistart(phase, STARTS, seed, executor=here, mesh=rt.Mesh(task.intervals), solver=SOLVER)
        spent = time.process_time() - began
    costs = {start: optimum.objective for optimum in found.optima for start in optimum.starts}
    best = [min((cost for start, cost in costs.items() if start < n), default=float("inf")) for n in AFTER]
    cells = [f"{cost:.2f}" for cost in best]
    return [str(seed), *cells, str(len(found.optima)), str(STARTS - len(costs)), f"{spent:.2f}"], found


def main() -> None:
    """Search, write."""
    lines = [
        "# Many starts",
        "",
        f"`python benchmarks/starts.py`: `rt.multistart` with its own spread, {STARTS} starts of `rt.InteriorPoint` in "
        "one process on one thread; lowest objective after so many starts, distinct optima, starts without a solution, "
        "processor seconds of all starts with reading and transcribing. Start 1 is the straight line.",
        "",
    ]
    for key in ("T3", "T2"):
        lines += [
            f"## {key}, {task_of(key).title}, {task_of(key).intervals} intervals",
            "",
            f"| seed | {' | '.join(f'after {n}' for n in AFTER)} | optima | failed | processor [s] |",
            "|---" * (len(AFTER) + 4) + "|",
        ]
        for seed in range(SEEDS):
            cells, found = search(key, seed)
            print(key, *cells, flush=True)
            lines.append(f"| {' | '.join(cells)} |")
            if seed == 0:
                first = str(found)
        lines += ["", "Seed 0:", "", "```", first, "```", ""]
    (HERE / "starts.md").write_text("\n".join(lines))


if __name__ == "__main__":
    main()
