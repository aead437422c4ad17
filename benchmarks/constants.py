"""What each constant does: `python benchmarks/constants.py [FOLDER or FILE ...] [--only NAME ...] [--write]`.

Each constant of the modules is multiplied and divided by ``FACTOR``, in a process of its own whose modules are compiled
with the other value. That process plans problems of ``benchmarks/frozen``, each of another kind, whose plans enter a
function that reads the constant. ``constants.md`` keeps the table, and a test compares its names and values with those
of the files. With ``--only`` rows of other constants are kept where their values are the same. A constant without any
effect decides nothing: it can be derived or removed.
"""

from __future__ import annotations

import argparse
import ast
import cProfile
import csv
import importlib.abc
import importlib.util
import json
import subprocess
import sys
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np

HERE = Path(__file__).parent
PACKAGE = HERE.parent / "robotraj"
TABLE, PLACES = HERE / "constants.md", HERE / "frozen" / "RESULTS.csv"
FILES = ("planning/loop/local_optimum.py", "planning/loop/measures.py")
FACTOR = 3.0
QUICK, EVERY, MOST = 1.5, 12, 8
"""Processor seconds of the problems that are used, every how many of them, and how many a constant has at most."""
HEAD = """# What each constant does

`python benchmarks/constants.py --write`: a constant times 3 and divided by 3, beside the constant itself, on problems
of `benchmarks/frozen` whose plans read it. For both, the columns are the number of plans that differ, the ratio of all
iterations, plans that are proved more or fewer, and the largest rise of an objective in percent.

| constant | value | problems | x 3: differ | iterations | proved | rise | / 3: differ | iterations | proved | rise |
|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|
"""


@dataclass(frozen=True)
class Number:
    """A constant of a module, with the functions that read it; None where it is read when modules are imported."""

    file: str
    name: str
    value: str
    readers: frozenset[tuple[str, int]] | None

    @property
    def module(self) -> str:
        """Name of the module."""
        return ".".join(("robotraj", *Path(self.file).with_suffix("").parts))


def numbers(rooms: Sequence[str]) -> Iterator[Number]:
    """Yield the constants of the modules of some rooms, or of single files."""
    trees = {str(file.relative_to(PACKAGE)): ast.parse(file.read_text()) for file in sorted(PACKAGE.rglob("*.py"))}
    for file, tree in trees.items():
        if not any(file == room or file.startswith(f"{room}/") for room in rooms):
            continue
        for name, value in _constants(tree):
            yield Number(file, name, ast.unparse(value), _readers(trees, file, name))


def _constants(tree: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    for statement in tree.body:
        if not isinstance(statement, ast.Assign):
            continue
        target, value = statement.targets[0], statement.value
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            pairs = list(zip(target.elts, value.elts, strict=False))
        else:
            pairs = [(target, value)]
        for own, number in pairs:
            if isinstance(own, ast.Name) and own.id.lstrip("_").isupper() and _is_number(number):
                yield own.id, number


def _is_number(node: ast.expr) -> bool:
    if isinstance(node, ast.Tuple):
        return bool(node.elts) and all(map(_is_number, node.elts))
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _readers(trees: dict[str, ast.Module], file: str, name: str) -> frozenset[tuple[str, int]] | None:
    """Return file and first line of the functions that read a constant."""
    found: set[tuple[str, int]] = set()
    module = ".".join(("robotraj", *Path(file).with_suffix("").parts))
    for other, tree in trees.items():
        own = name if other == file else _imported_as(tree, module, name)
        if own is None:
            continue
        inside: set[ast.AST] = set()
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef):
                reading = [n for n in ast.walk(function) if _reads(n, own)]
                if reading:
                    inside.update(reading)
                    found.add((other, min(n.lineno for n in [function, *function.decorator_list])))
        if any(_reads(n, own) and n not in inside for n in ast.walk(tree)):
            return None
    return frozenset(found)


def _reads(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Load)


def _imported_as(tree: ast.Module, module: str, name: str) -> str | None:
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module == module:
            for alias in node.names:
                if alias.name == name:
                    return alias.asname or name
    return None


class Changed(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Compiles one module with another value of a constant."""

    def __init__(self, module: str, name: str, factor: float) -> None:
        self.module, self.name, self.factor = module, name, factor

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> object:
        """Find the changed module."""
        return importlib.util.spec_from_loader(fullname, self) if fullname == self.module else None

    def exec_module(self, module: ModuleType) -> None:
        """Compile the module with the other value."""
        file = PACKAGE.joinpath(*self.module.split(".")[1:]).with_suffix(".py")
        tree = ast.parse(file.read_text())
        for name, value in _constants(tree):
            for node in ast.walk(value) if name == self.name else ():
                if isinstance(node, ast.Constant):
                    node.value = _times(node.value, self.factor)
        module.__file__ = str(file)
        exec(compile(tree, str(file), "exec"), module.__dict__)


def _times(value: float, factor: float) -> float:
    """Return another value; counts stay counts of at least 1, and shares of a whole stay below 1."""
    if isinstance(value, int):
        return max(1, round(value * factor))
    return value * factor if value >= 1.0 or value * factor < 1.0 else 0.5 * (1.0 + value)


def planned(places: Iterable[tuple[str, int]], profiled: bool = False) -> list[dict[str, object]]:
    """Plan problems of benchmarks/frozen; return their rows, with the functions that were entered where profiled."""
    sys.path.insert(0, str(HERE / "frozen"))
    from run import planned as plan

    warnings.simplefilter("ignore")
    rows: list[dict[str, object]] = []
    for kind, number in places:
        profile = cProfile.Profile()
        row = dict(profile.runcall(plan, kind, number) if profiled else plan(kind, number))
        if profiled:
            codes = [entry.code for entry in profile.getstats() if not isinstance(entry.code, str)]
            files = [(Path(code.co_filename), code.co_firstlineno) for code in codes]
            row["entered"] = [(str(f.relative_to(PACKAGE)), line) for f, line in files if f.is_relative_to(PACKAGE)]
        rows.append(row)
    return rows


def in_process(*arguments: str, places: Sequence[tuple[str, int]]) -> list[dict[str, object]]:
    """Plan in a process of its own."""
    command = [sys.executable, __file__, "--child", *arguments]
    done = subprocess.run(command, input=json.dumps(places), capture_output=True, text=True, check=True)
    return list(json.loads(done.stdout.splitlines()[-1]))


def effect(before: Sequence[dict[str, object]], after: Sequence[dict[str, object]]) -> str:
    """Return the cells of a changed number."""
    other, gained, rise = 0, 0, 0.0
    for a, b in zip(before, after, strict=True):
        other += any(a[key] != b[key] for key in ("proved", "iterations", "meshes", "objective"))
        gained += (b["proved"] != "no") - (a["proved"] != "no")
        if "no" not in (a["proved"], b["proved"]):
            low, high = float(str(a["objective"])), float(str(b["objective"]))
            rise = max(rise, (high - low) / max(abs(low), 1e-2))
    counts = [sum(int(str(row["iterations"]) or 0) for row in rows) for rows in (after, before)]
    return f"{other} | {counts[0] / max(counts[1], 1):.2f} | {gained:+d} | {100 * rise:.2f}"


def main() -> None:
    """Print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("rooms", nargs="*", default=list(FILES))
    parser.add_argument("--only", nargs="+", metavar="NAME")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--child", nargs=3, metavar=("MODULE", "NAME", "FACTOR"))
    given = parser.parse_args()
    if given.child:
        module, name, factor = given.child
        if module != "-":
            sys.meta_path.insert(0, Changed(module, name, float(factor)))
        places = [(kind, number) for kind, number in json.loads(sys.stdin.read())]
        print(json.dumps(planned(places, profiled=module == "-")))
        return
    with PLACES.open(newline="") as file:
        quick = [row for row in csv.DictReader(file) if float(row["seconds"]) < QUICK]
    places = [(row["kind"], int(row["number"])) for row in quick[::EVERY]]
    before = in_process("-", "-", "1", places=places)
    table = TABLE.read_text().splitlines()
    lines = []
    for number in numbers(given.rooms):
        readers, cells = number.readers, [f"{number.file} {number.name}", number.value]
        kept = [row for row in table if row.startswith(f"| {' | '.join(cells)} |")]
        if given.only and number.name not in given.only and kept:
            lines += kept
            continue
        own = [
            (place, row)
            for place, row in zip(places, before, strict=True)
            if readers is None or any(tuple(each) in readers for each in row["entered"])  # type: ignore[attr-defined]
        ]
        kinds = {own[i][0][0]: own[i] for i in np.random.default_rng(0).permutation(len(own))}
        own = list(kinds.values())[:MOST]
        cells.append(str(len(own)))
        for factor in (FACTOR, 1.0 / FACTOR) if own else ():
            after = in_process(number.module, number.name, str(factor), places=[place for place, _ in own])
            cells.append(effect([row for _, row in own], after))
        lines.append(f"| {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    if given.write:
        TABLE.write_text(HEAD + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
