"""The next mesh, from errors on the last one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robotraj as rt
from robotraj.transcription.refinement.base import Assessment, Refinement, points_of

SMOOTH, TOLERANCE = 3.0, 1e-6
EVERY = [rt.refinement.SplitAndMerge(), rt.refinement.RaiseOrder(), rt.refinement.SplitOrRaise()]


def seen(
    errors: Any,
    jumps: Any = 0.0,
    decays: Any = SMOOTH,
    broken: Any = 0.0,
    settled: bool = True,
    coarse: Any = 0.0,
) -> Assessment:
    errors = np.asarray(errors, dtype=float)
    further = (np.broadcast_to(value, errors.shape) for value in (jumps, decays, broken))
    return Assessment(errors, *further, settled, np.broadcast_to(coarse, errors.shape))


def points(mesh: rt.Mesh) -> list[int]:
    return [points_of(scheme) for scheme in mesh.schemes]


def assert_same(mesh: rt.Mesh, other: rt.Mesh) -> None:
    np.testing.assert_array_equal(mesh.knots, other.knots)
    assert mesh.schemes == other.schemes


def test_splitting_cuts_by_the_order_of_the_residual() -> None:
    """With 3 points the error falls as h^4: 2 e / tolerance = 16 takes 2 parts, 81 takes 3, a million at most 4."""
    mesh = rt.Mesh(4, rt.schemes.RadauIIA(3))
    errors = np.array([8, 40, 1e6, 0.5]) * TOLERANCE
    refined = rt.refinement.SplitAndMerge().refine(mesh, seen(errors), TOLERANCE)
    np.testing.assert_allclose(
        refined.knots, [0, 1 / 8, 1 / 4, 1 / 3, 5 / 12, 1 / 2, 9 / 16, 5 / 8, 11 / 16, 3 / 4, 1], atol=1e-15
    )
    assert points(refined) == [3] * 10


def test_splitting_merges_neighbours_far_below_the_tolerance() -> None:
    mesh = rt.Mesh(4, rt.schemes.RadauIIA(3))
    quiet = seen(np.array([1e-5, 1e-5, 1e-5, 4]) * TOLERANCE)
    assert list(rt.refinement.SplitAndMerge().refine(mesh, quiet, TOLERANCE).knots) == [0, 0.5, 0.75, 0.875, 1]
    # 1e-3 of the tolerance becomes 0.016 of it in an interval of twice the length: too near.
    near = seen(np.array([1e-3, 1e-3, 1e-3, 0.9]) * TOLERANCE)
    assert_same(rt.refinement.SplitAndMerge().refine(mesh, near, TOLERANCE), mesh)
    switch = seen(np.full(4, 1e-5 * TOLERANCE), jumps=[0.0, 0.1, 0.1, 0.0])
    assert_same(rt.refinement.SplitAndMerge().refine(mesh, switch, TOLERANCE), mesh)


@pytest.mark.parametrize("refinement", [rt.refinement.SplitAndMerge(), rt.refinement.SplitOrRaise()], ids=["h", "hp"])
@pytest.mark.parametrize(
    "scheme",
    [rt.schemes.MultipleShooting(), rt.schemes.SingleShooting(), rt.schemes.CompressedHermiteSimpson()],
    ids=lambda s: type(s).__name__,
)
def test_schemes_without_order_are_split_by_the_fourth_power_and_never_merged(refinement: Any, scheme: Any) -> None:
    mesh = rt.Mesh(4, scheme)
    refined = refinement.refine(mesh, seen(np.array([8, 40, 1e-9, 1e-9]) * TOLERANCE), TOLERANCE)
    np.testing.assert_allclose(refined.knots, [0, 1 / 8, 1 / 4, 1 / 3, 5 / 12, 1 / 2, 3 / 4, 1], atol=1e-15)
    assert set(refined.schemes) == {scheme}


def test_the_coarsest_controls_of_shooting_are_halved_until_the_objective_has_settled() -> None:
    mesh = rt.Mesh(4, rt.schemes.MultipleShooting())
    small = np.full(4, 0.1 * TOLERANCE)
    halved = rt.refinement.SplitAndMerge().refine(
        mesh, seen(small, coarse=[0.05, 0.3, 0.6, 0.05], settled=False), TOLERANCE
    )
    np.testing.assert_allclose(halved.knots, [0, 0.25, 0.375, 0.5, 0.625, 0.75, 1])
    every = rt.refinement.SplitAndMerge().refine(mesh, seen(small, coarse=0.0, settled=False), TOLERANCE)
    assert every.count == 8
    assert_same(rt.refinement.SplitAndMerge().refine(mesh, seen(small, coarse=[1.0, 0, 0, 0]), TOLERANCE), mesh)
    collocated = rt.Mesh(4, rt.schemes.RadauIIA(3))
    kept = rt.refinement.SplitAndMerge().refine(collocated, seen(small, coarse=1.0, settled=False), TOLERANCE)
    assert_same(kept, collocated)


def test_an_adaptive_integrator_is_tightened_before_its_intervals_are_split() -> None:
    mesh = rt.Mesh(2, rt.schemes.MultipleShooting(rt.schemes.Adaptive(1e-6, stiff=True)))
    errors = seen([10 * TOLERANCE, 0.0])
    tight = rt.refinement.SplitAndMerge().refine(mesh, errors, TOLERANCE)
    assert set(tight.schemes) == {rt.schemes.MultipleShooting(rt.schemes.Adaptive(0.01 * TOLERANCE, stiff=True))}
    assert tight.count == 2
    assert rt.refinement.SplitAndMerge().refine(tight, errors, TOLERANCE).count == 3
    assert (
        rt.refinement.SplitAndMerge()
        .refine(mesh, seen([10 * TOLERANCE, 0.0], coarse=1.0, settled=False), TOLERANCE)
        .count
        == 4
    )


def test_intervals_of_other_schemes_do_not_merge() -> None:
    mesh = rt.Mesh(2, [rt.schemes.RadauIIA(3), rt.schemes.RadauIIA(4)])
    assert_same(rt.refinement.SplitAndMerge().refine(mesh, seen([1e-15, 1e-15]), TOLERANCE), mesh)


@pytest.mark.parametrize("refinement", [rt.refinement.SplitAndMerge(), rt.refinement.SplitOrRaise()], ids=["h", "hp"])
def test_a_switch_is_halved_until_the_objective_has_settled(refinement: Refinement) -> None:
    mesh = rt.Mesh(3, rt.schemes.RadauIIA(3))
    jumps = [0.0, 0.9, 0.0]
    errors = np.full(3, 0.1 * TOLERANCE)
    moving = refinement.refine(mesh, seen(errors, jumps, settled=False), TOLERANCE)
    np.testing.assert_allclose(moving.knots, [0, 1 / 3, 1 / 2, 2 / 3, 1])
    assert_same(refinement.refine(mesh, seen(errors, jumps, settled=True), TOLERANCE), mesh)


@pytest.mark.parametrize("refinement", [rt.refinement.SplitAndMerge(), rt.refinement.SplitOrRaise()], ids=["h", "hp"])
def test_an_interval_inside_which_a_path_row_is_broken_is_halved(refinement: Refinement) -> None:
    mesh = rt.Mesh(3, rt.schemes.RadauIIA(3))
    assessment = seen(np.full(3, 0.1 * TOLERANCE), broken=[0.0, 0.0, 0.01], settled=False)
    np.testing.assert_allclose(refinement.refine(mesh, assessment, TOLERANCE).knots, [0, 1 / 3, 2 / 3, 5 / 6, 1])


def test_raising_adds_points_by_the_logarithm_of_the_error_and_keeps_the_knots() -> None:
    """Ceil(log_3(2 e / tolerance)) more: 2, 3 and, far off, up to the most, beyond which the interval is halved."""
    mesh = rt.Mesh(4, rt.schemes.RadauIIA(3))
    errors = np.array([4, 13, 0.9, 1e9]) * TOLERANCE
    refined = rt.refinement.RaiseOrder(most=8).refine(mesh, seen(errors), TOLERANCE)
    np.testing.assert_array_equal(refined.knots, [0, 0.25, 0.5, 0.75, 0.875, 1])
    assert points(refined) == [5, 6, 3, 3, 3]
    assert {type(scheme) for scheme in refined.schemes} == {rt.schemes.RadauIIA}


def test_hp_raises_where_it_is_smooth_and_splits_where_it_is_rough() -> None:
    mesh = rt.Mesh(4, rt.schemes.RadauIIA(3))
    errors = np.array([4, 4, 4, 0.1]) * TOLERANCE
    assessment = seen(errors, jumps=[0, 0, 0.5, 0.5], decays=[SMOOTH, 0.1, SMOOTH, 0.1])
    refined = rt.refinement.SplitOrRaise().refine(mesh, assessment, TOLERANCE)
    np.testing.assert_allclose(refined.knots, [0, 0.25, 0.375, 0.5, 0.625, 0.75, 1])
    assert points(refined) == [5, 3, 3, 3, 3, 3]


def test_hp_splits_where_the_order_would_be_too_high() -> None:
    mesh = rt.Mesh(1, rt.schemes.RadauIIA(11))
    refined = rt.refinement.SplitOrRaise().refine(mesh, seen([1e3 * TOLERANCE]), TOLERANCE)
    assert refined.count >= 2 and set(points(refined)) == {11}


@pytest.mark.parametrize("refinement", EVERY, ids=lambda r: type(r).__name__)
@settings(max_examples=40, deadline=None, derandomize=True)
@given(data=st.data())
def test_every_interval_that_errs_gets_more_points_and_knots_stay_in_order(refinement: Refinement, data: Any) -> None:
    count = data.draw(st.integers(1, 8))
    widths = np.array(data.draw(st.lists(st.floats(0.05, 1), min_size=count, max_size=count)))
    knots = np.append(0, np.cumsum(widths) / widths.sum())
    knots[-1] = 1.0
    schemes = [rt.schemes.RadauIIA(n) for n in data.draw(st.lists(st.integers(2, 10), min_size=count, max_size=count))]
    per_interval = {"min_size": count, "max_size": count}
    errors = 10.0 ** np.array(data.draw(st.lists(st.floats(-9, 0), **per_interval)))
    jumps = np.array(data.draw(st.lists(st.floats(0, 1), **per_interval)))
    decays = np.array(data.draw(st.lists(st.floats(0, 4), **per_interval)))
    broken = np.array(data.draw(st.lists(st.floats(0, 0.01), **per_interval)))
    assessment = Assessment(errors, jumps, decays, broken, data.draw(st.booleans()), np.zeros(count))
    mesh = refinement.refine(rt.Mesh(tuple(knots), tuple(schemes)), assessment, TOLERANCE)
    assert mesh.knots[0] == 0 and mesh.knots[-1] == 1 and np.all(np.diff(mesh.knots) > 0)
    after = np.array(points(mesh))
    middles = 0.5 * (mesh.knots[1:] + mesh.knots[:-1])
    for k in np.flatnonzero(errors > TOLERANCE):
        inside = (middles > knots[k]) & (middles < knots[k + 1])
        assert after[inside].sum() > points_of(schemes[k])
        assert np.isin([knots[k], knots[k + 1]], mesh.knots).all()


@pytest.mark.parametrize("refinement", [rt.refinement.RaiseOrder(), rt.refinement.SplitOrRaise()], ids=["p", "hp"])
def test_a_mesh_that_holds_stays(refinement: Refinement) -> None:
    mesh = rt.Mesh([0, 0.2, 1], [rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(4)])
    assert_same(refinement.refine(mesh, seen([1e-7, 9e-7]), TOLERANCE), mesh)


def test_invalid_parameters_of_strategies_are_refused() -> None:
    with pytest.raises(rt.InputError, match="at least 2, got 1"):
        rt.refinement.SplitAndMerge(most=1)
    with pytest.raises(rt.InputError, match="at least 3 points, got 2"):
        rt.refinement.RaiseOrder(most=2)
