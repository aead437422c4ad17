"""The coarsest mesh with which each tool passes the same proof: `python benchmarks/proven/peers.py`.

robotraj plans by its default call. All other tools solve on 25 intervals, then on twice as many, until their plan
passes: pieces of a fortieth of the motion, simulated one by one from the planned state, end within 1e-3 of the plan;
limits hold to 1e-3 of their range at 21 places of every interval; the goal is met to 1e-3. A tool that took ``MORE``
times our seconds without passing is not run on finer meshes. The judge is ``benchmarks/peers/check.py``, which depends
on no tool. Tools, tasks and environments are those of ``benchmarks/peers``. The table goes to ``PEERS.md``.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "peers"))

import run as peers  # noqa: E402
import urdf  # noqa: E402
from environments import DEFAULT_CACHE, python_of  # noqa: E402
from tasks import TASKS, task_of  # noqa: E402
from tools import TOOLS  # noqa: E402

TABLE = HERE / "PEERS.md"
OURS = "robotraj-proven"
ASKED = ("T4", "T5", "T2", "T3")
TOOLS_ASKED = (OURS, "by-hand", "drake-ipopt", "crocoddyl", "dymos")
INTERVALS = (25, 50, 100, 200, 400)
LIMIT = 600.0
"""Wall-clock seconds of a process, on a machine that others use; solvers stop after 120 processor seconds."""
MORE = 200.0
"""Multiple of our processor seconds beyond which a tool that does not pass is not run on finer meshes."""
ALLOWED = 1e-3
MEASURES = {
    "local error": "local error",
    "over position": "over a position limit",
    "over speed": "over a speed limit",
    "over torque": "over a torque limit",
    "goal": "goal missed",
}
HEAD = (
    "| task | tool | intervals | build and solve [s] | whole process [s] | objective | local error | over a limit "
    "| goal missed by | times ours | whole process, times ours | remark |"
)


def faults(found: dict[str, Any]) -> list[str]:
    """Name what a plan fails in."""
    return [f"{name} {found[key]:.0e}" for key, name in MEASURES.items() if not found[key] <= ALLOWED]


def coarsest(task: str, name: str, python: Path, cache: Path, repeats: int, patience: float) -> dict[str, Any]:
    """Double the mesh until the plan passes; the seconds are the least of several runs on that mesh.

    Meshes end where one took more processor seconds than ``patience``.
    """
    tool, tried = TOOLS[name], []
    if task in tool.cannot:
        return {"remark": tool.cannot[task]}
    for intervals in INTERVALS if name != OURS else INTERVALS[:1]:
        key = f"{task}@{intervals}"
        found = peers.run_once(key, name, python, cache, LIMIT)
        why = [found["failed"]] if "failed" in found else faults(found)
        print(task, name, intervals, found.get("work cpu"), why or "passes", flush=True)
        tried.append(f"{intervals}: {', '.join(why)}")
        if not why:
            more = [peers.run_once(key, name, python, cache, LIMIT) for _ in range(repeats - 1)]
            for seconds in ("work cpu", "process cpu"):
                found[seconds] = min(each[seconds] for each in [found, *more] if seconds in each)
            return found | {"intervals": "its own" if name == OURS else intervals, "remark": ""}
        spent = found.get("work cpu", np.inf if found.get("failed", "").startswith("over") else 0.0)
        if spent > patience:
            tried[-1] += f", after {patience:.0f} s or more"
            break
    return {"remark": "none passes; " + "; ".join(tried)}


def line(task: str, name: str, found: dict[str, Any], ours: dict[str, Any]) -> str:
    """Write a row of the table."""
    cells = [task, TOOLS[name].title]
    if "work cpu" not in found:
        return f"| {' | '.join([*cells, *[''] * 9, found['remark']])} |"
    over = max(found[f"over {what}"] for what in ("position", "speed", "torque"))
    numbers = (found["work cpu"], found["process cpu"], found["objective"])
    cells += [str(found["intervals"]), *(f"{number:.4g}" for number in numbers)]
    cells += [f"{number:.0e}" for number in (found["local error"], over, found["goal"])]
    ratios = (found[each] / ours[each] if each in ours else float("nan") for each in ("work cpu", "process cpu"))
    return f"| {' | '.join([*cells, *(f'{ratio:.1f}' for ratio in ratios), found['remark']])} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(ASKED))
    parser.add_argument("--tools", nargs="+", choices=TOOLS, default=list(TOOLS_ASKED))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--cache", type=Path, default=DEFAULT_CACHE)
    parser.add_argument("--write", action="store_true", help="write the table, after every task")
    given = parser.parse_args()
    cache = given.cache.resolve()
    rows = [HEAD, "|---|---|" + "---:|" * 9 + "---|"]
    pythons = {name: python_of(TOOLS[name].environment, cache) for name in given.tools}
    for task in given.tasks:
        urdf.write(task_of(task).urdf, cache / "urdf")
        found: dict[str, dict[str, Any]] = {}
        for name in given.tools:
            patience = MORE * found.get(OURS, {}).get("work cpu", np.inf)
            found[name] = coarsest(task, name, pythons[name], cache, given.repeats, patience)
        rows += [line(task, name, each, found.get(OURS, {})) for name, each in found.items()]
        if given.write:
            write(rows, given.repeats)
    print("\n".join(rows))


def write(rows: list[str], repeats: int) -> None:
    """Write the table."""
    head = (
        "Written by `python benchmarks/proven/peers.py --write`: processor seconds, one thread, fresh processes, "
        f"the least of {repeats} runs. That file describes the proof, [peers](../peers/README.md) the rest."
    )
    title = "# The coarsest mesh with which each tool passes the same proof"
    TABLE.write_text("\n".join([title, "", head, "", *rows, ""]))


if __name__ == "__main__":
    main()
