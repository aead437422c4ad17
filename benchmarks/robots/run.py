"""Strangers' robots, by the default call: `python benchmarks/robots/run.py FOLDER [package ...] [--files N]`.

The packages of ``packages.txt`` are installed below FOLDER, each into a folder of its own and without what they
depend on; those that are there are kept. Every URDF with moving joints is then loaded in a fresh process, compared with
``reader.py``, which shares nothing with Pinocchio, and planned: three reaches of effort and one of least time, or a
gait. Lines of JSON go to FOLDER/results.jsonl, and a run that was stopped goes on there. The table of all lines goes to
``RESULTS.md``, also where Ctrl-C ends the run.

``--files N`` takes N files of each package at most, spread evenly over the sorted list.

``--catalogue`` runs the robots that ``rt.load`` knows by name, with the root of their file; those of ``LEGGED`` also
stand on their feet. Lines go to FOLDER/catalogue.jsonl, and the table to ``CATALOGUE.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import robotraj as rt

HERE = Path(__file__).parent
Job = tuple[str, str, str, bool]
"""Package, key in the log, file or name of the robot, and whether it is legged."""
HEAD = "| package | file | joints | agreement | plans | slowest [s] | remark |\n|---|---|---|---|---|---|---|"

LEGGED = (
    *("a1", "anymal", "anymal_c", "anymal_kinova", "b1", "b1_z1", "go1", "go2", "hyq", "laikago", "quadruped"),
    *("solo12", "solo8", "bolt", "g1", "g1_hands", "human", "icub", "icub_reduced", "romeo", "romeo_small"),
    *("simple_humanoid", "talos", "talos_box", "talos_full", "talos_legs"),
)
"""Robots of the catalogue that walk or trot."""
FEET = " on its feet"
"""End of the keys of gaits in the log of the catalogue."""


def packages() -> Iterator[tuple[str, re.Pattern[str] | None]]:
    """Yield requirements and, where a package holds legged robots, the pattern of their files."""
    for line in (HERE / "packages.txt").read_text().splitlines():
        words = line.split("#")[0].split()
        if words:
            yield words[0], re.compile(words[2]) if len(words) > 2 else None


def install(requirement: str, folder: Path) -> str:
    """Install a package into a folder of its own, and return what went wrong."""
    if folder.exists():
        return ""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(folder), requirement]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else done.stderr.strip().splitlines()[-1]


def files_of(folder: Path, most: int | None) -> list[Path]:
    """Return the URDF files of a package, sorted; ``most`` of them at most, spread evenly."""
    every = sorted(path for path in folder.rglob("*.urdf") if " type=" in path.read_text(errors="ignore"))
    if most is None or len(every) <= most:
        return every
    return [every[int(i)] for i in np.linspace(0, len(every) - 1, most).round()]


def outcome(source: str, legged: bool) -> dict[str, Any]:
    """Run one robot in a process of its own."""
    command = [sys.executable, str(HERE / "one_file.py"), source, *(["legged"] if legged else [])]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    fault: dict[str, Any] = {"load": "error", "agreement": None, "plans": []}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    lines = done.stdout.strip().splitlines()
    if done.returncode or not lines:
        return {**fault, "cause": f"exit {done.returncode}: {done.stderr.strip()[-200:]}"}
    return dict(json.loads(lines[-1]))


def row(found: dict[str, Any]) -> str:
    """Return the row of one file."""
    plans = found["plans"]
    proved = sum(plan["outcome"] == "proved" for plan in plans)
    feasible = [plan for plan in plans if plan["outcome"] != "infeasible"]
    misses = [f"{plan['kind']}: {plan['outcome']}, {plan['cause']}" for plan in feasible if plan["outcome"] != "proved"]
    still = f"{len(found['still'])} joints without limits at rest" if found.get("still") else ""
    folder = found["file"].removesuffix(found["key"])
    remark = (
        "; ".join(filter(None, [still, found["cause"], *misses]))
        .replace(folder, "")
        .replace("|", "/")
        .replace("\n", " ")
    )
    agreement = "" if found["agreement"] is None else f"{found['agreement']:.0e}"
    slowest = f"{max((plan['seconds'] for plan in feasible), default=0.0):.2f}"
    name = found["name"]
    cells = [found["package"], name, found.get("joints", ""), agreement, f"{proved} of {len(feasible)}", slowest]
    cells.append(("" if found["load"] == "ok" else f"{found['load']}: ") + remark[:160])
    return f"| {' | '.join(str(cell) for cell in cells)} |"


def summary(every: list[dict[str, Any]]) -> list[str]:
    """Return what the table adds up to."""
    lines = [
        f"- {len(every)} files of {len({each['package'] for each in every})} packages: "
        + ", ".join(f"{sum(e['load'] == kind for e in every)} {kind}" for kind in ("ok", "refused", "error")),
    ]
    compared = [each["agreement"] for each in every if each["agreement"] is not None]
    lines.append(f"- compared with the independent reader: {len(compared)}, largest difference {max(compared):.0e}")
    plans = [plan for each in every for plan in each["plans"]]
    for kind in sorted({plan["kind"] for plan in plans}):
        own = [plan for plan in plans if plan["kind"] == kind and plan["outcome"] != "infeasible"]
        seconds = np.array([plan["seconds"] for plan in own] or [np.nan])
        proved = sum(plan["outcome"] == "proved" for plan in own)
        lines.append(
            f"- {kind}: {proved} of {len(own)} proved; processor seconds: median {np.median(seconds):.2f}, "
            f"longest {np.max(seconds):.1f}"
        )
    return lines


def jobs_of_packages(folder: Path, names: Sequence[str], most: int | None) -> Iterator[Job]:
    """Install the packages one by one and yield their files."""
    for requirement, legged in packages():
        name = requirement.split("==")[0]
        if names and name not in names:
            continue
        fault = install(requirement, folder / name)
        if fault:
            print(f"{requirement} was not installed: {fault}")
        for path in files_of(folder / name, most):
            key = str(path.relative_to(folder))
            yield name, key, str(path), bool(legged and legged.search(key))


def jobs_of_catalogue(names: Sequence[str]) -> Iterator[Job]:
    """Yield the robots that are loaded by name."""
    for entry in rt.robot.catalogue():
        if not names or entry.name in names:
            yield entry.source, entry.name, entry.name, False
            if entry.name in LEGGED:
                yield entry.source, entry.name + FEET, entry.name, True


def run(jobs: Iterable[Job], log: Path) -> list[dict[str, Any]]:
    """Run the robots that the log does not have, and return its lines."""
    known = {each["key"]: each for each in map(json.loads, log.read_text().splitlines() if log.exists() else [])}
    try:
        for package, key, source, legged in jobs:
            if key in known:
                continue
            found = outcome(source, legged)
            known[key] = {"file": source, **found, "package": package, "key": key, "name": Path(key).name}
            with log.open("a") as out:
                out.write(json.dumps(known[key]) + "\n")
            print(row(known[key]), flush=True)
    except KeyboardInterrupt:
        print("stopped")
    return list(known.values())


def main() -> None:
    """Install, run and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", metavar="name", help="packages of the list, or robots; all by default")
    parser.add_argument("--files", type=int, help="files of each package at most")
    parser.add_argument("--catalogue", action="store_true", help="run the robots that are loaded by name")
    options = parser.parse_intermixed_args()
    folder = options.folder
    folder.mkdir(parents=True, exist_ok=True)
    if options.catalogue:
        title, command, table = "Robots of the catalogue", "FOLDER --catalogue", HERE / "CATALOGUE.md"
        found = run(jobs_of_catalogue(options.names), folder / "catalogue.jsonl")
        left = [entry.name for entry in rt.robot.catalogue()]
        left = [name for name in left if name not in {each["key"] for each in found}]
    else:
        title, command, table = "Robots of public packages", "FOLDER", HERE / "RESULTS.md"
        found = run(jobs_of_packages(folder, options.names, options.files), folder / "results.jsonl")
        left = [each for each, _ in packages() if each.split("==")[0] not in {line["package"] for line in found}]
    lines = [*summary(found), f"- not run: {', '.join(left) or 'none'}"]
    head = f"# {title}\n\nWritten by `python benchmarks/robots/run.py {command}`.\n\n"
    table.write_text(head + "\n".join([*lines, "", HEAD, *map(row, found)]) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
