"""Legs that are straight or folded bend to the asked height, alike on both sides."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from tests.robots.many_legs import FOUR, SIX, legged


def stands(made, height):
    feet = tuple(name for name in made.frame_names if name.endswith("_foot"))
    q = rt.gait.stand(made, feet, height=height)
    data = made.model.createData()
    pin.framesForwardKinematics(made.model, data, q)
    places = np.array([data.oMf[made.frame(foot)].translation for foot in feet])
    np.testing.assert_allclose(places[:, 2], 0.0, atol=1e-8)
    return q, float(pin.centerOfMass(made.model, data, q)[2])


@pytest.mark.parametrize("legs", [FOUR, SIX], ids=["four", "six"])
@pytest.mark.parametrize("height", [0.28, 0.24, 0.18])
def test_straight_legs_bend_to_a_height(tmp_path, legs, height):
    made = legged(tmp_path, legs)
    q, found = stands(made, height)
    assert found == pytest.approx(height, abs=2e-3)
    knees = q[[7 + made.joint_names.index(f"{leg}_kfe") - 1 for leg in legs]]
    assert np.ptp(knees) < 0.15 and np.abs(knees).min() > 0.3


def test_mirrored_axes_bend_to_mirrored_sides(tmp_path):
    made = legged(tmp_path, FOUR, right_axis="0 -1 0")
    q, _ = stands(made, 0.24)
    left, right = (q[7 + made.joint_names.index(f"F{side}_kfe") - 1] for side in "LR")
    assert left == pytest.approx(-right, abs=1e-3) and abs(left) > 0.5


def test_legs_are_bent_where_no_height_is_given(tmp_path):
    made = legged(tmp_path, FOUR)
    q, found = stands(made, None)
    _, full = stands(made, 0.27)
    assert np.abs(q[7 + made.joint_names.index("FL_kfe") - 1]) > 0.4 and found > full


def test_folded_legs_extend(tmp_path):
    _, found = stands(legged(tmp_path, FOUR, folded=True), 0.2)
    assert found == pytest.approx(0.2, abs=2e-3)


def test_six_feet_carry_a_crouch(tmp_path):
    made = legged(tmp_path, SIX)
    feet = [f"{leg}_foot" for leg in SIX]
    q = rt.gait.stand(made, feet)
    lower = rt.AtEnd(rt.constraints.FramePosition("trunk", q[:3] + [0.02, 0.01, -0.04]))
    phase = rt.Phase(
        made,
        duration=0.6,
        start=rt.State(q=q, v=0),
        end=rt.State(v=0),
        objective=rt.gait.gait_objective(made, q),
        constraints=[lower],
        contacts=[rt.PointContact(foot, friction=0.7) for foot in feet],
    )
    assert rt.plan(phase, time_limit=60).proof.holds
