"""Runs every task with every tool, interleaved, each in a fresh process; writes results.json and a Markdown table.

    python benchmarks/peers/run.py [--tasks T1 T4] [--peers robotraj opti] [--repeats 5]

Ratios hold within one run only; figures are medians.
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
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402
import table  # noqa: E402
import urdf  # noqa: E402
from check import judge  # noqa: E402
from environments import ENVIRONMENTS, python_of  # noqa: E402
from tasks import TASKS  # noqa: E402

# Tool: (script's suffix, environment, extra variables).
PEERS: dict[str, tuple[str, str | None, dict[str, str]]] = {
    "robotraj": ("robotraj", None, {}),
    "opti": ("opti", None, {}),
    "drake-ipopt": ("drake", "drake", {"PEERS_SOLVER": "ipopt"}),
    "drake-snopt": ("drake", "drake", {"PEERS_SOLVER": "snopt"}),
    "crocoddyl": ("crocoddyl", "crocoddyl", {}),
}
CANNOT = {
    ("T1", "crocoddyl"): "cannot: free duration",
    ("T5", "crocoddyl"): "cannot: free duration",
    ("T3", "crocoddyl"): "not tried",
}
LIMIT = 150.0
"""Seconds after which a process is stopped; solvers are told to stop at 120."""
ONCE = 40.0
"""A script that takes longer than this [s] is run once only."""


def run_once(task: str, peer: str, python: Path, cache: Path) -> dict[str, Any]:
    """Run one script in a fresh process and judge what it hands back."""
    suffix, _, extra = PEERS[peer]
    script = HERE / "scripts" / f"{task.lower()}_{suffix}.py"
    variables = {**os.environ, **extra, "OMP_NUM_THREADS": "1", "PEERS_URDF": str(cache / "urdf")}
    variables["PYTHONPATH"] = str(HERE.parents[1])
    # Python keeps what it compiled, as it does of installed packages.
    variables.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "plan.npz"
        began = time.time()
        try:
            done = subprocess.run(
                [str(python), str(script), str(out)], env=variables, capture_output=True, text=True, timeout=LIMIT
            )
        except subprocess.TimeoutExpired:
            return {"failed": f"over {LIMIT:.0f} s", "total": LIMIT}
        if done.returncode or not out.exists():
            reason = (done.stderr.strip().splitlines() or ["no output"])[-1]
            return {"failed": reason[:120], "total": time.time() - began}
        with np.load(out) as plan:
            figures = {key: plan[key].item() for key in ("solve", "iterations", "success", "message", "memory")}
            figures["total"] = plan["ended"].item() - began
            samples = {key: plan[key] for key in "tqvu"}
    if not figures["success"]:
        return {**figures, "failed": f"no solution: {figures['message']}"}
    return figures | judge(TASKS[task], cache / "urdf" / f"{TASKS[task].urdf}.urdf", samples)


def main() -> None:
    """Parse, prepare, run, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(TASKS))
    parser.add_argument("--peers", nargs="+", choices=PEERS, default=list(PEERS))
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--cache", type=Path, default=Path.home() / ".cache" / "robotraj-peers")
    parser.add_argument("--out", type=Path, default=Path("results.json"))
    parser.add_argument("--readme", type=Path, help="write the short table between this file's peers markers")
    asked = parser.parse_args()
    cache = asked.cache.resolve()
    for name in {TASKS[task].urdf for task in asked.tasks}:
        urdf.write(name, cache / "urdf")
    pythons, missing = {}, {}
    for peer in asked.peers:
        try:
            pythons[peer] = python_of(PEERS[peer][1], cache)
        except RuntimeError as error:
            missing[peer] = str(error)
    # Bytecode of a checkout and of the scripts, which pip writes for installed packages.
    subprocess.run([sys.executable, "-m", "compileall", "-q", str(HERE.parents[1] / "robotraj"), str(HERE)], check=True)
    results: dict[str, dict[str, list[dict[str, Any]]]] = {}
    for task in asked.tasks:
        runs = results[task] = {peer: [] for peer in asked.peers}
        for peer in asked.peers:
            if peer in missing:
                runs[peer].append({"failed": missing[peer]})
            elif (task, peer) in CANNOT:
                runs[peer].append({"failed": CANNOT[task, peer]})
        for _ in range(asked.repeats):
            for peer in pythons:
                known = runs[peer]
                if known and ("failed" in known[0] or known[0]["total"] > ONCE):
                    continue
                known.append(run_once(task, peer, pythons[peer], cache))
                shown = {k: round(v, 5) if isinstance(v, float) else v for k, v in known[-1].items()}
                print(task, peer, shown, flush=True)
        record = {
            "date": datetime.date.today().isoformat(),
            "repeats": asked.repeats,
            "environments": {name: list(packages) for name, packages in ENVIRONMENTS.items()},
            "versions": table.versions(pythons),
            "results": results,
        }
        asked.out.write_text(json.dumps(record, indent=1))
        asked.out.with_suffix(".md").write_text(table.full(record))
    if asked.readme is not None:
        table.between_markers(asked.readme, table.short(record))


if __name__ == "__main__":
    main()
