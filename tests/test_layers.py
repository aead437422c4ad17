"""Imports point down only: a module reads its own layer and those below, even where only types are checked."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "robotraj"

LAYERS: dict[int, tuple[str, ...]] = {
    0: (
        "chart",
        "errors",
        "lazily",
        "memory",
        "robot",
        "loading",
        "symbolic",
        "native",
        "polynomials",
        "splines",
        "sparse",
        "tangent",
        "terrain",
        "values",
    ),
    1: ("contacts", "design", "dynamics", "trajectory"),
    2: ("constraints", "objectives"),
    3: ("state", "links", "feasibility", "printing", "phase", "problem", "unrolled"),
    4: ("engines", "schemes", "guess", "guesses", "gait"),
    5: ("transcription", "refinement"),
    6: ("stagewise", "solvers", "status", "progress"),
    7: (
        "sample",
        "violations",
        "solution",
        "phase_solution",
        "records",
        "storage",
        "columns",
        "export",
        "plotting",
        "indirect",
        "retries",
        "sharpening",
        "starts",
        "solving",
    ),
    8: ("adaptive", "kinematic", "stages", "compiling", "planning"),
    9: ("workers", "sweep", "multistart", "demos"),
    10: ("arguments", "cli", "cli_engines", "__main__", "__init__"),
}
"""DESIGN.md's layers, with the files that each holds."""

WITNESSES = ("witness", "replay")
"""They check and show the answer without the code that made it: layers 0 to 3 and themselves, nothing else."""

LAYER_OF = {name: layer for layer, names in LAYERS.items() for name in names}
MODULES = sorted(path for path in PACKAGE.rglob("*.py"))


def part_of(path: Path) -> str:
    """First name of a module below the package: the file or the folder that stands in the table."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported_parts(path: Path) -> list[tuple[str, int]]:
    """Parts of the package a file imports, with line numbers; ``__init__`` for the package itself."""
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: a relative import"
            names = [
                f"{node.module}.{alias.name}" if node.module == "robotraj" else str(node.module) for alias in node.names
            ]
        else:
            continue
        parts = [name.split(".") for name in names if name.split(".")[0] == "robotraj"]
        found += [(part[1] if len(part) > 1 else "__init__", node.lineno) for part in parts]
    return found


def identify(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


@pytest.mark.parametrize("path", MODULES, ids=identify)
def test_every_module_has_a_layer_and_imports_point_down(path: Path) -> None:
    part = part_of(path)
    if part in WITNESSES:
        above = [
            f"line {line}: {other}"
            for other, line in imported_parts(path)
            if LAYER_OF.get(other, 0 if other == part else 99) > 3
        ]
    else:
        assert part in LAYER_OF, f"give {part} a layer"
        above = [
            f"line {line}: {other}"
            for other, line in imported_parts(path)
            if (LAYER_OF.get(other, 99) > LAYER_OF[part] if other not in WITNESSES else LAYER_OF[part] < 9)
        ]
    assert not above, f"{identify(path)} imports from above: {above}"


@pytest.mark.parametrize("path", [p for p in MODULES if part_of(p) == "symbolic"], ids=identify)
def test_symbolic_stands_alone(path: Path) -> None:
    assert {part for part, _ in imported_parts(path)} <= {"errors", "symbolic", "values"}


@pytest.mark.parametrize("folder", ["schemes", "solvers", "transcription"])
def test_schemes_transcription_and_solvers_know_nothing_of_robots(folder: str) -> None:
    for path in (PACKAGE / folder).glob("*.py"):
        assert not {part for part, _ in imported_parts(path)} & {"robot", "loading", "symbolic"}, path


def test_imports_in_functions_and_for_types_alone_are_seen(tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text(
        "from typing import TYPE_CHECKING\n"
        "import robotraj._util.errors\n"
        "if TYPE_CHECKING:\n"
        "    from robotraj.solution.solution import Solution\n"
        "def late():\n"
        "    from robotraj import planning\n"
    )
    assert imported_parts(path) == [("errors", 2), ("solution", 4), ("planning", 6)]
