"""Imports go to lower rooms only, have no circle inside a room, and every folder has at most 15 files.

Imports inside functions and those for types alone count as well.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable
from pathlib import Path

import pytest

import robotraj as rt

PACKAGE = Path(__file__).parents[1] / "robotraj"

ROOMS = (
    ("_util",),
    ("native", "symbolic", "robot"),
    ("dynamics",),
    ("problem",),
    ("guess", "transcription"),
    ("gait", "solvers"),
    ("solution",),
    ("fixed_mesh", "indirect", "replay_page", "witness"),
    ("planning",),
    ("applications",),
    ("cli",),
)
"""Floors in ascending order. Rooms on one floor do not import each other, such as the readers of a solution."""

FLOOR = {room: floor for floor, rooms in enumerate(ROOMS) for room in rooms}

CLOSED = {
    "replay_page": {"transcription", "solvers"},
    "witness": {"transcription", "solvers"},
}
"""Lower rooms that a room may not import: code that checks a plan shares none with code that makes it."""
SOLVES_AGAIN = "robotraj.witness.cost.finer_motions"
"""The one module of the witness that shares code with the planner: a solve from a plan may find a better motion."""


def module_of(path: Path, package: Path) -> str:
    """Dotted name of a file below the package; a package's is that of its folder."""
    parts = path.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(path: Path, modules: Iterable[str]) -> set[str]:
    """Modules of the package that a file imports, at any level of nesting."""
    known, found = set(modules), set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: a relative import"
            full = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in known else str(node.module) for name in full}
    return found & known


def graph_of(package: Path) -> dict[str, set[str]]:
    """Every module of the package with those that it imports."""
    paths = {module_of(path, package): path for path in sorted(package.rglob("*.py"))}
    return {name: imports_of(path, paths) - {name} for name, path in paths.items()}


def circles(graph: dict[str, set[str]]) -> list[str]:
    """Modules that are left after repeated removal of those that import nothing or that nothing imports."""
    left = {name: set(needed) for name, needed in graph.items()}
    while True:
        wanted = set().union(*left.values()) if left else set()
        kept = {name: needed & left.keys() for name, needed in left.items() if needed & left.keys() and name in wanted}
        if kept == left:
            return sorted(left)
        left = kept


GRAPH = graph_of(PACKAGE)
INSIDE = sorted(name for name in GRAPH if "." in name and name != "robotraj.__main__")


def room_of(module: str) -> str:
    return module.split(".")[1]


def test_every_folder_is_a_room_and_nothing_lies_loose_beside_them() -> None:
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir() and path.name not in ("__pycache__", "robots")}
    assert folders == set(FLOOR)
    assert {path.name for path in PACKAGE.glob("*.py")} == {"__init__.py", "__main__.py"}


@pytest.mark.parametrize("module", INSIDE)
def test_imports_point_down(module: str) -> None:
    own = room_of(module)
    others = {room_of(name): name for name in GRAPH[module] if name != "robotraj" and room_of(name) != own}
    assert "robotraj" not in GRAPH[module], "a module imports the package's face"
    closed = () if module == SOLVES_AGAIN else CLOSED.get(own, ())
    above = [name for room, name in others.items() if FLOOR[room] >= FLOOR[own] or room in closed]
    assert not above


def test_the_longest_chain_of_imports_passes_eleven_rooms() -> None:
    """Counted from the imports themselves, not from the order of floors above."""
    rooms = {
        room: {room_of(name) for module in INSIDE if room_of(module) == room for name in GRAPH[module]} - {room}
        for room in FLOOR
    }
    assert len(rooms) == 18

    def height(room: str) -> int:
        return 1 + max(map(height, rooms[room]), default=0)

    assert max(map(height, rooms)) == len(ROOMS) == 11


def test_no_module_imports_in_a_circle() -> None:
    assert not circles(GRAPH)


@pytest.mark.parametrize("folder", sorted({path.parent for path in PACKAGE.rglob("*.py")}), ids=lambda f: f.name)
def test_a_folder_is_small_and_has_a_docstring(folder: Path) -> None:
    assert len([path for path in folder.iterdir() if path.suffix in (".py", ".js", ".css", ".html")]) <= 15
    assert len(ast.get_docstring(ast.parse((folder / "__init__.py").read_text())) or "") > 40


@pytest.mark.parametrize("room", sorted(FLOOR))
def test_the_docstring_of_a_room_names_its_first_file_and_its_imports(room: str) -> None:
    doc = ast.get_docstring(ast.parse((PACKAGE / room / "__init__.py").read_text())) or ""
    assert "Start with" in doc and "may import" in doc


def test_rooms_are_not_named_as_public_functions() -> None:
    names = {name for name in rt.__all__ if not isinstance(getattr(rt, name), type(rt))}
    assert not names & set(FLOOR)


def test_no_class_name_is_defined_twice() -> None:
    places: dict[str, list[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                places.setdefault(node.name, []).append(module_of(path, PACKAGE))
    assert len(places) > 100
    assert not {name: modules for name, modules in places.items() if len(modules) > 1}


def test_tests_mirror_the_rooms() -> None:
    tests = Path(__file__).parent
    folders = {path.name for path in tests.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders - {"cases", "fuzz", "robots"} <= set(FLOOR)
    inside = {path.relative_to(tests).parts[:2] for room in FLOOR for path in (tests / room).rglob("test_*.py")}
    for room, name in inside:
        if not name.endswith(".py"):
            assert (PACKAGE / room / name).is_dir(), f"tests/{room}/{name} mirrors no folder"


def test_tests_that_bear_the_name_of_a_file_mirror_its_place() -> None:
    tests = Path(__file__).parent
    for test in sorted(path for room in FLOOR for path in (tests / room).rglob("test_*.py")):
        room, folder, name = PACKAGE / test.relative_to(tests).parts[0], test.parent, f"{test.stem[5:]}.py"
        # The page is also tested in a browser, in a folder of its own.
        places = [path.parent for path in room.rglob(name)] if folder.name != "web" else []
        assert not places or PACKAGE / folder.relative_to(tests) in places, f"{test} mirrors {name} in {places}"


def test_the_counting_of_imports_sees_functions_types_and_circles(tmp_path: Path) -> None:
    package = tmp_path / "thing"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from thing.b import B\n")
    (package / "b.py").write_text("def late():\n    from thing import a\n")
    (package / "c.py").write_text("import thing.a\n")
    graph = graph_of(package)
    assert graph["thing.a"] == {"thing.b"} and graph["thing.b"] == {"thing.a"} and graph["thing.c"] == {"thing.a"}
    assert circles(graph) == ["thing.a", "thing.b"]
