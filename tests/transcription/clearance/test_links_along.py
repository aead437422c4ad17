"""Rows along a free motion are met by it, and pairs of links get them where another motion overlaps."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.problem.clearance.own_shapes import MARGIN
from robotraj.transcription.clearance.links_along import LinksAlong

FIRST, LAST = np.array([0, -1.5, 0.5, 0.6, 0, 0]), np.array([0, -1.5, 0.5, 2.4, 0, 0])
AWAY = np.array([0.5, -1.2, 0.4, 0.5, 0.3, 0])


def line(start: np.ndarray, end: np.ndarray) -> PiecewisePolynomial:
    """Moves from one configuration to another in 2 s."""
    return PiecewisePolynomial(np.array([0.0, 2.0]), [np.array([0.0, 1.0])], [np.array([start, end])])


def phase(start: np.ndarray, end: np.ndarray, **options: object) -> rt.Phase:
    ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
    return rt.Phase(rt.load("ur5"), 2.0, *ends, rt.Effort(), **{"self_collision": True, **options})


@pytest.fixture(scope="module")
def free() -> PiecewisePolynomial:
    return line(FIRST, AWAY)


def test_a_motion_far_from_itself_has_no_rows(free: PiecewisePolynomial) -> None:
    assert LinksAlong(phase(FIRST, AWAY), free).surfaces is None


def test_pairs_that_overlap_along_another_motion_get_rows_once(free: PiecewisePolynomial) -> None:
    links = LinksAlong(phase(FIRST, AWAY), free)
    through = line(FIRST, LAST)
    assert links.add(through) and not links.add(through)
    surfaces = links.surfaces
    assert surfaces is not None and {row.margin for row in surfaces.pairs} == {MARGIN}
    labels = [surfaces.body.label(row.pair) for row in surfaces.pairs]
    assert any("wrist" in label and "forearm" in label for label in labels)


def test_a_free_motion_adds_none(free: PiecewisePolynomial) -> None:
    assert not LinksAlong(phase(FIRST, AWAY), free).add(free)


def test_links_that_may_overlap_have_none(free: PiecewisePolynomial) -> None:
    links = LinksAlong(phase(FIRST, AWAY, self_collision=False), free)
    assert not links.add(line(FIRST, LAST)) and links.surfaces is None
