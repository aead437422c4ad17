"""plan(tolerance=...): meshes that refine until the error holds, and say so where it does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj import adaptive
from robotraj.refinement import Assessment, Refinement, interval_errors

PENDULUM = rt.System(["q", "w"], ["u"], lambda point: [point.x["w"], point.u["u"] - 9.81 * ca.sin(point.x["q"])])


def swing_up(**more: Any) -> rt.Phase:
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    return rt.Phase(PENDULUM, 1.5, rt.State([0, 0]), rt.State([np.pi, 0]), effort, **more)


@pytest.fixture(scope="module")
def optimum() -> float:
    return rt.plan(swing_up(), rt.Mesh(30, rt.GaussLegendre(6)), solver=rt.Ipopt(1e-11)).objective


@pytest.mark.parametrize(
    "refinement", [rt.SplitAndMerge(), rt.RaiseOrder(), rt.SplitOrRaise()], ids=lambda r: type(r).__name__
)
@pytest.mark.parametrize(
    "scheme",
    [rt.Trapezoidal(), rt.HermiteSimpson(), rt.RadauIIA(3), rt.GaussLegendre(2)],
    ids=lambda s: type(s).__name__,
)
def test_every_refinement_of_every_family_reaches_the_tolerance(
    optimum: float, refinement: Refinement, scheme: Any
) -> None:
    solution = rt.plan(swing_up(), rt.Mesh(6, scheme), tolerance=1e-4, refinement=refinement)
    part = solution.phases[0]
    assert solution.success
    assert interval_errors(part.phase, part.trajectory).max() <= 1e-4
    assert solution.objective == pytest.approx(optimum, rel=1e-4)
    assert {type(s) for s in part.mesh.schemes} <= {type(scheme), rt.LobattoIIIA}


def test_a_tighter_tolerance_is_a_smaller_error(optimum: float) -> None:
    errors = [
        abs(rt.plan(swing_up(), tolerance=t, solver=rt.Ipopt(1e-11)).objective / optimum - 1)
        for t in (1e-3, 1e-5, 1e-8)
    ]
    assert errors[0] < 1e-3 and errors[1] < 1e-5 and errors[2] < 1e-8


def test_the_meshes_are_told_one_by_one() -> None:
    solution = rt.plan(swing_up(), rt.Mesh(5, rt.RadauIIA(3)), tolerance=1e-6)
    steps = solution.refinement
    assert steps[0].intervals == 5 and steps[0].points == 15
    assert steps[0].error > 1e-6 >= steps[-1].error
    assert steps[-1].objective == solution.objective
    assert abs(steps[-1].objective - steps[-2].objective) <= 0.5e-6 * solution.objective
    assert steps[-1].points == len(solution.phases[0].points)
    printed = str(solution)
    for i, step in enumerate(steps, 1):
        assert f"mesh {i}: {step.intervals} intervals, {step.points} points, error {step.error:.2e}" in printed


def test_each_mesh_starts_from_the_last() -> None:
    steps = rt.plan(swing_up(), tolerance=1e-7).refinement
    assert len(steps) >= 2
    assert all(step.iterations < steps[0].iterations for step in steps[1:])


@dataclass(frozen=True)
class Stubborn(Refinement):
    """Leaves every mesh as it is."""

    def refine(self, mesh: rt.Mesh, assessment: Assessment, tolerance: float) -> rt.Mesh:
        return mesh


def test_a_tolerance_that_is_not_reached_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(adaptive, "MOST_MESHES", 4)
    given = {"mesh": rt.Mesh(5, rt.RadauIIA(3)), "tolerance": 1e-9, "refinement": Stubborn()}
    solution = rt.plan(swing_up(), check=False, **given)
    assert solution.status is rt.Status.TOLERANCE_NOT_REACHED
    assert not solution.success
    assert len(solution.refinement) == 4 and solution.refinement[-1].error > 1e-9
    assert "tolerance not reached" in str(solution)
    with pytest.raises(rt.NoSolutionFound, match="tolerance not reached") as caught:
        rt.plan(swing_up(), **given)
    assert caught.value.solution.refinement[-1].error == solution.refinement[-1].error


def test_a_solve_that_fails_ends_the_refinement() -> None:
    short = swing_up(controls={"u": rt.between(-0.1, 0.1)})
    solution = rt.plan(short, tolerance=1e-6, check=False)
    assert not solution.success
    assert solution.status is not rt.Status.TOLERANCE_NOT_REACHED
    assert len(solution.refinement) == 1


@pytest.mark.parametrize("tolerance", [0, 1, -1e-6, np.nan])
def test_tolerances_that_make_no_sense(tolerance: float) -> None:
    with pytest.raises(rt.InputError, match="between 0 and 1"):
        rt.plan(swing_up(), tolerance=tolerance)


def test_schemes_without_residual_are_refused() -> None:
    with pytest.raises(rt.InputError, match="MultipleShooting"):
        rt.plan(swing_up(), rt.Mesh(5, rt.MultipleShooting()), tolerance=1e-6)


def test_rows_are_held_between_the_knots_of_every_mesh() -> None:
    """Bryson and Denham's limit is touched along an arc; no sample between the points lies above it."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    effort = rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2)
    limit = 1 / 9
    phase = rt.Phase(block, 1.0, rt.State([0, 1]), rt.State([0, -1]), effort, states={"x": rt.between(None, limit)})
    solution = rt.plan(phase, tolerance=1e-6)
    assert solution.objective == pytest.approx(4, rel=1e-6)
    assert solution.at(np.linspace(0, 1, 5001)).x["x"].max() <= limit + 1e-6
    free = rt.plan(phase, rt.Mesh(6, rt.RadauIIA(3)))
    assert free.at(np.linspace(0, 1, 5001)).x["x"].max() <= limit + 1e-3
