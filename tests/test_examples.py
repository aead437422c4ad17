"""Every example runs from an empty directory, its derivatives are right, and its optima are those of optima.json.

``ROBOTRAJ_WRITE_OPTIMA=1 pytest tests/test_examples.py`` writes the table again, after a change that moves an optimum.
"""

from __future__ import annotations

import json
import os
import runpy
from collections.abc import Callable
from copy import copy, deepcopy
from pathlib import Path

import cloudpickle
import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh import posed as posing
from tests.programs import nlp_of

OPTIMA = Path(__file__).with_name("optima.json")
SETTLED = 2e-3
"""Relative difference of optima: the default call settles an objective to 1e-3."""
EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("[0-9]*.py"))


def small(problem: rt.Problem, meshes: object) -> rt.transcription.Nlp:
    """Transcribe a problem of an example on meshes of two intervals, with the example's schemes."""
    given = [meshes] * len(problem.phases) if isinstance(meshes, rt.Mesh) else list(meshes)  # type: ignore[call-overload]
    return nlp_of(problem, [type(mesh)(2, mesh.schemes[0]) for mesh in given])


def assert_derivatives(nlp: rt.transcription.Nlp) -> None:
    """Gradient, Jacobian and Hessian along random directions agree with differences of fourth order to 1e-6.

    Differences of second order err by more than that on the short ramps of stairs.
    """
    random = np.random.default_rng(7)
    lower, upper = (
        np.clip(side, nlp.guess - 0.3 * nlp.scale, nlp.guess + 0.3 * nlp.scale)
        for side in (nlp.variables.lower, nlp.variables.upper)
    )
    w = random.uniform(lower, upper)
    multipliers = random.normal(size=len(nlp.rows)) * nlp.row_scale
    step = 1e-5

    def slope(function: object, direction: np.ndarray) -> np.ndarray:
        near, far = (function(w + k * direction) - function(w - k * direction) for k in (step, 2 * step))  # type: ignore[operator]
        return (8 * near - far) / (12 * step)

    for _ in range(4):
        direction = random.normal(size=len(w)) * nlp.scale
        rows = slope(nlp.values, direction) * nlp.row_scale
        exact = nlp.jacobian(w) @ direction * nlp.row_scale
        assert np.max(np.abs(rows - exact)) < 1e-6 * (1 + np.max(np.abs(exact)))
        cost = slope(nlp.objective, direction)
        assert abs(cost - nlp.gradient(w) @ direction) < 1e-6 * (1 + abs(cost))
        bent = slope(lambda v: nlp.gradient(v) + nlp.jacobian(v).T @ multipliers, direction) * nlp.scale
        curved = nlp.hessian(w, multipliers) @ direction * nlp.scale
        assert np.max(np.abs(bent - curved)) < 1e-6 * (1 + np.max(np.abs(curved)))


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_its_derivatives_agree_with_finite_differences(
    example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    seen: list[tuple[rt.Problem, object]] = []
    real = posing.transcribe

    def recorded(problem: rt.Problem, mesh: object, *more: object) -> rt.transcription.Nlp:
        seen.append((problem, mesh))
        return real(problem, mesh, *more)  # type: ignore[arg-type]

    objectives: list[float] = []

    def kept(planner: Callable[..., rt.Solution]) -> Callable[..., rt.Solution]:
        def planned(*arguments: object, **options: object) -> rt.Solution:
            solution = planner(*arguments, **options)
            objectives.append(solution.objective)
            return solution

        return planned

    monkeypatch.setattr(posing, "transcribe", recorded)
    for name in ("plan", "retime"):
        monkeypatch.setattr(rt, name, kept(getattr(rt, name)))
    runpy.run_path(str(example), run_name="__main__")
    assert seen
    known = json.loads(OPTIMA.read_text()) if OPTIMA.exists() else {}
    if os.environ.get("ROBOTRAJ_WRITE_OPTIMA"):
        known[example.stem] = objectives
        OPTIMA.write_text(json.dumps(dict(sorted(known.items())), indent=1) + "\n")
    np.testing.assert_allclose(objectives, known[example.stem], rtol=SETTLED, atol=1e-6)
    for problem, mesh in {id(problem): (problem, mesh) for problem, mesh in seen}.values():
        for copied in (copy(problem), deepcopy(problem), cloudpickle.loads(cloudpickle.dumps(problem))):
            assert str(copied) == str(problem)
        assert_derivatives(small(problem, mesh))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short(example: Path) -> None:
    assert len(example.read_text().splitlines()) < 40
