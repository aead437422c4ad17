"""Gaits keep back a share of cone, sole, torque and speed, and plans state the shares that they use."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import robotraj as rt


def hop(margin: float) -> rt.Solution:
    """A jump to the front on slippery ground, which uses all friction that it is given."""
    hopper = rt.load("hopper", root="planar")
    foot = partial(rt.PointContact, friction=0.15)
    jump = rt.gait.jump(hopper, feet=["foot"], contact=foot, length=0.05, height=0.05, margin=margin)
    return rt.plan(jump, progress=False)


@pytest.mark.parametrize("margin", [0.0, 0.3])
def test_a_plan_uses_the_cone_up_to_its_margin(margin: float) -> None:
    solution = hop(margin)
    cone = next(share for share in solution.shares if share.kind == "cone")
    assert cone.largest == pytest.approx(1.0 - margin, abs=1e-2)
    assert cone.name == "foot"
    assert (cone.high > 0.0) == (margin == 0.0)
    force = solution.phases[0].at(cone.time if cone.time < solution.phases[0].duration else 0.0).forces["foot"]
    assert abs(force[0]) <= (1.0 - margin + 1e-2) * 0.15 * force[2]
    text = " ".join(str(solution).split())
    assert f"uses {100 * cone.largest:.0f} % of cone (foot" in text


def test_the_default_margin_is_a_tenth_of_torque_and_speed() -> None:
    biped = rt.load("five_link", root="planar")
    step = rt.gait.walk(biped, step_length=0.4, duration=0.6)
    (phase,) = step.phases
    assert phase.contacts[0].margin == 0.1
    assert phase.limits is biped.limits
    bounds, own = phase.rows.limits(), biped.limits
    for joint in biped.actuated:
        i = biped.velocity_names.index(joint)
        assert bounds[f"tau.{joint}"] == pytest.approx((0.9 * own.effort_lower[i], 0.9 * own.effort_upper[i]))
        assert bounds[f"v.{joint}"] == pytest.approx((0.9 * own.velocity_lower[i], 0.9 * own.velocity_upper[i]))
    free = rt.gait.walk(biped, step_length=0.4, duration=0.6, margin=0.0).phases[0]
    assert free.contacts[0].margin == 0.0
    assert free.rows.limits()["tau.left_knee"] == pytest.approx((own.effort_lower[-1], own.effort_upper[-1]))


def test_a_larger_margin_of_a_contact_remains() -> None:
    biped = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", margin=0.4)
    assert rt.gait.walk(biped, step_length=0.4, duration=0.6, contact=foot).phases[0].contacts[0].margin == 0.4


@pytest.mark.parametrize("margin", [-0.1, 1.0, "much"])
def test_a_margin_that_is_no_share_is_refused(margin: object) -> None:
    biped = rt.load("five_link", root="planar")
    with pytest.raises(rt.InputError, match="margin"):
        rt.gait.walk(biped, step_length=0.4, duration=0.6, margin=margin)
    with pytest.raises(rt.InputError, match="margin"):
        rt.PointContact("left_foot", margin=margin)


def test_the_shares_of_a_sole_are_those_of_its_rectangle() -> None:
    from robotraj.dynamics.contacts.soles import Rectangle, pressure_rows

    rng = np.random.default_rng(5)
    sole = Rectangle(0.06, 0.14, 0.05)
    for _ in range(50):
        normal, moment = rng.uniform(10, 100), rng.uniform(-3, 3, 3)
        share = sole.share(normal, list(moment))
        for factor, inside in ((share + 1e-9, True), (share - 1e-6, False)):
            rows = pressure_rows(sole.scaled(factor), normal, list(moment))
            assert bool(min(rows) >= 0.0) is inside


def test_motions_without_contacts_state_no_shares() -> None:
    pendulum = rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    assert rt.plan(pendulum, rt.Mesh(5), progress=False).shares == ()
