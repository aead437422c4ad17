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
        rt.plan(reach(FOLDED), time_limit=1.0, check=False)


def test_an_end_that_is_free_and_a_given_mesh_give_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.plan(reach((0.3, -1.5, 0.5, -1.2, 0, 0)))
        # On a given mesh nothing is proved, and shapes are not read.
        rt.plan(reach(FOLDED), mesh=rt.Mesh(4))
