"""Ends at which an arm passes through itself are a warning before planning."""

from __future__ import annotations

import warnings

import pytest

import robotraj as rt

FREE, FOLDED = (0, -1.5, 0.5, -1.2, 0, 0), (0, -1.5, 2.8, 1.1, 1.3, 0)


def reach(end: tuple[float, ...]) -> rt.Phase:
    return rt.Phase(rt.load("ur5"), 1.0, rt.State(q=FREE, v=0), rt.State(q=end, v=0), rt.Effort(), name="fold")


def test_links_that_touch_at_an_end_are_named() -> None:
    with pytest.warns(UserWarning, match=r"'fold': at the end .*wrist_2_link.*touch; add rt.CollisionFree"):
        rt.plan(reach(FOLDED), mesh=rt.Mesh(4))


def test_an_end_that_is_free_is_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.plan(reach((0.3, -1.5, 0.5, -1.2, 0, 0)), mesh=rt.Mesh(4))
