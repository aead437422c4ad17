"""Public names: listed once, imported when asked for."""

from __future__ import annotations

import ast
import importlib
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import robotraj as rt

PACKAGES = [
    "robotraj",
    *(
        f"robotraj.{part}"
        for part in (
            "constraints",
            "contacts",
            "design",
            "dynamics",
            "engines",
            "guesses",
            "links",
            "objectives",
            "refinement",
            "schemes",
            "solvers",
            "terrain",
        )
    ),
]

HEAVY = (
    "concurrent.futures",
    "importlib.metadata",
    "matplotlib",
    "meshcat",
    "numpy.ma",
    "numpy.polynomial",
    "rich",
    "scipy",
    "subprocess",
    "tempfile",
    "trimesh",
    "typer",
)
ELSEWHERE = ("multistart", "plotting", "replay", "storage", "witness")


def fresh(code: str) -> str:
    """Output of a program in a process of its own."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize("name", PACKAGES)
def test_the_stub_lists_each_name_where_it_is(name: str) -> None:
    package = importlib.import_module(name)
    tree = ast.parse(Path(str(package.__file__)).with_suffix(".pyi").read_text())
    (listed,) = (ast.literal_eval(node.value) for node in tree.body if isinstance(node, ast.Assign))
    assert listed == sorted(listed) == package.__all__
    for public in listed:
        assert getattr(package, public) is not None
        assert public in dir(package)


def test_a_plan_imports_nothing_that_it_does_not_need() -> None:
    # What the libraries themselves import differs from release to release.
    loaded = fresh(
        "import sys, numpy, casadi, pinocchio\n"
        "theirs = set(sys.modules)\n"
        "import robotraj as rt\n"
        "phase = rt.Phase(rt.load('pendulum'), duration=1.0, start=rt.State(q=0, v=0), end=rt.State(q=1, v=0),\n"
        "                 objective=rt.Effort())\n"
        "rt.plan(phase, rt.Mesh(5, rt.Trapezoidal()), rt.StraightLine(1.0))\n"
        "print(*(set(sys.modules) - theirs))"
    ).split()
    assert "robotraj.planning" in loaded
    assert not {*HEAVY, *(f"robotraj.{part}" for part in ELSEWHERE)} & set(loaded)


def test_functions_are_not_hidden_by_modules_of_their_names() -> None:
    code = (
        "import robotraj.{0}\nimport robotraj as rt\nfrom robotraj import {0}\nprint(callable(rt.{0}), callable({0}))"
    )
    for name in ("replay", "sweep", "multistart"):
        assert fresh(code.format(name)) == "True True"


def test_names_nobody_has_are_refused() -> None:
    with pytest.raises(AttributeError, match="no attribute 'plam'"):
        rt.plam  # type: ignore[attr-defined]  # noqa: B018
    assert not hasattr(rt, "__wrapped__")


def test_functions_and_classes_travel() -> None:
    for value in (rt.multistart, rt.Effort, rt.PointContact):
        assert pickle.loads(pickle.dumps(value)) is value
