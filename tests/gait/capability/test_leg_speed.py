"""Gaits that are faster than the joints of the legs are refused before a solve, with a step that would do."""

from __future__ import annotations

import re
import time
from collections.abc import Callable

import numpy as np
import pytest

import robotraj as rt
from robotraj.gait.capability.leg_samples import sample_legs
from robotraj.gait.capability.leg_speed import _bound

GAITS: dict[str, tuple[str, Callable[..., rt.Problem], dict[str, float]]] = {
    "walk": ("talos_legs", rt.gait.walk, {"step_length": 0.8, "duration": 0.16}),
    "run": ("talos_legs", rt.gait.run, {"step_length": 1.8, "duration": 0.3}),
    "trot": ("go2", rt.gait.trot, {"step_length": 0.3, "duration": 0.03}),
    "crawl": ("go2", rt.gait.crawl, {"step_length": -0.4, "duration": 0.1}),
}


def test_a_leg_of_one_joint_moves_its_foot_at_most_by_the_speed_of_the_joint() -> None:
    """A foot at the distance l below a joint crosses a stroke d in 2 asin(d / 2 l) / w at least."""
    robot = rt.load("compass_walker", root="planar", limits={"velocity": 3.0})
    feet = rt.gait.feet_of(robot, None)
    samples = sample_legs(robot, feet, robot.neutral, 0.0, 0.0)
    assert samples is not None
    length = float(np.linalg.norm(samples.places[1], axis=1).max())
    stroke = 0.6 * length
    exact = stroke / (2.0 * np.arcsin(0.5 * stroke / length) / 3.0)
    assert 0.8 * exact < _bound(samples, 1, 0.5, 2.0 * stroke) < 1.6 * exact


def test_the_bound_grows_with_the_speed_limit_and_falls_with_the_stroke_and_the_share_of_the_stance() -> None:
    robot = rt.load("go2", root="floating")
    q, feet = rt.gait.stand(robot), rt.gait.feet_of(robot, None)
    samples, slower = (sample_legs(robot, feet, q, 0.0, margin) for margin in (0.0, 0.5))
    assert samples is not None and slower is not None
    whole = _bound(samples, 0, 0.5, 0.4)
    assert _bound(slower, 0, 0.5, 0.4) == pytest.approx(0.5 * whole)
    assert _bound(samples, 0, 0.5, 0.8) < whole
    assert _bound(samples, 0, 0.75, 0.4) < 0.5 * whole


@pytest.mark.filterwarnings("ignore:The inertia of")
@pytest.mark.parametrize("name", GAITS)
def test_a_gait_that_is_too_fast_is_refused_within_two_seconds(name: str) -> None:
    which, gait, step = GAITS[name]
    robot = rt.load(which, root="floating")
    began = time.process_time()
    with pytest.raises(rt.InputError, match=rf"moves at .* m/s, {abs(step['step_length'])} m.*would do"):
        gait(robot, **step)
    assert time.process_time() - began < 2.0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:The inertia of")
@pytest.mark.parametrize("name", GAITS)
def test_the_stated_step_is_planned(name: str) -> None:
    which, gait, step = GAITS[name]
    robot = rt.load(which, root="floating")
    with pytest.raises(rt.InputError) as refusal:
        gait(robot, **step)
    length, duration = re.search(r"step_length=(\S+) with duration=(\S+) would", str(refusal.value)).groups()  # type: ignore[union-attr]
    assert rt.plan(gait(robot, step_length=float(length), duration=float(duration))).success


def test_modest_gaits_are_not_sampled(monkeypatch: pytest.MonkeyPatch) -> None:
    """A gait far below the speeds of the standing legs is not delayed by samples."""
    sampled = []
    monkeypatch.setattr(
        "robotraj.gait.capability.leg_speed.sample_legs",
        lambda *given: sampled.append(given[5:]) or sample_legs(*given),
    )
    rt.gait.walk(rt.load("five_link", root="planar"), step_length=0.2, duration=0.5)
    assert sampled == [(0,)]
