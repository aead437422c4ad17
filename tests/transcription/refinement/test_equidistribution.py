"""Knots placed by the order of the scheme: every interval of the next mesh has the same share of the error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.refinement.base import Assessment
from robotraj.transcription.refinement.equidistribution import evenly_finer

TOLERANCE = 1e-4


def seen(errors: list[float], broken: float = 0.0, growth: float = 1.0) -> Assessment:
    nothing = np.zeros(len(errors))
    return Assessment(TOLERANCE * np.array(errors), nothing, nothing, nothing + broken, True, nothing, growth)


def test_intervals_within_the_tolerance_stay_and_others_are_cut_by_the_order_of_the_scheme() -> None:
    """Three points: the error falls as h^4, the target is a quarter of the tolerance: 4 * 4 = 16 needs 2 parts."""
    mesh = rt.Mesh(4)
    refined = rt.refinement.Equidistribute().refine(mesh, seen([0.1, 4, 4, 0.1]), TOLERANCE)
    assert refined.knots == pytest.approx([0, 1 / 4, 3 / 8, 1 / 2, 5 / 8, 3 / 4, 1])
    assert refined.given == mesh.given


def test_the_error_of_an_interval_with_a_jump_falls_with_its_length_alone() -> None:
    """4 times the tolerance needs 16 parts by the order 1, of which 4 are allowed at once, and 2 where it is smooth."""
    mesh, errors = rt.Mesh(32), np.full(32, 0.1)
    errors[[10, 20]] = 4.0
    jumps = np.zeros(32)
    jumps[10] = 0.9
    refined = rt.refinement.Equidistribute().refine(mesh, replace(seen(list(errors)), jumps=jumps), TOLERANCE)
    assert len(refined.knots) - 1 == 30 + 4 + 2
    coarse = replace(seen([0.1, 4, 4, 0.1]), jumps=np.array([0.0, 0.9, 0.1, 0.0]))
    assert len(rt.refinement.Equidistribute().refine(rt.Mesh(4), coarse, TOLERANCE).knots) - 1 == 6


def test_large_errors_come_first_on_a_mesh_of_the_most_intervals() -> None:
    """All intervals need to be 4 times as many, which is too many: the one with a large error is still divided."""
    refinement, mesh = rt.refinement.Equidistribute(finest=20), rt.Mesh(16)
    errors = [0.1] * 16
    errors[8] = 1e3
    refined = np.array(refinement.refine(mesh, seen(errors, growth=4.0), TOLERANCE).knots)
    assert len(refined) - 1 == 20
    lengths = np.diff(refined)[(refined[:-1] > 8 / 16) & (refined[1:] < 9 / 16)]
    assert len(lengths) >= 2 and lengths.max() < 1 / 16 / 3.5


def test_a_mesh_that_holds_stays() -> None:
    mesh = rt.Mesh(4)
    assert rt.refinement.Equidistribute().refine(mesh, seen([0.9, 0.1, 0.5, 1.0]), TOLERANCE) == mesh


@pytest.mark.parametrize(
    ("assessment", "count"),
    [
        (seen([0.0] * 4, growth=1.5), 6),
        (seen([0.0] * 4, broken=1.1e-3), 8),
        (seen([0.0] * 4, broken=8.1e-3), 13),  # 4 (8.1 / SAFETY)^(1/3)
        (seen([0.0] * 4, broken=1.0), 16),
    ],
)
def test_objectives_and_path_rows_ask_for_more_intervals(assessment: Assessment, count: int) -> None:
    refined = rt.refinement.Equidistribute().refine(rt.Mesh(4), assessment, TOLERANCE)
    assert refined.knots == pytest.approx(np.linspace(0, 1, count + 1))


def test_no_mesh_is_finer_than_the_finest_nor_cut_into_more_parts_than_most() -> None:
    large = seen([1e9] * 4)
    assert rt.refinement.Equidistribute(most=3).refine(rt.Mesh(4), large, TOLERANCE).count == 12
    assert rt.refinement.Equidistribute(finest=7).refine(rt.Mesh(4), large, TOLERANCE).count == 7
    assert rt.refinement.Equidistribute(finest=4).refine(rt.Mesh(4), large, TOLERANCE) == rt.Mesh(4)


def test_the_finest_mesh_moves_its_knots_to_large_errors() -> None:
    finest = rt.refinement.Equidistribute(finest=20)
    errors = [0.1] * 20
    assert finest.refine(rt.Mesh(20), seen(errors, growth=1.5), TOLERANCE) == rt.Mesh(20)
    errors[10] = 4.0**3
    moved = finest.refine(rt.Mesh(20), seen(errors), TOLERANCE)
    assert moved.count == 20
    assert np.diff(moved.knots).min() == pytest.approx(1 / 20 / 4 * 23 / 20)
    assert np.diff(moved.knots).max() == pytest.approx(1 / 20 * 23 / 20)


def test_lengths_beside_short_intervals_grow_by_the_slope_at_most() -> None:
    """One interval of ten needs 64 parts: its neighbours shrink to its length plus the slope times the distance."""
    slope = 0.2
    refinement = rt.refinement.Equidistribute(most=64.0, slope=slope)
    errors = [0.0] * 4 + [64**4 / 4] + [0.0] * 5
    steep = rt.refinement.Equidistribute(most=64.0).refine(rt.Mesh(10), seen(errors), TOLERANCE)
    graded = refinement.refine(rt.Mesh(10), seen(errors), TOLERANCE)
    beside = np.diff(graded.knots)[np.searchsorted(graded.knots, 0.55)]
    assert np.diff(steep.knots)[np.searchsorted(steep.knots, 0.55)] == pytest.approx(0.1)
    assert beside == pytest.approx(0.1 / 64 + slope * 0.1, rel=0.1)
    assert graded.count > steep.count


def test_intervals_keep_the_scheme_of_their_place() -> None:
    mixed = rt.Mesh(2, [rt.HermiteSimpson(), rt.schemes.RadauIIA(2)])
    finer = evenly_finer(mixed, 2.0)
    assert finer.schemes == (rt.HermiteSimpson(),) * 2 + (rt.schemes.RadauIIA(2),) * 2


@pytest.mark.parametrize("wrong", [{"most": 1.5}, {"second": 1.0}, {"finest": 0}, {"slope": 0.0}])
def test_what_refines_nothing_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(rt.InputError, match=next(iter(wrong))):
        rt.refinement.Equidistribute(**wrong)


def test_intervals_beside_a_violated_one_are_halved_with_it() -> None:
    """Where knots move, the place of the violation may come to lie in the next interval."""
    assessment = seen([0.0] * 8)
    assessment.broken[3] = 1.1e-3
    refined = rt.refinement.Equidistribute().refine(rt.Mesh(8), assessment, TOLERANCE)
    assert refined.knots == pytest.approx([0, 1 / 8, *np.arange(4, 11) / 16, 6 / 8, 7 / 8, 1], abs=1e-9)
