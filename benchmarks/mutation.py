"""Mutation score by room, from a seeded sample: `python benchmarks/mutation.py [--each 10] [ROOM...]`.

A mutant is a copy of the package with one operator or constant changed in one function. It is killed if a test of its
room fails. Each file is written into a copy of the package that stands before the real one on the path. The rows of the
rooms that were run replace those in mutation.md.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = {
    "transcription/schemes": "tests/transcription/schemes",
    "transcription/collocation": "tests/transcription/collocation tests/transcription/schemes",
    "transcription/interval_limits": "tests/transcription/interval_limits",
    "transcription/refinement": "tests/transcription/refinement",
    "witness/simulation": "tests/witness/simulation",
    "witness/checks": "tests/witness/checks tests/witness/simulation/test_systems.py "
    "tests/witness/test_real_plans.py tests/witness/test_validation.py",
    "witness/robustness": "tests/witness/robustness",
}
"""Folders of the package, and the tests that are run for them."""
SEED = 22
LONGEST = 1800.0
"""Longest time of the tests without a change [s]."""
PATIENCE = 3.0
"""Longest time of the tests of a mutant, over their time without a change; a mutant that hangs is killed."""

TABLE = Path(__file__).with_suffix(".md")
HEAD = """\
# Mutation score by room

Written by `python benchmarks/mutation.py --each N`: a seeded sample of changed operators and constants, and how many
of them the fast tests of the room notice. Survivors are listed below: no test of the room notices such a change. Either
it changes nothing that matters (a tolerance, a cache, a margin), or a test is missing.

| room | mutants | killed | score |
|---|---|---|---|
"""

SWAPS: dict[type, type] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
}


def places(tree: ast.AST) -> list[ast.AST]:
    """Nodes inside functions that can be changed."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return list(dict.fromkeys(node for function in functions for node in ast.walk(function) if _can_change(node)))


def _can_change(node: ast.AST) -> bool:
    if isinstance(node, ast.Constant):
        return type(node.value) in (int, float)
    if isinstance(node, ast.Compare):
        return type(node.ops[0]) in SWAPS
    return isinstance(node, ast.BinOp | ast.BoolOp) and type(node.op) in SWAPS


def change(node: ast.AST) -> str:
    """Change a node; return what was done."""
    line = getattr(node, "lineno", 0)
    if isinstance(node, ast.Constant):
        before, node.value = node.value, node.value + 1
        return f"{line}: {before} becomes {node.value}"
    if isinstance(node, ast.Compare):
        before, node.ops[0] = type(node.ops[0]), SWAPS[type(node.ops[0])]()
        return f"{line}: {before.__name__} becomes {type(node.ops[0]).__name__}"
    before, node.op = type(node.op), SWAPS[type(node.op)]()
    return f"{line}: {before.__name__} becomes {type(node.op).__name__}"


def mutants(room: str, count: int) -> list[tuple[Path, int]]:
    """Return a seeded sample of files and numbers of their places."""
    every = [
        (path, number)
        for path in sorted((ROOT / "robotraj" / room).glob("*.py"))
        for number in range(len(places(ast.parse(path.read_text()))))
    ]
    return random.Random(f"{SEED} {room}").sample(every, min(count, len(every)))


def failure(copy: Path, tests: str, limit: float) -> str:
    """Return how the tests of a room fail with the copied package within a time limit [s]; empty if they pass."""
    environment = {**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-x", "-m", "not slow", "-c", str(ROOT / "pyproject.toml"),
             *(str(ROOT / test) for test in tests.split())],
            cwd=copy, env=environment, capture_output=True, text=True, timeout=limit, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"longer than {limit:.0f} s"
    return "" if done.returncode == 0 else done.stdout[-2000:] + done.stderr[-2000:]


def write(rows: dict[str, str], survivors: dict[str, list[str]]) -> None:
    """Write the table; rooms that were not run keep their rows and survivors."""
    for line in TABLE.read_text(encoding="utf-8").splitlines() if TABLE.exists() else ():
        cells = line.split("|")
        if len(cells) > 2 and cells[1].strip() in ROOMS:
            rows.setdefault(cells[1].strip(), line)
        elif line.startswith("- robotraj/"):
            room = next(room for room in ROOMS if line.startswith(f"- robotraj/{room}/"))
            if room not in survivors:
                survivors.setdefault(f"kept {room}", []).append(line)
    lines = [rows[room] for room in ROOMS if room in rows]
    left = [line for room in ROOMS for key in (room, f"kept {room}") for line in survivors.get(key, ())]
    TABLE.write_text("\n".join([HEAD + "\n".join(lines), "", "Survivors:", "", *left]) + "\n", encoding="utf-8")


def main() -> None:
    """Print a row for each room and its survivors, and write both to the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rooms", nargs="*", default=list(ROOMS))
    parser.add_argument("--each", type=int, default=10)
    given = parser.parse_args()
    rows: dict[str, str] = {}
    survivors: dict[str, list[str]] = {}
    print("| room | mutants | killed | score |\n|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(ROOT / "robotraj", Path(folder) / "robotraj", ignore=shutil.ignore_patterns("__pycache__"))
        if (ROOT / "robots").is_dir():
            os.symlink(ROOT / "robots", Path(folder) / "robots")
        for room in given.rooms:
            start = time.monotonic()
            if how := failure(Path(folder), ROOMS[room], LONGEST):
                raise SystemExit(f"{room}: its tests fail without a change: {how}")
            limit = PATIENCE * (time.monotonic() - start)
            killed, sample = 0, mutants(room, given.each)
            survivors[room] = []
            for count, (path, number) in enumerate(sample, 1):
                target = Path(folder) / path.relative_to(ROOT)
                tree = ast.parse(path.read_text())
                done = change(places(tree)[number])
                target.write_text(ast.unparse(tree))
                if failure(Path(folder), ROOMS[room], limit):
                    killed += 1
                else:
                    survivors[room].append(f"- {path.relative_to(ROOT)}:{done}")
                target.write_text(path.read_text())
                # An interrupted run leaves a row for the mutants that it tried.
                rows[room] = f"| {room} | {count} | {killed} | {100 * killed / count:.0f} % |"
                write(rows.copy(), survivors.copy())
            print("\n".join([rows[room], *survivors[room]]), flush=True)


if __name__ == "__main__":
    main()
