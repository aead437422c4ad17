"""Phases that no link joins are planned one by one, which is seldom meant."""

from __future__ import annotations

import warnings

import pytest

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])


def phases(via: rt.State | None) -> list[rt.Phase]:
    there = rt.Phase(BLOCK, 1.0, rt.State({"x": 0, "v": 0}), via, rt.Lagrange(lambda p: p.u["u"] ** 2), name="there")
    return [there, there.with_(start=via, end=rt.State({"x": 2, "v": 0}), name="on")]


def test_the_missing_link_is_named() -> None:
    with pytest.warns(UserWarning, match=r"'there' and 'on' are not linked.*links=\[rt\.Continuity\(0, 1\)\]"):
        rt.plan(rt.Problem(phases(None)), rt.Mesh(4))


@pytest.mark.parametrize(
    ("via", "links"),
    [
        (None, [rt.Continuity(0, 1)]),
        (None, [rt.links.Jump(0, 1, jumps={"v": None})]),
        (rt.State({"x": 1, "v": 0.5}), []),
    ],
    ids=["continuity", "jump", "equal states"],
)
def test_joined_phases_are_planned_without_a_warning(via: rt.State | None, links: list[rt.links.Link]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.plan(rt.Problem(phases(via), links), rt.Mesh(4))
