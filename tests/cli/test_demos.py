"""Every demo plans and passes its proof, without a limit broken between the knots."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.cli.demos import DEFAULT, DEMOS, demo_named, summary


def planned(name: str) -> rt.Solution:
    demo = demo_named(name)()
    known: Any = demo.guess
    for mesh in demo.meshes:
        known = rt.plan(demo.phase, mesh, known)
    assert isinstance(known, rt.Solution)
    return known


@pytest.mark.parametrize("name", DEMOS)
def test_every_demo_plans_and_passes(name: str) -> None:
    solution = planned(name)
    report = rt.validate(solution)
    assert report.passed, str(report)
    assert summary(name).endswith(".")


def test_the_block_takes_its_minimum_time() -> None:
    assert planned("block").duration == pytest.approx(2 * np.sqrt(10), rel=1e-8)


def test_the_cartpole_reaches_the_published_optimum() -> None:
    assert DEFAULT == "cartpole"
    assert planned(DEFAULT).objective == pytest.approx(58.8076675, rel=1e-6)


def test_the_keyframes_lead_the_acrobot_to_its_known_optimum() -> None:
    assert planned("acrobot").objective == pytest.approx(34.9191, rel=2e-5)


def test_an_unknown_demo_is_refused_with_the_known_ones() -> None:
    with pytest.raises(rt.UnknownName, match="no demo named 'cartpol'.*'cartpole'"):
        demo_named("cartpol")
