"""Macros of xacro: the robot that they make, and what they may not read."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

pytest.importorskip("xacro")

HEAD = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
MACRO = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="rod" params="name parent m l">
<link name="${name}"><inertial><origin xyz="0 0 ${l / 2}"/><mass value="${m}"/><inertia ixx="${m * l * l / 12}"
iyy="${m * l * l / 12}" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="${l} 0.1 0.1"/></geometry></collision></link>
<joint name="${name}_joint" type="revolute"><parent link="${parent}"/><child link="${name}"/><axis xyz="0 1 0"/>
<limit lower="${-radians(90)}" upper="${radians(90)}" velocity="2" effort="9"/></joint></xacro:macro></robot>"""
USE = '<link name="base"/><xacro:rod name="rod" parent="base" m="3" l="0.4"/></robot>'


@pytest.fixture
def package(tmp_path):
    """Folder of a package with a macro of its own; the URDF that uses it is written by each test."""
    folder = tmp_path / "arm_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arms</name></package>")
    (folder / "urdf" / "rod.xacro").write_text(MACRO)
    return folder


def written(package, text):
    path = package / "urdf" / "arm.urdf.xacro"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "place", ["rod.xacro", "$(find arm_description)/urdf/rod.xacro", "$(find arms)/urdf/rod.xacro"]
)
def test_a_rod_of_macros_has_the_inertia_of_a_rod(package, place):
    robot = rt.load(written(package, f'{HEAD}<xacro:include filename="{place}"/>{USE}'))
    assert robot.limits.position_upper[0] == pytest.approx(np.pi / 2)
    pull = pin.rnea(robot.model, robot.model.createData(), np.zeros(1), np.zeros(1), np.ones(1))
    assert pull[0] == pytest.approx(3 * 0.4**2 / 3)
    shape = robot.collision_model.geometryObjects[0].geometry
    np.testing.assert_allclose(2 * shape.halfSide, [0.4, 0.1, 0.1])


def test_arguments_take_their_defaults_and_an_unknown_one_is_named(package):
    include = '<xacro:include filename="rod.xacro"/>'
    joint = USE.replace('m="3"', 'm="$(arg mass)"')
    robot = rt.load(written(package, f'{HEAD}<xacro:arg name="mass" default="7"/>{include}{joint}'))
    assert robot.mass == pytest.approx(7)
    with pytest.raises(rt.InputError, match="mass.*NAME:=VALUE"):
        rt.load(written(package, f"{HEAD}{include}{joint}"))


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ('<xacro:include filename="{outside}/secret.xacro"/>', "package_dirs= or trust_paths=True.*secret.xacro"),
        ('<xacro:include filename="$(find elsewhere)/rod.xacro"/>', "'elsewhere' is not found.*package_dirs"),
        (
            '<xacro:property name="x" value="${{xacro.load_yaml(\'{outside}/secret.yaml\')}}"/><link name="${{x}}"/>',
            "trust_paths",
        ),
        ('<xacro:rod name="a"/>', "rod"),
        ('<link name="${{1 / 0}}"/>', "zero"),
        ('<link name="${{unknown}}"/>', "unknown"),
        ('<link name="${{[0] * 10**9}}"/>', "MB"),
    ],
)
def test_macros_that_fail_or_reach_elsewhere_are_refused(package, tmp_path, text, part):
    (tmp_path / "secret.xacro").write_text(MACRO)
    (tmp_path / "secret.yaml").write_text("key: 1")
    path = written(package, f"{HEAD}{text.format(outside=tmp_path)}{USE}")
    with pytest.raises(rt.InputError, match=part):
        rt.load(path)


def test_trusted_macros_include_files_elsewhere(package, tmp_path):
    (tmp_path / "rod.xacro").write_text(MACRO)
    path = written(package, f'{HEAD}<xacro:include filename="{tmp_path}/rod.xacro"/>{USE}')
    assert rt.load(path, trust_paths=True).mass == rt.load(path, package_dirs=tmp_path).mass == pytest.approx(3)


def test_without_xacro_the_commands_are_named(package, monkeypatch):
    monkeypatch.setattr("robotraj.robot.macros.expansion.find_spec", lambda name: None)
    path = written(package, f'{HEAD}<xacro:include filename="rod.xacro"/>{USE}')
    with pytest.raises(rt.InputError, match=r"'pip install xacro'.*'xacro arm.urdf.xacro > arm_expanded.urdf'"):
        rt.load(path)


def test_macros_are_expanded_once_and_shapes_belong_to_the_loaded_model(package, monkeypatch):
    path = written(package, f'{HEAD}<xacro:include filename="rod.xacro"/>{USE}')
    robot = rt.load(path)
    path.write_text("edited meanwhile")
    monkeypatch.setattr("robotraj.robot.urdf.xml.expanded", None)
    assert robot.collision_model.ngeoms == 1
    assert robot.geometry.stated(pin.GeometryType.COLLISION)["rod"] == 1
