"""Whether a plan is followed in MuJoCo is one value: it holds, fails or was not judged."""

from __future__ import annotations

import importlib.util
from types import SimpleNamespace

import pytest

import robotraj as rt
from robotraj.witness.robustness import followed as module

DEVIATIONS = {"q.root_x": 3.0, "q.knee": 2.5, "v.knee": 9.0, "q.hip": 0.2}


@pytest.fixture(scope="module")
def swing() -> rt.Solution:
    pendulum = rt.Phase(rt.load("pendulum"), 1.5, rt.State(q=0, v=0), rt.State(q=1.0, v=0), rt.Effort())
    return rt.plan(pendulum, progress=False)


def test_a_swing_is_followed(swing: rt.Solution) -> None:
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    result = rt.witness.followed(swing)
    assert result.holds and result.opinion is not None and "followed: holds" in str(result)


def test_it_is_not_judged_without_mujoco(swing: rt.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    result = rt.witness.followed(swing)
    assert result.holds is None and "not judged, MuJoCo is not installed" in str(result)


def test_a_fall_fails(swing: rt.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    fallen = SimpleNamespace(completed=False, fell=0.4, failure="the robot fell at t = 0.4 s")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(module, "second_opinion", lambda solution, periods: fallen)
    result = rt.witness.followed(swing)
    assert result.holds is False and str(result) == "followed: fails, the robot fell at t = 0.4 s"


def test_a_joint_far_from_the_plan_fails(swing: rt.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [SimpleNamespace(name=name, largest=size, unit="rad", time=0.3) for name, size in DEVIATIONS.items()]
    strayed = SimpleNamespace(completed=True, deviation=SimpleNamespace(rows=rows))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    monkeypatch.setattr(module, "second_opinion", lambda solution, periods: strayed)
    result = rt.witness.followed(swing)
    assert result.holds is False and "q.knee deviates by 2.5 rad" in str(result)


def test_the_motion_of_a_system_is_not_judged() -> None:
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    phase = rt.Phase(block, 1.0, rt.State({"x": 0, "v": 0}), rt.State({"x": 1, "v": 0}), rt.Effort())
    assert rt.witness.followed(rt.plan(phase, rt.Mesh(4), progress=False)).holds is None


def test_following_is_a_claim_where_it_is_asked_for(swing: rt.Solution) -> None:
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    assert "followed" not in {claim.name for claim in rt.validate(swing).claims}
    for near, holds in ((0.5, True), (1e-9, False)):
        report = rt.validate(swing, followed=near)
        (claim,) = (each for each in report.claims if each.name == "followed")
        assert claim.holds is holds is report.passed and claim.bound == near


def test_following_is_not_judged_without_mujoco(swing: rt.Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    report = rt.validate(swing, followed=0.5)
    assert "followed" in report.not_judged and report.passed
