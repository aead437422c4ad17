"""Problems in TOML are those of the Python examples beside them."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt

EXAMPLES = Path(__file__).parents[3] / "examples"
FILES = sorted(EXAMPLES.glob("*.toml"))


class Planned(Exception):
    """Ends an example at its first plan."""


def first_call(script: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[rt.Problem | rt.Phase, Mapping[str, Any]]:
    """Problem and options of the first ``rt.plan`` of an example."""
    calls = []

    def recorded(problem: rt.Problem | rt.Phase, *meshes: rt.Mesh, **options: object) -> None:
        calls.append((problem, {**({"mesh": meshes[0]} if meshes else {}), **options}))
        raise Planned

    with monkeypatch.context() as patch:
        patch.setattr(rt, "plan", recorded)
        with pytest.raises(Planned):
            runpy.run_path(str(script), run_name="__main__")
    return calls[0]


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_the_problem_has_the_rows_of_the_example(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, options = first_call(file.with_suffix(".py"), monkeypatch)
    written = rt.load_problem(file)
    expected = problem if isinstance(problem, rt.Problem) else rt.Problem([problem])
    assert str(written.problem) == str(expected)
    assert repr(written.options) == repr(dict(options))


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_the_plan_is_that_of_the_example(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, options = first_call(file.with_suffix(".py"), monkeypatch)
    expected, found = rt.plan(problem, **options), rt.load_problem(file).plan()
    assert found.success and found.status is expected.status
    np.testing.assert_allclose(found.objective, expected.objective, rtol=1e-9)
    times = np.linspace(0, min(found.duration, expected.duration), 201)
    np.testing.assert_allclose(found.at(times).q, expected.at(times).q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.at(times).tau, expected.at(times).tau, rtol=1e-9, atol=1e-6)
