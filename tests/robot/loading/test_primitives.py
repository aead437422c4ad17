"""Shapes of impossible size are skipped with a warning, and judged by nothing; flat ones are kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.collision.tessellation import hull_triangles

ARM = """<robot name="r"><link name="base"/><link name="arm"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry>{shape}</geometry></visual><collision><origin xyz="{origin}"/><geometry>{shape}</geometry></collision>
</link><joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="5" velocity="10"/></joint></robot>"""
BALL = '<sphere radius="0.1"/>'


def arm(folder: Path, shape: str = BALL, origin: str = "0 0 0") -> rt.Robot:
    path = folder / "arm.urdf"
    path.write_text(ARM.format(shape=shape, origin=origin))
    return rt.load(path)


def turn(robot: rt.Robot) -> rt.Phase:
    far = rt.obstacles.Sphere(0.1, position=(3.0, 0.0, 0.0))
    ends = rt.State(q=0, v=0), rt.State(q=0.5, v=0)
    return rt.Phase(robot, 1.0, *ends, rt.Effort(), constraints=[rt.CollisionFree([far])])


@pytest.mark.parametrize(
    "shape",
    [
        '<box size="1e308 1 1"/>',
        '<box size="1e7 1 1"/>',
        '<box size="-1 1 1"/>',
        '<box size="1 1"/>',
        '<box size="nan 1 1"/>',
        '<sphere radius="-0.1"/>',
        '<sphere radius="x"/>',
        "<sphere/>",
        '<cylinder radius="1e300" length="1"/>',
        '<cylinder radius="1"/>',
        '<capsule radius="1" length="inf"/>',
    ],
)
def test_a_shape_of_impossible_size_is_skipped_and_not_judged(shape: str, tmp_path: Path) -> None:
    robot = arm(tmp_path, shape)
    with pytest.warns(UserWarning, match=r"1 collision shape\(s\) of impossible size, skipped: link arm: "):
        assert robot.collision_model.ngeoms == 0
    with pytest.raises(rt.InputError, match=r"None of the <collision> shapes of r was read, those of arm"):
        turn(robot)


@pytest.mark.parametrize("size", ["0 0 0", "0.1 0.2 0", "1e-310 0.1 0.1", "0.1 1e-12 1e-12"])
def test_a_flat_box_is_kept(size: str, tmp_path: Path) -> None:
    robot = arm(tmp_path, f'<box size="{size}"/>')
    solution = rt.plan(turn(robot), rt.Mesh(4), check=False, progress=False)
    assert solution.success
    assert rt.replay(solution, tmp_path / "turn.html").exists()


@pytest.mark.parametrize("origin", ["1e308 0 0", "0 -1e7 0"])
def test_an_origin_beyond_every_robot_is_refused(origin: str, tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match="has an origin with xyz=.*; give three finite numbers up to 1e"):
        arm(tmp_path, origin=origin)


def test_the_hull_of_flat_points_encloses_them() -> None:
    rng = np.random.default_rng(0)
    for spread in ([1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]):
        points = rng.uniform(-1.0, 1.0, (30, 3)) * spread + 0.3
        a, b, c = hull_triangles(points).transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        heights = np.einsum("pfi,fi->pf", points[:, None] - a, normals) / np.linalg.norm(normals, axis=1)
        assert heights.max() < 1e-9
