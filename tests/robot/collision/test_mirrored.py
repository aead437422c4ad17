"""A mesh and its mirror image have mirrored spheres."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import robotraj as rt
from robotraj.robot.collision.robot_spheres import robot_spheres
from robotraj.robot.collision.tessellation import outward

LINK = (
    '<robot name="one"><link name="base"/><link name="arm"><inertial><mass value="1"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><mesh filename="angle.stl" scale="{}"/></geometry></collision></link>'
    '<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>'
    '<limit lower="-3" upper="3" velocity="5" effort="20"/></joint></robot>'
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("mirrored")
    move = trimesh.transformations.translation_matrix
    upright = trimesh.creation.box((0.1, 0.04, 0.4), move((0, 0, 0.2)))
    across = trimesh.creation.box((0.04, 0.3, 0.04), move((0, 0.15, 0.4)))
    trimesh.util.concatenate([upright, across]).export(path / "angle.stl")
    return path


def spheres(folder, scale):
    (folder / "one.urdf").write_text(LINK.format(scale), encoding="utf-8")
    return robot_spheres(rt.load(folder / "one.urdf"))


@pytest.mark.parametrize("scale", ["1 -1 1", "-1 1 1", "-1 -1 -1"])
def test_a_mirrored_mesh_is_enclosed_as_well_as_its_original(folder, scale):
    (original,), (image,) = spheres(folder, "1 1 1").fits, spheres(folder, scale).fits
    assert image.spheres == original.spheres > 5
    assert image.protrusion == pytest.approx(original.protrusion, rel=0.1)
    assert image.excess == pytest.approx(original.excess, abs=0.1)


def test_triangles_point_outwards():
    mesh = trimesh.creation.icosphere(radius=0.3)
    triangles = np.asarray(mesh.triangles) + [1.0, 2.0, 3.0]
    np.testing.assert_array_equal(outward(triangles), triangles)
    np.testing.assert_array_equal(outward(triangles[:, ::-1]), triangles)
