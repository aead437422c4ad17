"""Walks by Crocoddyl's own examples and by robotraj, interleaved, each in a fresh process, judged alike.

python benchmarks/peers/legs/run.py [--walks L1 L2 L3] [--repeats 5] [--results RESULTS.md]
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
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy as np  # noqa: E402
from environments import DEFAULT_CACHE, python_of  # noqa: E402
from judge import judge  # noqa: E402
from models import robot_of  # noqa: E402
from report import full  # noqa: E402
from table import between_markers  # noqa: E402
from walks import WALKS  # noqa: E402

# Tool: (script, environment, words after the walk and the file).
TOOLS: dict[str, tuple[str, str | None, tuple[str, ...]]] = {
    "crocoddyl": ("plan_crocoddyl.py", "crocoddyl", ()),
    "robotraj": ("plan_robotraj.py", None, ("rest", "native")),
    "robotraj compiled": ("plan_robotraj.py", None, ("rest", "compiled")),
    "robotraj interior point": ("plan_robotraj.py", None, ("rest", "interior-point")),
    "robotraj periodic": ("plan_robotraj.py", None, ("periodic", "native")),
    "robotraj periodic interior point": ("plan_robotraj.py", None, ("periodic", "interior-point")),
}


def run_once(walk: str, tool: str, python: Path, limit: float) -> dict[str, Any]:
    """Run one script in a fresh process and judge its result."""
    script, _, words = TOOLS[tool]
    variables = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": f"{HERE.parents[2]}:{HERE}"}
    variables.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "plan.npz"
        began = time.time()
        command = [str(python), str(HERE / script), walk, str(out), *words]
        try:
            done = subprocess.run(command, env=variables, capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return {"failed": f"over {limit:.0f} s"}
        if done.returncode or not out.exists():
            return {"failed": (done.stderr.strip().splitlines() or ["no output"])[-1][:120]}
        with np.load(out) as plan:
            arrays = {name: plan[name] for name in plan}
    figures = {name: value.item() for name, value in arrays.items() if value.ndim == 0}
    figures["total"] = figures.pop("ended") - began
    return figures | judge(WALKS[walk], robot_of(WALKS[walk].robot).model, arrays, "periodic" in words)


def main() -> None:
    """Parse, prepare, run, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--walks", nargs="+", choices=WALKS, default=list(WALKS))
    parser.add_argument("--tools", nargs="+", choices=TOOLS, default=list(TOOLS))
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--cache", type=Path, default=DEFAULT_CACHE)
    parser.add_argument("--once", type=float, default=100.0, help="what takes longer than this [s] runs once")
    parser.add_argument("--limit", type=float, default=900.0, help="what takes longer than this [s] is stopped")
    parser.add_argument("--out", type=Path, default=Path("legs.json"))
    parser.add_argument("--results", type=Path, help="write the full tables between this file's walks markers")
    options = parser.parse_args()
    pythons = {tool: python_of(TOOLS[tool][1], options.cache.resolve()) for tool in options.tools}
    subprocess.run([sys.executable, "-m", "compileall", "-q", str(HERE.parents[2] / "robotraj"), str(HERE)], check=True)
    results: dict[str, dict[str, list[dict[str, Any]]]] = {}
    record: dict[str, Any] = {"date": datetime.date.today().isoformat(), "repeats": options.repeats, "results": results}
    for walk in options.walks:
        runs = results[walk] = {tool: [] for tool in options.tools}
        for _ in range(options.repeats):
            for tool, python in pythons.items():
                if runs[tool] and ("failed" in runs[tool][0] or runs[tool][0]["total"] > options.once):
                    continue
                runs[tool].append(run_once(walk, tool, python, options.limit))
                shown = {k: round(v, 6) if isinstance(v, float) else v for k, v in runs[tool][-1].items()}
                print(walk, tool, shown, flush=True)
                options.out.write_text(json.dumps(record, indent=1))
                options.out.with_suffix(".md").write_text(full(record))
    if options.results is not None:
        between_markers(options.results, full(record), "walks")


if __name__ == "__main__":
    main()
