"""Runs every task with every tool, interleaved, each in a fresh process; writes results.json, tables and plots.

    python benchmarks/peers/run.py [--tasks T1 T4@200 T6 lecture] [--tools robotraj opti] [--repeats 5]

``T4@200`` is T4 on 200 intervals. Ratios hold within one run only; figures are medians.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402
import table  # noqa: E402
import urdf  # noqa: E402
from check import judge  # noqa: E402
from environments import DEFAULT_CACHE, ENVIRONMENTS, python_of  # noqa: E402
from tasks import TASKS, task_of  # noqa: E402
from tools import TOOLS  # noqa: E402

SWEEP = tuple(f"T4@{n}" for n in (25, 100, 200, 400))
OTHERS = {"T6": "benchmarks/peers/legs/run.py", "lecture": "benchmarks/lecture.py"}
"""Comparisons with a separate script."""
LIMIT = 300.0
"""Seconds after which a process is stopped; solvers stop after 120 processor seconds."""


def run_once(key: str, name: str, python: Path, cache: Path, limit: float = LIMIT) -> dict[str, Any]:
    """Run one script in a fresh process and judge its result."""
    tool, task = TOOLS[name], task_of(key)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "plan.npz"
        variables = {
            **os.environ,
            **tool.variables,
            "OMP_NUM_THREADS": "1",
            "PEERS_TASK": key,
            "PEERS_URDF": str(cache / "urdf"),
            "PYTHONPATH": "" if tool.environment else str(ROOT),
        }
        if not tool.environment:
            variables["XDG_CACHE_HOME"] = str(cache / "compiled" if tool.cached else Path(folder) / "empty")
        # Python keeps what it compiled, as it does of installed packages.
        variables.pop("PYTHONDONTWRITEBYTECODE", None)
        command = [str(python), "-W", "ignore", str(HERE / "scripts" / tool.script), str(out)]
        began = time.time()
        try:
            done = subprocess.run(command, env=variables, cwd=folder, capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return {"failed": f"over {limit:.0f} s", "total": limit}
        if done.returncode or not out.exists():
            reason = (done.stderr.strip().splitlines() or ["no output"])[-1]
            return {"failed": reason[:120], "total": time.time() - began}
        with np.load(out) as plan:
            figures = {name: plan[name].item() for name in plan if plan[name].ndim == 0}
            samples = {name: plan[name] for name in "tqvu"}
    figures["total"] = figures.pop("ended") - began
    if not figures["success"]:
        return {**figures, "failed": f"no solution: {figures['message']}"}
    return figures | judge(task, cache / "urdf" / f"{task.urdf}.urdf", samples)


def compare(key: str, pythons: dict[str, Path], options: argparse.Namespace, cache: Path) -> dict[str, list[Any]]:
    """All runs of one task, tools in turn."""
    runs: dict[str, list[dict[str, Any]]] = {name: [] for name in options.tools}
    name_of_task, intervals = key.partition("@")[0], task_of(key).intervals
    for name, known in runs.items():
        tool = TOOLS[name]
        if name_of_task in tool.cannot:
            known.append({"failed": tool.cannot[name_of_task]})
        elif name not in pythons:
            known.append({"failed": "not installed"})
        elif "@" in key and intervals > tool.largest:
            known.append({"failed": f"not run: over {tool.largest} intervals"})
        elif tool.cached:
            filled = run_once(key, name, pythons[name], cache)
            if "failed" in filled:
                known.append(filled)
    for turn in range(options.repeats):
        for name, known in runs.items():
            ended = known and ("failed" in known[0] or known[0]["total"] > options.once)
            if ended or (TOOLS[name].slow and turn >= options.slow_repeats):
                continue
            known.append(run_once(key, name, pythons[name], cache))
            shown = {k: round(v, 4) if isinstance(v, float) else v for k, v in known[-1].items()}
            print(key, name, shown, flush=True)
    return runs


def run_other(name: str, options: argparse.Namespace) -> None:
    """Run a comparison that is a separate script."""
    more = ["--results", str(options.results)] if options.results else []
    if name == "T6":
        more += ["--repeats", str(options.repeats), "--cache", str(options.cache), "--once", str(options.once)]
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, str(ROOT / OTHERS[name]), *more], check=True, env=variables)


def main() -> None:
    """Parse, prepare, run, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tasks", nargs="+", default=[*TASKS, *SWEEP, *OTHERS], help="T1 ... T6, T4@200, lecture")
    parser.add_argument("--tools", nargs="+", choices=TOOLS, default=list(TOOLS))
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--slow-repeats", type=int, default=3, help="of tools that take many seconds")
    parser.add_argument("--once", type=float, default=40.0, help="what takes longer than this [s] runs once")
    parser.add_argument("--cache", type=Path, default=DEFAULT_CACHE)
    parser.add_argument("--out", type=Path, default=Path("results.json"), help="record; added to where it exists")
    parser.add_argument("--commit", help="of what is measured; the checkout's by default")
    parser.add_argument("--results", type=Path, help="write all tables between this file's markers, plots beside it")
    options = parser.parse_args()
    cache = options.cache.resolve()
    tasks = [key for key in options.tasks if key not in OTHERS]
    for key in tasks:
        urdf.write(task_of(key).urdf, cache / "urdf")
    pythons: dict[str, Path] = {}
    for name in options.tools if tasks else []:
        try:
            pythons[name] = python_of(TOOLS[name].environment, cache)
        except RuntimeError as error:
            print(f"{name}: {error}", file=sys.stderr)
    # Bytecode of a checkout and of the scripts, which pip writes for installed packages.
    subprocess.run([sys.executable, "-m", "compileall", "-q", str(ROOT / "robotraj"), str(HERE)], check=True)
    record = {
        "date": datetime.date.today().isoformat(),
        "commit": options.commit or table.commit(ROOT),
        "repeats": options.repeats,
        "slow repeats": options.slow_repeats,
        "once": options.once,
        "environments": {name: each.text for name, each in ENVIRONMENTS.items()},
        "versions": table.versions(pythons),
        "results": {},
    }
    if options.out.exists():
        record["results"] = json.loads(options.out.read_text())["results"]
    for key in tasks:
        record["results"][key] = record["results"].get(key, {}) | compare(key, pythons, options, cache)
        options.out.write_text(json.dumps(record, indent=1))
        if options.results:
            table.write_all(record, options.results)
    for name in OTHERS:
        if name in options.tasks:
            run_other(name, options)


if __name__ == "__main__":
    main()
