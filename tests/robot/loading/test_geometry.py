"""Shapes are found without package_dirs, follow the planning model, and are optional."""

from __future__ import annotations

import contextlib
import pickle
import re
import shutil
import warnings

import numpy as np
import pinocchio as pin
import pytest
import trimesh
from typer.testing import CliRunner

import robotraj as rt
from robotraj.cli.app import app
from robotraj.robot.known_robots.catalogue import find
from robotraj.robot.known_robots.example_robots import folder
from robotraj.robot.loading.packages import find_mesh, package_of

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


BESIDE = [
    "package://my_robot/meshes/part.obj",
    "../meshes/part.obj",
    "file://../meshes/part.obj",
    "{package}/meshes/part.obj",
]
AROUND = ["package://other/part.obj", "../../other/part.obj", "{above}/other/part.obj", "file://{above}/other/part.obj"]


@pytest.fixture
def package(tmp_path, urdf):
    """Return a function that writes a package whose URDF, in a separate folder, names a mesh."""

    def write(address):
        folder = tmp_path / "my_robot"
        places = (folder / "meshes", folder / "urdf" / "meshes", tmp_path / "other")
        for place, name in zip(places, ("part.obj", "inside.obj", "part.obj"), strict=True):
            place.mkdir(parents=True)
            (place / name).write_text(TETRAHEDRON, encoding="utf-8")
        shapes = MESH.format(address.format(package=folder, above=tmp_path))
        return shutil.move(urdf.chain(SLIDER, shapes=shapes), folder / "urdf" / "robot.urdf")

    return write


@pytest.mark.parametrize("address", [*AROUND, *BESIDE, "meshes/inside.obj"])
def test_trusted_paths_are_read_wherever_they_lead(package, address):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(package(address), trust_paths=True).visual_model.ngeoms == 2


@pytest.mark.parametrize("address", [*BESIDE, "meshes/inside.obj"])
def test_meshes_of_the_package_are_read(package, address):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(package(address)).visual_model.ngeoms == 2


SPELLED = ["../meshes/part%202.OBJ", "package://my_robot/Meshes/Part 2.obj", "file://{package}/MESHES/part%202.obj"]


@pytest.mark.parametrize("address", SPELLED)
def test_names_written_as_addresses_or_in_another_case_find_their_file(package, address):
    path = package(address)
    (path.parents[1] / "meshes" / "part 2.obj").write_text(TETRAHEDRON, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(path).visual_model.ngeoms == 2


def test_the_name_as_written_comes_first_and_two_that_fit_are_none(tmp_path):
    for name in ("a%20b.obj", "a b.obj", "C.obj", "c.obj"):
        (tmp_path / name).touch()
    urdf = tmp_path / "robot.urdf"
    assert find_mesh("a%20b.obj", urdf, [tmp_path]) == tmp_path / "a%20b.obj"
    assert find_mesh("A%20b.obj", urdf, [tmp_path]) == tmp_path / "a b.obj"
    assert find_mesh("c.obj", urdf, [tmp_path]) == tmp_path / "c.obj"
    assert find_mesh("c.OBJ", urdf, [tmp_path]) is None


@pytest.mark.parametrize("address", ["../%2e%2e/other/part.obj", "../../OTHER/part.obj"])
def test_no_spelling_leads_out_of_the_package(package, address):
    path = package(address)
    with pytest.warns(UserWarning, match="1 of 1 mesh files are not read"):
        assert rt.load(path).visual_model.ngeoms == 0


@pytest.mark.parametrize("address", AROUND)
def test_meshes_outside_the_package_are_named_once_with_the_call_that_reads_them(package, address):
    path = package(address)
    with pytest.warns(UserWarning, match=r"1 of 1 mesh files are not read: 1 in .*other") as caught:
        robot = rt.load(path)
    assert robot.visual_model.ngeoms == 0
    (message,) = (str(each.message) for each in caught)
    folder = re.search(r"package_dirs='([^']*)'", message).group(1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rt.load(path, package_dirs=folder).visual_model.ngeoms == 2


def test_meshes_that_do_not_exist_are_counted_by_folder(tmp_path, urdf):
    shapes = "".join(MESH.format(f"package://arm/meshes/{name}.stl") for name in "abc") + MESH.format("gone/d.stl")
    with pytest.warns(UserWarning, match=r"4 of 4 .*: 3 in package://arm/meshes, 1 in gone. .* contains 'arm'"):
        rt.load(urdf.chain(SLIDER, shapes=shapes))
    with pytest.warns(UserWarning, match=r"1 of 1 .*: 1 in the URDF's folder, the first 'e.stl'. Name their folder"):
        rt.load(urdf.chain(SLIDER, shapes=MESH.format("e.stl")))


@pytest.mark.parametrize(
    ("files", "where", "package"),
    [
        (["a/package.xml"], "a/robots/deep/er", "a"),
        ([], "a/urdf", "a"),
        ([], "a/urdf/robots", "a"),
        ([], "a/models", "a"),
        ([], "a_description/x", "a_description"),
        ([], "a/x", "a/x"),
        (["package.xml"], "b", "."),
    ],
)
def test_the_package_of_a_urdf(tmp_path, files, where, package):
    (tmp_path / where).mkdir(parents=True)
    for name in files:
        (tmp_path / name).touch()
    assert package_of(tmp_path / where / "robot.urdf") == (tmp_path / package).resolve()


def test_home_and_temporary_folders_are_no_packages(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "robots").mkdir()
    assert package_of(tmp_path / "robots" / "arm.urdf") == tmp_path / "robots"


def test_relative_package_dirs_are_those_of_the_time_of_loading(package, monkeypatch):
    path = package("package://other/part.obj")
    monkeypatch.chdir(path.parents[2])
    robot = rt.load(path, package_dirs=".")
    monkeypatch.chdir(path.parent)
    assert robot.visual_model.ngeoms == 2
    assert pickle.loads(pickle.dumps(robot)).visual_model.ngeoms == 2
    with pytest.raises(rt.InputError, match="package_dirs= names 'nowhere', which is no folder"):
        rt.load(path, package_dirs="nowhere")


def test_the_shell_and_problem_files_take_package_dirs(package, monkeypatch):
    path = package("package://other/part.obj")
    monkeypatch.chdir(path.parents[2])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for command in (
            ("show", str(path), "--package-dirs", "."),
            ("show", str(path), "--trust-paths"),
            ("init", str(path), "problem.toml", "--package-dirs", "."),
        ):
            result = CliRunner().invoke(app, list(command))
            assert result.exit_code == 0, result.output
        robot = rt.load_problem("problem.toml").problem.phases[0].robot
    assert robot.visual_model.ngeoms == 2


def test_a_link_out_of_the_package_is_not_followed(package):
    path = package("meshes/link.obj")
    (path.parent / "meshes" / "link.obj").symlink_to(path.parents[2] / "other" / "part.obj")
    with pytest.warns(UserWarning, match="outside the URDF's package.*trust_paths=True"):
        assert rt.load(path).visual_model.ngeoms == 0
    assert rt.load(path, trust_paths=True).visual_model.ngeoms == 2


def test_a_mesh_that_is_a_loop_of_links_is_a_warning(package):
    path = package("meshes/loop.obj")
    (path.parent / "meshes" / "loop.obj").symlink_to("loop.obj")
    with pytest.warns(UserWarning, match="mesh files are not read"):
        assert rt.load(path).visual_model.ngeoms == 0


@pytest.mark.parametrize(("unit", "size"), [("0.001", 0.4), ("0.0254", 10.16), ("1", 400.0)])
def test_the_unit_of_a_collada_file_is_applied(urdf, unit, size):
    trimesh.creation.box((100, 40, 400)).export(urdf.folder / "plain.dae")
    text = (urdf.folder / "plain.dae").read_text(encoding="utf-8")
    text = re.sub("<up_axis>.*?</up_axis>", f'<unit name="u" meter="{unit}"/><up_axis>Z_UP</up_axis>', text)
    (urdf.folder / "box.dae").write_text(text, encoding="utf-8")
    robot = rt.load(urdf.chain(SLIDER, shapes=MESH.format("box.dae")))
    doubted = pytest.warns(UserWarning, match=r"size that the robot can hardly have: .*link1 \(400 m\)")
    with doubted if size > 100 else contextlib.nullcontext():
        shape = robot.visual_model.geometryObjects[0].geometry
    shape.computeLocalAABB()
    assert np.max(shape.aabb_local.max_ - shape.aabb_local.min_) == pytest.approx(size)


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
    path = urdf.chain(SLIDER, shapes=box + MESH.format("package://lost/arm.stl"))
    with pytest.warns(UserWarning, match=r"1 of 1 mesh files are not read: 1 in package://lost"):
        robot = rt.load(path)
    assert robot.visual_model.ngeoms == 2


def test_a_robot_pickles_without_its_meshes():
    robot = rt.load("ur5")
    assert robot.visual_model.ngeoms == 7
    text = pickle.dumps(robot)
    assert len(text) < 40_000
    copy = pickle.loads(text)
    assert copy.joint_names == robot.joint_names
    assert copy.visual_model.ngeoms == 7
    np.testing.assert_array_equal(copy.limits.effort, robot.limits.effort)
