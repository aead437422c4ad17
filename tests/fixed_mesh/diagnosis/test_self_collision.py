"""Ends at which the links of a robot overlap exclude every motion, and are named before planning."""

from __future__ import annotations

import warnings

import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.self_collision import overlapping_ends

FREE, FOLDED = (0, -1.5, 0.5, -1.2, 0, 0), (0, -1.5, 2.8, 1.1, 1.3, 0)


def reach(end: tuple[float, ...]) -> rt.Phase:
    return rt.Phase(rt.load("ur5"), 1.0, rt.State(q=FREE, v=0), rt.State(q=end, v=0), rt.Effort(), name="fold")


def test_links_that_overlap_at_an_end_exclude_every_motion_and_are_named_with_their_depth() -> None:
    with pytest.raises(rt.NoSolutionFound, match=r"at the end they overlap by 0\.\d+ m: choose another end") as error:
        rt.plan(reach(FOLDED))
    failed = error.value.solution
    assert failed.status.value == "infeasible" and failed.iterations <= 1
    assert "wrist_3_link and upper_arm_link" in failed.cause
    assert failed.conflicts[0].needed == pytest.approx(-0.042, abs=2e-3)


def test_an_end_with_overlaps_is_allowed_where_it_is_free_or_self_collision_is_false() -> None:
    assert rt.plan(reach(FOLDED).with_(self_collision=False)).success
    free = reach(FOLDED).with_(end=rt.State(q={"shoulder_pan_joint": 0.0}, v=0))
    assert not overlapping_ends(rt.Problem([free]))


def test_self_collision_is_stated_by_the_phase_and_checked() -> None:
    assert ">= 0" in next(line for line in str(reach(FREE)).splitlines() if "own links" in line)
    off = reach(FREE).with_(self_collision=False)
    assert "free" in next(line for line in str(off).splitlines() if "own links" in line)
    with pytest.raises(rt.InputError, match="self_collision= of phase 'fold' is 1; give True or False"):
        reach(FREE).with_(self_collision=1)


def test_an_end_that_is_free_and_a_given_mesh_give_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.plan(reach((0.3, -1.5, 0.5, -1.2, 0, 0)))
        # On a given mesh nothing is proved, and shapes are not read.
        rt.plan(reach(FOLDED), mesh=rt.Mesh(4))
