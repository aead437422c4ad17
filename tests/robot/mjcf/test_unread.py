"""What Pinocchio's reader would drop without a word is refused or named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt

BODY = '<body name="b"><joint name="j" range="-9 9"/><geom name="g" size="0.1"/></body>'


def load(folder: Path, inside: str, before: str = "") -> rt.Robot:
    path = folder / "scene.xml"
    path.write_text(f"<mujoco>{before}<worldbody>{inside}</worldbody></mujoco>")
    return rt.load(path)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        (f'<frame pos="0 0 1">{BODY}</frame>', "inside <frame>"),
        (f'{BODY}<attach model="other" body="x" prefix="y"/>', "adds bodies by <attach>"),
        (f'<replicate count="3" offset="1 0 0">{BODY}</replicate>', "adds bodies by <replicate>"),
        ('<geom type="plane" size="1 1 1"/>', "has no <body> in its <worldbody>"),
    ],
)
def test_bodies_that_would_be_dropped_are_refused(inside: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match=message):
        load(tmp_path, inside)


def test_height_fields_and_fluids_are_named(tmp_path: Path) -> None:
    hill = '<asset><hfield name="hill" nrow="2" ncol="2" size="1 1 1 1"/></asset><option viscosity="0.1"/>'
    robot = load(tmp_path, f'<geom type="hfield" hfield="hill"/>{BODY}', hill)
    assert any("'hill'" in note for note in robot.notes)
    assert any("viscosity of <option>" in note for note in robot.notes)


def test_gravity_may_be_disabled(tmp_path: Path) -> None:
    np.testing.assert_array_equal(load(tmp_path, BODY).model.gravity.linear, [0, 0, -9.81])
    none = load(tmp_path, BODY, '<option><flag gravity="disable"/></option>')
    np.testing.assert_array_equal(none.model.gravity.linear, [0, 0, 0])
