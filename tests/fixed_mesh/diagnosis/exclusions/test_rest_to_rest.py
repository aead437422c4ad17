"""A motion from rest to rest that is too fast for the friction of the ground is named before it is solved."""

from __future__ import annotations

from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.exclusions.rest_to_rest import longest_leg, slipping_motions
from robotraj.problem.constraints.base import Where


@pytest.fixture(scope="module")
def solo() -> rt.Robot:
    return rt.load("solo12", root="floating")


def leap(robot: rt.Robot, length: float, friction: float, **options: object) -> rt.Problem:
    contact = partial(rt.PointContact, friction=friction)
    return rt.gait.jump(robot, length=length, contact=contact, **{"margin": 0.0, **options})


def test_a_jump_on_ice_names_the_friction_that_it_needs_without_an_iteration(solo: rt.Robot) -> None:
    with pytest.raises(
        rt.NoSolutionFound, match=r"friction cone, .*0.02 must become 0.1.*moves 0.3 m from rest"
    ) as found:
        rt.plan(leap(solo, 0.3, 0.02), progress=False)
    assert found.value.solution.iterations == 0


def test_a_planned_jump_uses_the_friction_that_is_named_or_more() -> None:
    robot = rt.load("five_link", root="planar")
    solution = rt.plan(leap(robot, 0.2, 0.7), rt.Mesh(6), progress=False)
    used = 0.0
    for part in (solution.phases[0], solution.phases[2]):
        pushed = sum(part.at(part.points).forces.values())
        used = max(used, float(np.max(np.abs(pushed[:, 0]) / pushed[:, 2])))
    assert slipping_motions(leap(robot, 0.2, 0.01))
    assert used <= 0.7 + 1e-6
    assert not slipping_motions(leap(robot, 0.2, used))


def test_the_needed_friction_of_a_jump_is_that_of_the_derivation(solo: rt.Robot) -> None:
    """With no rise of the centre of mass until takeoff it is L / (g (S^2 + (T + S)^2) / 2)."""
    times = {"push": 0.3, "land": 0.3, "height": 9.81 * 0.2**2 / 8.0}
    (conflict,) = slipping_motions(leap(solo, 1.0, 0.01, **times))
    least = 1.0 / (0.5 * 9.81 * (0.3**2 + 0.5**2))
    assert conflict.certain and conflict.needed == pytest.approx(1.015 * least, rel=1e-3)


def test_a_margin_needs_more_friction(solo: rt.Robot) -> None:
    (all_of_it,) = slipping_motions(leap(solo, 0.3, 0.02))
    (part,) = slipping_motions(leap(solo, 0.3, 0.02, margin=0.2))
    assert part.needed == pytest.approx(all_of_it.needed / 0.8, rel=1e-2)


def pushed(robot: rt.Robot, friction: float, duration: object = 0.2) -> rt.Problem:
    """Move the root of a standing quadruped aside over its feet, from rest to rest."""
    feet = [name for name in rt.gait.limb_ends(robot) if name.endswith("FOOT")]
    model, data, stand = robot.model, robot.model.createData(), np.array(rt.gait.stand(robot, feet))
    pin.framesForwardKinematics(model, data, stand)
    places = [data.oMf[robot.frame(foot)].translation.copy() for foot in feet]
    aside = stand + 0.05 * np.eye(len(stand))[0]
    for _ in range(20):
        pin.computeJointJacobians(model, data, aside)
        pin.updateFramePlacements(model, data)
        at = [robot.frame(foot) for foot in feet]
        gaps = np.concatenate([place - data.oMf[k].translation for place, k in zip(places, at, strict=True)])
        rates = [pin.getFrameJacobian(model, data, k, pin.LOCAL_WORLD_ALIGNED)[:3, 6:] for k in at]
        aside[7:] += np.linalg.lstsq(np.vstack(rates), gaps, rcond=None)[0]
    contacts = [rt.PointContact(foot, friction=friction) for foot in feet]
    return rt.Problem([rt.Phase(robot, duration, rt.State(q=stand, v=0), rt.State(q=aside, v=0), contacts=contacts)])


def test_a_body_pushed_aside_needs_the_friction_of_the_derivation(solo: rt.Robot) -> None:
    """A level body accelerates and brakes by mu g, over L <= mu g T^2 / 4; a jumping one moves at most twice as far."""
    start, end = (pushed(solo, 1.0).phases[0].joint_ends[where].lower[: solo.nq] for where in (Where.START, Where.END))
    data = solo.model.createData()
    first, last = (np.array(pin.centerOfMass(solo.model, data, q)) for q in (start, end))
    way = np.linalg.norm((last - first)[:2])
    level = 4.0 * way / (9.81 * 0.2**2)
    (conflict,) = slipping_motions(pushed(solo, 0.49 * level))
    assert conflict.certain and conflict.needed == pytest.approx(1.015 * level, rel=1e-3)
    assert not slipping_motions(pushed(solo, 1.01 * level))
    assert not slipping_motions(pushed(solo, 0.49 * level, (0.1, 0.5)))
    assert not slipping_motions(pushed(solo, 0.49 * level, (0.1, np.inf)))


def test_motions_whose_end_or_duration_is_free_are_not_judged(solo: rt.Robot) -> None:
    problem = leap(solo, 1.0, 0.01)
    first, air, last = problem.phases
    assert slipping_motions(problem)
    assert not slipping_motions(rt.Problem([first, air, last.with_(end=rt.State(v=0))], problem.links))
    assert not slipping_motions(rt.Problem([first, air.with_(duration=(0.1, 9.0)), last], problem.links))
    assert not slipping_motions(rt.Problem([first, air, last], problem.links[:1]))


def test_jumps_over_stairs_are_not_judged(solo: rt.Robot) -> None:
    assert not slipping_motions(leap(solo, 1.0, 0.01, ground=rt.terrain.Steps.stairs(0.4, 2.0, 0.05, 1)))


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
