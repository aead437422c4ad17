"""Every demo is planned and validated, with no limit violated between the knots."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.cli.demos.table import DEFAULT, DEMOS, demo_named
from tests.examples import EXAMPLES, assert_one_problem, first_call

SLOW = {"multistart", "solo12_jump", "solo12_trot", "talos_walking"}
FRONT = ("cartpole", "ur5", "solo12_trot", "talos_walking")
NOT_PROVED = {"hopper"}  # an impact lasts one interval
AS_THEIR_EXAMPLES = (
    "around_a_box",
    "bolt_walking",
    "compass_walker",
    "five_link_stairs",
    "glass_of_water",
    "humanoid_stands_up",
    "pick_and_place",
    "shelf_to_shelf",
    "two_arms",
)
"""Demos with the problem and the options of their example, whose plan ``test_examples.py`` makes and validates."""


STUDIES = {"27_many_motions", "28_on_a_cluster", "29_motion_library", "30_design_study", "31_data_for_learning"}
"""Examples of many motions, which no page of one shows."""


def test_every_example_of_one_motion_has_a_demo() -> None:
    shown = {entry.example for entry in DEMOS.values()}
    assert shown | STUDIES == {path.stem for path in EXAMPLES.glob("[0-9]*.py")} and not shown & STUDIES


@cache
def planned(name: str) -> rt.Solution:
    return demo_named(name).make().plan()


@pytest.mark.parametrize("name", AS_THEIR_EXAMPLES)
def test_a_demo_is_its_example(name: str) -> None:
    demo, (problem, options) = demo_named(name).make(), first_call(DEMOS[name].example)
    assert_one_problem(demo.problem, problem)
    assert repr(demo.meshes[:1]) == repr((options["mesh"],) if "mesh" in options else ())
    assert demo.tolerance == options.get("tolerance") and demo.guess is None
    assert not demo.continuation and not demo.starts and options.keys() <= {"mesh", "tolerance"}
    assert DEMOS[name].shows.endswith(".")


PLANNED = [name for name in DEMOS if name not in AS_THEIR_EXAMPLES]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in PLANNED]
)
def test_every_other_demo_plans_and_passes(name: str, tmp_path: Path) -> None:
    """Those that one sees first are proved by the default call."""
    demo, solution = demo_named(name).make(), planned(name)
    report = rt.validate(solution)
    assert report.passed is (name not in NOT_PROVED), str(report)
    assert DEMOS[name].shows.endswith(".")
    page = rt.replay(solution, tmp_path / DEMOS[name].page, periods=demo.periods, report=report).read_text()
    if name in FRONT:
        assert not demo.meshes and not demo.starts and demo.tolerance is None and not demo.continuation
        assert solution.proof is not None and solution.proof.holds and "proved between the points" in str(solution)
        # One link of Talos has no collision shape, so its own body is not judged.
        verdict = "proved; validated; not judged: own body" if name == "talos_walking" else "proved and validated"
        assert f">{verdict}</dd>" in page


def test_the_block_takes_its_minimum_time() -> None:
    assert planned("block").duration == pytest.approx(2 * np.sqrt(10), rel=1e-8)


def test_the_cartpole_reaches_the_published_optimum() -> None:
    assert DEFAULT == "cartpole"
    assert planned(DEFAULT).objective == pytest.approx(58.8076675, rel=2e-4)


def test_the_keyframes_lead_the_acrobot_to_its_known_optimum() -> None:
    assert planned("acrobot").objective == pytest.approx(34.9191, rel=2e-5)


def test_an_unknown_demo_is_refused_with_the_known_ones() -> None:
    with pytest.raises(rt.UnknownName, match="no demo named 'cartpol'.*'cartpole'"):
        demo_named("cartpol")
