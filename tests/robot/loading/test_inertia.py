"""Inertias of no rigid body: moving bodies are refused, fixed parts of a sound body are findings."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.loading.inertia import is_indefinite, principal_moments, triangle_fault

BODY = (
    '<link name="{0}"><inertial><mass value="{1}"/>'
    '<inertia ixx="{2}" iyy="{3}" izz="{4}" ixy="{5}" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><axis xyz="0 1 0"/>'
    '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
)


def robot(*parts):
    return f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>'


@pytest.mark.parametrize("entries", [(-0.1, 0.2, 0.2, 0.0), (0.1, 0.1, 0.2, 0.5)], ids=["negative", "indefinite"])
def test_a_moving_body_of_indefinite_inertia_is_refused(entries, urdf):
    path = urdf.text(robot(BODY.format("arm", 1.0, *entries), JOINT.format("elbow", "revolute", "base", "arm")))
    with pytest.raises(rt.InputError, match="'elbow' .*one of them negative"):
        rt.load(path)


def test_an_indefinite_part_of_a_sound_body_is_a_finding(urdf):
    arm, antenna = BODY.format("arm", 1.0, 1, 1, 1, 0), BODY.format("antenna", 0.1, -1e-3, 1e-3, 1e-3, 0)
    joints = JOINT.format("elbow", "revolute", "base", "arm"), JOINT.format("glue", "fixed", "arm", "antenna")
    path = urdf.text(robot(arm, antenna, *joints))
    with pytest.warns(UserWarning, match="Link 'antenna' has the principal moments"):
        assert rt.load(path).nv == 1


def test_a_massless_link_before_a_massive_one_is_no_finding(urdf, recwarn):
    parts = ('<link name="cross"/>', BODY.format("arm", 1.0, 1, 1, 1, 0))
    joints = JOINT.format("yaw", "revolute", "base", "cross"), JOINT.format("pitch", "revolute", "cross", "arm")
    assert rt.load(urdf.text(robot(*parts, *joints))).nv == 2
    assert not recwarn.list


def test_the_catalogue_loads_without_a_warning_and_notes_its_findings(recwarn):
    assert any("'base_antenna_left_link'" in note for note in rt.load("tiago").notes)
    assert not recwarn.list


@pytest.mark.parametrize(
    ("diagonal", "fault"),
    [
        ((1.0, 2.0, 3.0), ""),  # a flat plate: the largest moment is the sum of the others
        ((0.0, 0.0, 0.0), ""),
        ((0.0, 1.0, 1.0), ""),  # a thin rod
        ((1.0, 1.0, 2.01), ""),
        ((1.0, 1.0, 2.1), "larger than the sum"),
        ((-1e-20, 0.0, 0.0), ""),
        ((-0.1, 1.0, 1.0), "negative"),
    ],
)
def test_moments_of_rigid_bodies(diagonal, fault):
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    moments = principal_moments(turn @ np.diag(diagonal) @ turn.T)
    np.testing.assert_allclose(moments, np.sort(diagonal), atol=1e-12)
    found = triangle_fault(moments, 1.0)
    assert fault in found if fault else not found
    assert is_indefinite(moments, 1.0) == (fault == "negative")


def test_inertias_whose_sum_overflows_are_refused(urdf):
    """Two bodies of 1e300 kg that are fixed 1e5 m apart once ended in numpy's LinAlgError."""
    bodies = BODY.format("arm", 1e300, 1, 1, 1, 0), BODY.format("tip", 1e300, 1, 1, 1, 0)
    glue = JOINT.format("glue", "fixed", "arm", "tip").replace("<axis", '<origin xyz="1e5 0 0"/><axis')
    with pytest.raises(rt.InputError, match="'elbow' .larger than any number"):
        rt.load(urdf.text(robot(*bodies, JOINT.format("elbow", "revolute", "base", "arm"), glue)))
