"""A jump that is too long for the friction of the ground is named before it is solved."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.planning.diagnosis.exclusions.jumps import longest_leg, slipping_jumps


@pytest.fixture(scope="module")
def solo() -> rt.Robot:
    return rt.load("solo12", root="floating")


def leap(robot: rt.Robot, length: float, friction: float, **options: object) -> rt.Problem:
    return rt.gait.jump(robot, length=length, contact=partial(rt.PointContact, friction=friction), **options)


def test_a_jump_on_ice_names_the_friction_that_it_needs_without_an_iteration(solo: rt.Robot) -> None:
    with pytest.raises(rt.NoSolutionFound, match=r"friction cone, .*0.02 must become 0.0.*a jump of 0.3 m") as found:
        rt.plan(leap(solo, 0.3, 0.02), progress=False)
    assert found.value.solution.iterations == 0


def test_a_planned_jump_uses_the_friction_that_is_named_or_more() -> None:
    robot = rt.load("five_link", root="planar")
    solution = rt.plan(leap(robot, 0.2, 0.7), rt.Mesh(6), progress=False)
    used = 0.0
    for part in (solution.phases[0], solution.phases[2]):
        pushed = sum(part.at(part.points).forces.values())
        used = max(used, float(np.max(np.abs(pushed[:, 0]) / pushed[:, 2])))
    (conflict,) = slipping_jumps(leap(robot, 0.2, 0.01))
    assert 0.01 < conflict.needed <= used <= 0.7 + 1e-6
    assert not slipping_jumps(leap(robot, 0.2, 1.01 * conflict.needed))


def test_the_needed_friction_of_a_level_jump_is_that_of_the_derivation(solo: rt.Robot) -> None:
    """With no rise of the centre of mass it is L / (g (S + T)^2 / 2 + g S^2 / 2); rising legs make it less."""
    times = {"push": 0.3, "land": 0.3, "height": 9.81 * 0.2**2 / 8.0}
    (conflict,) = slipping_jumps(leap(solo, 1.0, 0.01, **times))
    without_legs = 1.0 / (0.5 * 9.81 * (2 * 0.3**2 + 0.2**2 + 2 * 0.3 * 0.2))
    assert conflict.certain and 0.5 * without_legs < conflict.needed < without_legs


def test_jumps_whose_end_or_flight_is_free_are_not_judged(solo: rt.Robot) -> None:
    problem = leap(solo, 1.0, 0.01)
    first, air, last = problem.phases
    assert slipping_jumps(problem)
    assert not slipping_jumps(rt.Problem([first, air, last.with_(end=rt.State(v=0))], problem.links))
    assert not slipping_jumps(rt.Problem([first, air.with_(duration=(0.1, 0.9)), last], problem.links))
    assert not slipping_jumps(rt.Problem([first, air, last], problem.links[:1]))


def test_jumps_over_stairs_are_not_judged(solo: rt.Robot) -> None:
    assert not slipping_jumps(leap(solo, 1.0, 0.01, ground=rt.terrain.Steps.stairs(0.4, 2.0, 0.05, 1)))


def test_the_longest_leg_is_longer_than_any_distance(solo: rt.Robot) -> None:
    model, data, rng = solo.model, solo.model.createData(), np.random.default_rng(0)
    frame = solo.frame("FL_FOOT")
    found = 0.0
    for _ in range(300):
        q = np.concatenate([[0, 0, 0, 0, 0, 0, 1], rng.uniform(-np.pi, np.pi, solo.nu)])
        pin.framesForwardKinematics(model, data, q)
        found = max(found, float(np.linalg.norm(pin.centerOfMass(model, data, q) - data.oMf[frame].translation)))
    bound = longest_leg(solo, "FL_FOOT")
    assert found < bound < 3.0 * found
    assert np.isinf(longest_leg(rt.load("hopper", root="planar"), "foot"))
