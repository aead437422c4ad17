"""Of a scene, the robots that stand on the world are read, or the first that moves freely; the rest is named."""

from __future__ import annotations

from pathlib import Path

import pytest

import robotraj as rt

GEOM = '<geom size="0.1"/>'
TABLE = f'<body name="table">{GEOM}</body>'
ARM = f'<body name="arm"><joint name="a"/>{GEOM}</body>'
OTHER = f'<body name="other"><joint name="b"/>{GEOM}</body>'
BALL = f'<body name="ball"><freejoint name="c"/>{GEOM}</body>'
DOG = f'<body name="dog"><joint name="d" type="free"/>{GEOM}<body name="leg"><joint name="e"/>{GEOM}</body></body>'
TARGET = '<body name="target" mocap="true"/>'


@pytest.mark.parametrize(
    ("bodies", "motors", "joints", "left"),
    [
        ((TABLE, ARM), "", ("a",), ()),
        ((TARGET, ARM, OTHER), "", ("a", "b"), ("target",)),
        ((OTHER, ARM), "a", ("a",), ("other",)),
        ((ARM, BALL), "", ("a",), ("ball",)),
        ((BALL, TABLE, ARM), "a", ("a",), ("ball",)),
        ((TABLE, DOG, ARM), "e", ("e",), ("table", "arm")),
    ],
)
def test_the_robot_is_what_has_motors(
    bodies: tuple[str, ...], motors: str, joints: tuple[str, ...], left: tuple[str, ...], tmp_path: Path
) -> None:
    path = tmp_path / "scene.xml"
    motor = f'<actuator><motor joint="{motors}"/></actuator>' if motors else ""
    key = '<keyframe><key name="home" qpos="0 0 0 0 0 0 0 0 0 0"/></keyframe>' if left else ""
    path.write_text(f"<mujoco><worldbody>{''.join(bodies)}</worldbody>{motor}{key}</mujoco>")
    robot = rt.load(path)
    assert tuple(name for name in robot.velocity_names if not name.startswith(("d_", "root_"))) == joints
    named = [note for note in robot.notes if note.startswith("Bodies beside the robot")]
    assert bool(named) == bool(left)
    assert all(repr(name) in note for note in named for name in left)
    assert robot.root == ("floating" if DOG in bodies else "fixed")
