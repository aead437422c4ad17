"""Included files stand in the place of their elements, and are read inside the file's folder alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt

BODY = """<body name="upper" pos="0 0 0.2"><joint name="shoulder" class="joints" axis="0 1 0" range="-2 2"/>
<inertial pos="0 0 0.2" mass="1" diaginertia="0.01 0.01 0.002"/></body>"""
DEFAULT = '<default><default class="joints"><joint damping="0.5" armature="0.02"/></default></default>'
MOTOR = '<actuator><motor joint="shoulder" ctrlrange="-3 3"/></actuator>'
RADIANS = '<compiler angle="radian"/>'
WHOLE = f'<mujoco model="one">{RADIANS}{DEFAULT}<worldbody>{BODY}</worldbody>{MOTOR}</mujoco>'


def write(folder: Path, **texts: str) -> Path:
    """Write files, and return the path of the one named ``scene``."""
    for name, text in texts.items():
        (folder / f"{name}.xml").write_text(text)
    return folder / "scene.xml"


def test_a_scene_is_the_file_written_in_one(tmp_path: Path) -> None:
    """A scene includes the robot, which includes its body, and has sections of its own beside those of the robot."""
    robot = f'<mujoco model="one">{RADIANS}{DEFAULT}<worldbody><include file="body.xml"/></worldbody>{MOTOR}</mujoco>'
    scene = '<mujoco model="scene"><include file="robot.xml"/><worldbody><light pos="0 0 2"/></worldbody></mujoco>'
    body = f"<mujocoinclude>{BODY}</mujocoinclude>"
    found = rt.load(write(tmp_path, scene=scene, robot=robot, body=body))
    expected = rt.load(write(tmp_path, scene=WHOLE))
    assert found.joint_names == expected.joint_names == ("shoulder",)
    assert found.model.inertias[1].isApprox(expected.model.inertias[1])
    np.testing.assert_array_equal(found.model.armature, expected.model.armature)
    np.testing.assert_array_equal(found.limits.effort_upper, expected.limits.effort_upper)
    np.testing.assert_array_equal(found.limits.position_upper, expected.limits.position_upper)


def test_an_include_that_is_a_loop_of_links_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "loop.xml").symlink_to("loop.xml")
    with pytest.raises(rt.InputError, match="loop.xml' cannot be read: Too many levels of symbolic links"):
        rt.load(write(tmp_path, scene='<mujoco><include file="loop.xml"/></mujoco>'))


@pytest.mark.parametrize(
    ("include", "message"),
    [
        ('<include file="scene.xml"/>', "twice, or itself"),
        ('<include file="../outside.xml"/>', "outside its folder"),
        ('<include file="/etc/passwd"/>', "outside its folder"),
        ('<include file="missing.xml"/>', "does not exist"),
        ("<include/>", "without a file"),
        ('<include file="twice.xml"/><include file="twice.xml"/>', "twice, or itself"),
        ('<include file="urdf.xml"/>', "its top element is <robot>"),
        ('<include file="broken.xml"/>', "no well-formed XML"),
    ],
)
def test_other_includes_are_refused_by_name(tmp_path: Path, include: str, message: str) -> None:
    """Each message names the file."""
    folder = tmp_path / "inside"
    folder.mkdir()
    (tmp_path / "outside.xml").write_text("<mujocoinclude/>")
    texts = {"twice": "<mujocoinclude/>", "urdf": "<robot/>", "broken": "<mujoco"}
    with pytest.raises(rt.InputError, match=message):
        rt.load(write(folder, scene=WHOLE.replace("</mujoco>", f"{include}</mujoco>"), **texts))
