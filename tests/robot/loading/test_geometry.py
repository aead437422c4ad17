"""Shapes are found without package_dirs, follow the planning model, and are optional."""

from __future__ import annotations

import pickle
import shutil
import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find
from robotraj.robot.known_robots.example_robots import folder

MESH = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
SLIDER = ("s", "prismatic", "1 0 0")


def placements(model, shapes, q):
    data, places = model.createData(), shapes.createData()
    pin.updateGeometryPlacements(model, data, shapes, places, q)
    return [place.homogeneous for place in places.oMg]


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_locked_and_angular_robots_keep_their_shapes_in_place(name):
    path, share = str(find(name).urdf), str(folder().parents[1])
    original = pin.buildModelFromUrdf(path)
    expected = pin.buildGeomFromUrdf(original, path, pin.GeometryType.VISUAL, None, share)
    joint = original.names[3]
    robot = rt.load(name, locked={joint: 0.7})
    rng = np.random.default_rng(5)
    angle = dict(zip(list(original.names)[1:], rng.uniform(-2, 2, original.nv), strict=True)) | {joint: 0.7}
    q = pin.neutral(original)
    for name_, item in zip(list(original.names)[1:], list(original.joints)[1:], strict=True):
        value = angle[name_]
        q[item.idx_q : item.idx_q + item.nq] = [value] if item.nq == 1 else [np.cos(value), np.sin(value)]
    mine = placements(robot.model, robot.visual_model, np.array([angle[j] for j in robot.joint_names]))
    assert len(mine) == expected.ngeoms > 5
    for one, other in zip(placements(original, expected, q), mine, strict=True):
        np.testing.assert_allclose(other, one, atol=1e-12)


@pytest.mark.parametrize("name", ["double_pendulum", "ur5"])
def test_a_wrapper_brings_its_shapes(name):
    share = str(folder().parents[1])
    wrapper = pin.RobotWrapper.BuildFromURDF(str(find(name).urdf), [share])
    robot = rt.load(wrapper)
    assert robot.visual_model.ngeoms == wrapper.visual_model.ngeoms > 0
    joint = robot.joint_names[0]
    locked = rt.load(wrapper, locked={joint: 0.3})
    q = np.full(robot.nq, 0.3)
    whole = placements(robot.model, robot.visual_model, q)
    np.testing.assert_allclose(placements(locked.model, locked.visual_model, q[1:]), whole, atol=1e-12)
    assert wrapper.visual_model.geometryObjects[-1].parentJoint == robot.nq


def test_a_bare_model_has_no_shapes():
    robot = rt.load(pin.buildSampleModelManipulator())
    assert robot.visual_model.ngeoms == robot.collision_model.ngeoms == 0


AROUND = ["package://my_robot/meshes/part.obj", "../meshes/part.obj", "{absolute}", "file://{absolute}"]


@pytest.fixture
def package(tmp_path, urdf):
    """Return a function that writes a package whose URDF, in a separate folder, names a mesh."""

    def write(address):
        folder = tmp_path / "my_robot"
        for place in (folder / "meshes", folder / "urdf" / "meshes"):
            place.mkdir(parents=True)
        for place in (folder / "meshes" / "part.obj", folder / "urdf" / "meshes" / "inside.obj"):
            place.write_text(TETRAHEDRON, encoding="utf-8")
        shapes = MESH.format(address.format(absolute=folder / "meshes" / "part.obj"))
        return shutil.move(urdf.chain(SLIDER, shapes=shapes), folder / "urdf" / "robot.urdf")

    return write


@pytest.mark.parametrize("address", [*AROUND, "meshes/inside.obj"])
def test_trusted_paths_are_read_wherever_they_lead(package, address):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(package(address), trust_paths=True).visual_model.ngeoms == 2


@pytest.mark.parametrize("address", AROUND)
def test_meshes_outside_the_folder_are_not_read_unless_it_is_named(package, address):
    path = package(address)
    with pytest.warns(UserWarning, match=r"skipped: .*part.obj \(link base\).*package_dirs"):
        assert rt.load(path).visual_model.ngeoms == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(path, package_dirs=path.parents[2]).visual_model.ngeoms == 2


def test_meshes_in_the_folder_are_read(package):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(package("meshes/inside.obj")).visual_model.ngeoms == 2


def test_a_link_out_of_the_folder_is_not_followed(package):
    path = package("meshes/link.obj")
    (path.parent / "meshes" / "link.obj").symlink_to(path.parents[1] / "meshes" / "part.obj")
    with pytest.warns(UserWarning, match="outside the URDF's folder.*trust_paths=True"):
        assert rt.load(path).visual_model.ngeoms == 0
    assert rt.load(path, trust_paths=True).visual_model.ngeoms == 2


def test_an_unreadable_mesh_is_named_and_the_other_shapes_stay(urdf):
    (urdf.folder / "damaged.stl").write_bytes(b"no triangles" * 20)
    (urdf.folder / "sound.obj").write_text(TETRAHEDRON, encoding="utf-8")
    path = urdf.chain(SLIDER, shapes=MESH.format("damaged.stl") + MESH.format("sound.obj"))
    with pytest.warns(UserWarning, match=r"not readable and skipped: .*damaged.stl \(link base: it ann") as caught:
        assert rt.load(path).visual_model.ngeoms == 2
    assert len(caught) == 1


def test_package_dirs_and_ros_paths_are_searched(tmp_path, urdf, monkeypatch):
    (tmp_path / "elsewhere" / "parts" / "m").mkdir(parents=True)
    (tmp_path / "elsewhere" / "parts" / "m" / "part.obj").write_text(TETRAHEDRON, encoding="utf-8")
    path = urdf.chain(SLIDER, shapes=MESH.format("package://parts/m/part.obj"))
    for given in (tmp_path / "elsewhere", str(tmp_path / "elsewhere"), [tmp_path, tmp_path / "elsewhere"]):
        assert rt.load(path, package_dirs=given).visual_model.ngeoms == 2
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{tmp_path / 'elsewhere'}")
    assert rt.load(path, trust_paths=True).visual_model.ngeoms == 2
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    (tmp_path / "elsewhere").rename(tmp_path / "share")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert rt.load(path, trust_paths=True).visual_model.ngeoms == 2


def test_a_missing_mesh_is_named_and_the_other_shapes_stay(urdf):
    box = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    robot = rt.load(urdf.chain(SLIDER, shapes=box + MESH.format("package://lost/arm.stl")))
    with pytest.warns(UserWarning, match=r"package://lost/arm.stl \(link link1\).*package_dirs") as caught:
        shapes = robot.visual_model
    assert len(caught) == 1
    assert shapes.ngeoms == 2
    assert robot.visual_model is shapes


def test_a_robot_pickles_without_its_meshes():
    robot = rt.load("ur5")
    assert robot.visual_model.ngeoms == 7
    text = pickle.dumps(robot)
    assert len(text) < 40_000
    copy = pickle.loads(text)
    assert copy.joint_names == robot.joint_names
    assert copy.visual_model.ngeoms == 7
    np.testing.assert_array_equal(copy.limits.effort, robot.limits.effort)
