"""Where a fresh process spends its time on task T4: ``python benchmarks/inner/startup.py``.

Processor time [ms] of every stage from the start of the interpreter to the checked solution, medians of several
processes; Python's bytecode is cached, as it is for users. The times that ``rt.plan`` reports
(``solution.times``, wall clock) follow, indented. The table goes to ``startup.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TABLE = Path(__file__).with_suffix(".md")


SOLVERS = ("Ipopt", "InteriorPoint")


def child(intervals: int, solver: str) -> None:
    """Plan T4, stage by stage; print seconds of each."""
    seconds = {"interpreter": time.process_time()}

    def stamp(name: str) -> None:
        seconds[name] = time.process_time() - sum(v for k, v in seconds.items() if not k.startswith(" "))

    import numpy  # noqa: F401

    stamp("import numpy")
    import casadi  # noqa: F401

    stamp("import casadi")
    import pinocchio  # noqa: F401

    stamp("import pinocchio")
    import robotraj as rt

    _ = rt.load, rt.Phase, rt.State, rt.Effort, rt.plan, rt.Mesh, getattr(rt, solver)
    stamp("import robotraj")
    robot = rt.load("ur5")
    stamp("load")
    start, end = (-1.1, -1.8, 1.6, -1.2, -1.57, 0.0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)
    phase = rt.Phase(robot, 1.0, rt.State(q=list(start), v=0), rt.State(q=list(end), v=0), rt.Effort())
    stamp("phase")
    solution = rt.plan(phase, rt.Mesh(intervals), solver=getattr(rt, solver)(), progress=False)
    stamp("plan")
    seconds |= {f" {name}": value for name, value in solution.times.items() if ":" not in name}
    print(json.dumps(seconds))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--intervals", type=int, default=50)
    parser.add_argument("--child", choices=SOLVERS, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        return child(given.intervals, given.child)
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPYCACHEPREFIX": cache}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        command = [sys.executable, str(Path(__file__).resolve()), "--intervals", str(given.intervals), "--child"]
        runs: dict[str, list[dict[str, float]]] = {solver: [] for solver in SOLVERS}
        for _ in range(given.repeats + 1):
            for solver in SOLVERS:
                done = subprocess.run([*command, solver], check=True, capture_output=True, text=True, env=environment)
                runs[solver].append(json.loads(done.stdout))
    # The first process of each writes the bytecode.
    medians = {
        solver: {name: 1e3 * statistics.median(run[name] for run in own[1:]) for name in own[0]}
        for solver, own in runs.items()
    }
    for own in medians.values():
        own["all"] = sum(value for name, value in own.items() if not name.startswith(" "))
    lines = [
        f"Task T4 on {given.intervals} intervals in a fresh process: processor time [ms], medians of {given.repeats}, "
        "both in turn (`python benchmarks/inner/startup.py`).",
        "",
        f"| stage | {' | '.join(f'rt.{solver}()' for solver in SOLVERS)} |",
        f"|---|{'---:|' * len(SOLVERS)}",
    ]
    for name in medians[SOLVERS[0]]:
        values = " | ".join(f"{medians[solver][name]:.1f}" for solver in SOLVERS)
        lines.append(f"| {name.replace(' ', '&nbsp;&nbsp;', name.startswith(' '))} | {values} |")
    TABLE.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
