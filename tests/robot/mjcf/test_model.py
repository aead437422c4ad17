"""Models of MuJoCo have the masses, motors and limits of their file, and plan."""

from __future__ import annotations

import os

import numpy as np
import pinocchio as pin
import pytest
import trimesh

import robotraj as rt

ARM = """<mujoco model="arm"><compiler angle="radian" meshdir="meshes"/>{asset}
<default><joint damping="0.5" armature="0.02"/></default>
<worldbody><body name="upper" pos="0 0 0.2">
<joint name="shoulder" type="hinge" axis="0 1 0" range="-2 2"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.4" mass="1"/>
<body name="fore" pos="0 0 0.4"><joint name="elbow" type="hinge" axis="0 1 0" range="-2 2" frictionloss="0.1"/>
<inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.002"/>{geom}
<body name="ram"><joint name="slide" type="slide" axis="0 0 1" range="0 0.1"/>
<geom type="sphere" size="0.03" mass="0.2"/></body>
</body></body></worldbody>
<actuator><motor joint="shoulder" ctrlrange="-3 2" gear="10"/>
<position joint="slide" kp="9" forcerange="-15 15"/></actuator>{more}</mujoco>"""
BOX = '<geom type="box" size="0.02 0.02 0.1"/>'


def write(folder, asset="", geom=BOX, more=""):
    path = folder / "arm.xml"
    path.write_text(ARM.format(asset=asset, geom=geom, more=more), encoding="utf-8")
    return path


def test_masses_motors_and_limits_are_those_of_the_file(tmp_path):
    robot = rt.load(write(tmp_path))
    assert robot.joint_names == ("shoulder", "elbow", "slide")
    assert robot.actuated == ("shoulder", "slide")
    np.testing.assert_array_equal(robot.limits.sides("position"), [[-2, -2, 0], [2, 2, 0.1]])
    np.testing.assert_array_equal(robot.limits.sides("effort"), [[-30, -np.inf, -15], [20, np.inf, 15]])
    np.testing.assert_array_equal(robot.damping, [0.5, 0.5, 0.5])
    np.testing.assert_array_equal(robot.friction, [0, 0.1, 0])
    assert robot.collision_model.ngeoms == 3


def test_accelerations_are_those_of_mujoco(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    path = write(tmp_path)
    robot, model = rt.load(path), mujoco.MjModel.from_xml_path(str(path))
    flags = mujoco.mjtDisableBit
    model.opt.disableflags |= flags.mjDSBL_CONSTRAINT | flags.mjDSBL_ACTUATION
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(5):
        q, v, tau = rng.uniform(-1.0, 1.0, (3, 3))
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, v, tau
        mujoco.mj_forward(model, data)
        own = pin.aba(robot.model, robot.model.createData(), q, v, tau - robot.damping * v)
        np.testing.assert_allclose(own, data.qacc, rtol=1e-8, atol=1e-8)


def test_it_plans_and_is_proved(tmp_path):
    robot = rt.load(write(tmp_path), actuated=["shoulder", "elbow", "slide"])
    ends = rt.State(q=[0.0, 0.5, 0.05], v=0), rt.State(q=[1.0, -0.5, 0.02], v=0)
    solution = rt.plan(rt.Phase(robot, 2.0, *ends, rt.Effort()), progress=False)
    assert solution.proof.motion_holds


def test_meshes_are_read_within_limits(tmp_path):
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "meshes" / "box.stl")
    asset, geom = '<asset><mesh name="box" file="box.stl"/></asset>', '<geom type="mesh" mesh="box"/>'
    assert rt.load(write(tmp_path, asset, geom)).collision_model.ngeoms == 3
    (tmp_path / "meshes" / "box.stl").write_bytes(b"no mesh")
    with pytest.raises(rt.InputError, match=r"the mesh .*box.stl' cannot be read"):
        rt.load(write(tmp_path, asset, geom))


def test_meshes_outside_the_folder_are_read_when_trusted_alone(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "box.stl")
    asset, geom = '<asset><mesh name="box" file="../../box.stl"/></asset>', '<geom type="mesh" mesh="box"/>'
    (inner / "meshes").mkdir()
    path = write(inner, asset, geom)
    with pytest.raises(rt.InputError, match="lies outside the folder of the file"):
        rt.load(path)
    assert rt.load(path, trust_paths=True).collision_model.ngeoms == 3
    assert rt.load(path, package_dirs=tmp_path).collision_model.ngeoms == 3


def test_what_is_not_read_is_named(tmp_path):
    tied = '<equality><joint joint1="shoulder" joint2="elbow" polycoef="0 1 2 0 0"/></equality>'
    with pytest.warns(UserWarning, match="Sections of the MJCF that are not read: <equality>"):
        rt.load(write(tmp_path, more=tied))
    with pytest.raises(rt.InputError, match="Pinocchio cannot read the MJCF"):
        rt.load(write(tmp_path, geom=BOX + '<joint type="screw"/>'))


@pytest.mark.parametrize("name", ["mtllib", "outer"])
def test_files_that_meshes_name_are_not_opened(tmp_path, name):
    """The reader of OBJ would wait for the pipe without end, and read what lies above the folder of meshes."""
    folder = tmp_path / "robot"
    (folder / "meshes").mkdir(parents=True)
    os.mkfifo(folder / "meshes" / "pipe.mtl")
    box = trimesh.creation.box((0.1, 0.1, 0.2)).export(file_type="obj")
    (folder / "meshes" / "mtllib.obj").write_text("mtllib pipe.mtl\n" + box.replace("mtllib", "#"))
    (folder / "meshes" / "outer.obj").write_text("mtllib ../../../etc/passwd\n" + box.replace("mtllib", "#"))
    asset, geom = f'<asset><mesh name="box" file="{name}.obj"/></asset>', '<geom type="mesh" mesh="box"/>'
    shape = rt.load(write(folder, asset, geom)).collision_model.geometryObjects[1]
    assert shape.meshPath == str(folder / "meshes" / f"{name}.obj")
    shape.geometry.computeLocalAABB()
    box = shape.geometry.aabb_local
    np.testing.assert_allclose(box.max_ - box.min_, [0.1, 0.1, 0.2], atol=1e-6)


def test_meshes_of_every_compiler_and_class_lie_inside(tmp_path):
    (tmp_path / "inner" / "meshes").mkdir(parents=True)
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "box.stl")
    mesh, geom = '<mesh name="box" file="box.stl"/>', '<geom type="mesh" mesh="box"/>'
    for asset in (
        f'<asset>{mesh}</asset><compiler meshdir="../.."/>',
        '<default><mesh file="../../box.stl"/></default><asset><mesh name="box"/></asset>',
        f"<asset><x>{mesh.replace('box.stl', '../../box.stl')}</x></asset>",
    ):
        with pytest.raises(rt.InputError, match="lies outside the folder|cannot be read"):
            rt.load(write(tmp_path / "inner", asset, geom))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('size="0.02 0.02 0.1"', 'size="nan 0.02 0.1"', r"size='nan 0.02 0.1' of <geom>.* not finite"),
        ('size="0.02 0.02 0.1"', 'size="a b c"', "size='a b c' of <geom>"),
        ('axis="0 0 1"', 'axis="0 0 0"', "axis='0 0 0' of <joint> 'slide' is no direction"),
        ('axis="0 0 1"', 'axis="nan 0 1"', "axis='nan 0 1' of <joint> 'slide'"),
        ('mass="0.5"', 'mass="-0.5"', "mass='-0.5' of <inertial>.* is negative"),
        ('diaginertia="0.01 0.01 0.002"', 'diaginertia="0.01 -0.01 0.002"', "of <inertial>.* is negative"),
        ('size="0.02 0.02 0.1"', 'size="1e308"', "up to 1e"),
        ('size="0.02 0.02 0.1"', 'size="0.02"', "size='0.02' of a box has 1 numbers; give 3"),
        (' size="0.02 0.02 0.1"', "", "size='' of a box has 0 numbers"),
        ('size="0.02 0.02 0.1"', 'size="0.02 -1 0.1"', "is negative"),
        ('pos="0 0 0.4"', 'pos="0 0"', "pos='0 0' of <body> 'fore' has 2 numbers; give 3"),
        ('range="0 0.1"', 'range="0"', "range='0' of <joint> 'slide' has 1 numbers; give 2"),
        ('name="elbow"', 'name="shoulder"', "2 elements <joint> are named 'shoulder'; give each its own name"),
        ('name="elbow"', 'name="universe"', "is named 'universe', Pinocchio's name of the world"),
        ('name="fore"', 'name="upper"', "2 elements <body> are named 'upper'"),
        ('gear="10"', 'gear=" "', "gear=' ' of <motor>.* has 0 numbers; give 1"),
        ('name="fore"', 'name="' + "f" * 5000 + '"', "5000 characters"),
    ],
)
def test_numbers_that_no_robot_has_are_refused(tmp_path, old, new, message):
    """Pinocchio's reader leaves memory as it was where a text is no number."""
    path = write(tmp_path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(rt.InputError, match=message):
        rt.load(path)


def test_sizes_of_a_class_count(tmp_path):
    path = write(tmp_path, geom='<geom type="box" class="thin"/>')
    text = path.read_text().replace(
        "<default><joint", '<default><default class="thin"><geom size="1 2"/></default><joint'
    )
    path.write_text(text)
    with pytest.raises(rt.InputError, match="size='1 2' of a box has 2 numbers"):
        rt.load(path)
    path.write_text(text.replace('size="1 2"', 'size="1 2 3"'))
    assert rt.load(path).collision_model.ngeoms == 3


@pytest.mark.parametrize("many", [1, 50_000])
@pytest.mark.parametrize("flat", [False, True])
def test_the_hull_of_stated_vertices_is_the_shape(tmp_path, many, flat):
    corners = "0 0 0 0.1 0 0 0 0.2 0 " + ("0 0 0.3 " if not flat else "0.1 0.2 0 ")
    asset, geom = f'<asset><mesh name="m" vertex="{corners * many}"/></asset>', '<geom type="mesh" mesh="m"/>'
    robot = rt.load(write(tmp_path, asset, geom))
    shape = robot.collision_model.geometryObjects[1]
    assert shape.meshPath == "" and shape.geometry.num_vertices <= 16
    shape.geometry.computeLocalAABB()
    box = shape.geometry.aabb_local
    np.testing.assert_allclose(box.max_ - box.min_, [0.1, 0.2, 0.0 if flat else 0.3], atol=1e-6)
    with pytest.raises(rt.InputError, match="vertices of the mesh 'm' are none"):
        rt.load(write(tmp_path, asset.replace("0 0 0 ", "0 0 ", 1), geom))


def test_endless_nesting_is_refused(tmp_path):
    path = tmp_path / "deep.xml"
    path.write_text("<mujoco><worldbody>" + "<body><joint/>" * 3000 + "</body>" * 3000 + "</worldbody></mujoco>")
    with pytest.raises(rt.InputError, match="more than 200 elements lie in each other"):
        rt.load(path)


def test_gravity_and_the_range_of_a_joints_force_are_those_of_the_file(tmp_path):
    text = write(tmp_path, more='<option gravity="0 0 -1.62"/>').read_text(encoding="utf-8")
    text = text.replace('name="shoulder" type', 'name="shoulder" actuatorfrcrange="-7 50" type')
    (tmp_path / "arm.xml").write_text(text, encoding="utf-8")
    robot = rt.load(tmp_path / "arm.xml")
    np.testing.assert_array_equal(robot.limits.sides("effort")[0], [-7, -np.inf, -15])
    np.testing.assert_array_equal(robot.limits.sides("effort")[1], [20, np.inf, 15])
    np.testing.assert_array_equal(robot.model.gravity.linear, [0, 0, -1.62])


def test_a_body_without_weight_is_named(tmp_path):
    text = write(tmp_path).read_text(encoding="utf-8")
    (tmp_path / "arm.xml").write_text(text.replace('name="fore"', 'name="fore" gravcomp="1"'), encoding="utf-8")
    with pytest.warns(UserWarning, match="gravcomp.*'fore'"):
        rt.load(tmp_path / "arm.xml")


def test_elements_inside_a_frame_are_refused(tmp_path):
    """Pinocchio drops them, and would load another robot."""
    text = write(tmp_path).read_text(encoding="utf-8")
    begin = text.index('<body name="ram">')
    ram = text[begin : text.index("</body>", begin) + len("</body>")]
    (tmp_path / "arm.xml").write_text(text.replace(ram, f'<frame pos="0 0 1">{ram}</frame>'), encoding="utf-8")
    with pytest.raises(rt.InputError, match="inside <frame>.*: body, geom, joint. Give them the frame's pose"):
        rt.load(tmp_path / "arm.xml")


FLOOR = """<mujoco model="arm"><compiler angle="radian"/><worldbody><geom type="plane" size="1 1 0.1"/>
<body name="upper" pos="0 0 0.3"><joint name="shoulder" type="hinge" axis="0 1 0" range="-2 2"/>
<geom type="capsule" size="0.03" fromto="0 0 0.08 0 0 0.4" mass="1"/>
<body name="fore" pos="0 0 0.4"><joint name="elbow" type="hinge" axis="0 1 0" range="-2.5 2.5"/>
<inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.002"/>
<geom type="capsule" size="0.03" fromto="0 0 0.08 0 0 0.3"/></body></body></worldbody>
<actuator><motor joint="shoulder" ctrlrange="-30 30"/><motor joint="elbow" ctrlrange="-30 30"/></actuator></mujoco>"""
FREE = """<mujoco model="hopping box"><worldbody><body name="base" pos="0 0 1"><freejoint/>
<inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
<body name="leg"><joint name="hip" type="hinge" axis="0 1 0" range="-1 1" limited="true"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/></body></body></worldbody>
<actuator><motor joint="hip" ctrlrange="-5 5"/></actuator></mujoco>"""


def test_a_free_joint_of_the_file_is_a_floating_root(tmp_path):
    """A file with a free joint has a floating root; another root is refused with the remedy."""
    path = tmp_path / "box.xml"
    path.write_text(FREE)
    robot = rt.load(path)
    assert (robot.root, robot.nq, robot.nv, robot.nu) == ("floating", 8, 7, 1)
    np.testing.assert_array_equal(robot.neutral, rt.load(path, root="floating").neutral)
    for root in ("fixed", "planar"):
        with pytest.raises(rt.InputError, match="take the free joint out of the file"):
            rt.load(path, root=root)


def test_the_floor_of_a_file_is_kept_beside_other_obstacles(tmp_path):
    """Between two postures the straight way passes through the floor of the file; the plan stays above it."""
    path = tmp_path / "floor.xml"
    path.write_text(FLOOR)
    robot, ball = rt.load(path), rt.obstacles.Sphere(0.05, position=(0, 0, 1.4))
    first, last = np.array([2.0, -0.15]), np.array([1.3, 2.4])

    def height(q):
        return 0.3 + 0.4 * np.cos(q[:, 0]) + 0.3 * np.cos(q[:, 0] + q[:, 1])

    ends = rt.State(q=first, v=0), rt.State(q=last, v=0)
    plan = rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort(), [rt.CollisionFree([ball])]))
    share = np.linspace(0.0, 1.0, 201)
    assert height(first + share[:, None] * (last - first)).min() < 0.0
    assert plan.proved
    assert height(plan.at(share).q).min() >= 0.03 - 1e-6
    assert rt.validate(plan).passed


NAMELESS = """<mujoco><compiler angle="radian"/>{defaults}<worldbody>
<body><inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/><joint/>
<body><inertial pos="0 0 0.1" mass="2" diaginertia="0.01 0.02 0.01"/><joint axis="0 1 0"/></body>
</body></worldbody></mujoco>"""


@pytest.mark.parametrize("defaults", ["", "<default><joint damping='1'/></default>"])
def test_bodies_and_joints_without_attributes_are_read(tmp_path, defaults):
    """Pinocchio's reader drops such a body with its joint, without a word."""
    path = tmp_path / "nameless.xml"
    path.write_text(NAMELESS.format(defaults=defaults), encoding="utf-8")
    robot = rt.load(path)
    assert (robot.joint_names, robot.mass) == (("joint1", "joint2"), 3.0)


@pytest.mark.parametrize(
    ("attribute", "quantity"),
    [('range="-1 1" limited="false"', "position"), ('actuatorfrcrange="-1 1" actuatorfrclimited="false"', "effort")],
)
def test_a_range_that_is_disabled_is_no_limit(tmp_path, attribute, quantity):
    text = ARM.format(asset="", geom=BOX, more="").replace('axis="0 1 0" range="-2 2"', f'axis="0 1 0" {attribute}', 1)
    path = tmp_path / "arm.xml"
    path.write_text(text.replace('ctrlrange="-3 2"', 'ctrlrange="-3 2" ctrllimited="false"'), encoding="utf-8")
    with pytest.warns(UserWarning, match="Motors without a limit of effort in the MJCF: 'shoulder'"):
        robot = rt.load(path)
    assert robot.limits.largest(quantity)[0] == np.inf


def test_motors_of_one_joint_add_up(tmp_path):
    path = write(tmp_path, more='<actuator><motor jointinparent="shoulder" ctrlrange="-1 1" gear="5"/></actuator>')
    np.testing.assert_array_equal([side[0] for side in rt.load(path).limits.sides("effort")], [-35, 25])


def test_actuators_that_act_on_no_joint_are_named(tmp_path):
    path = write(tmp_path, more='<actuator><motor name="jet" body="fore"/><adhesion body="ram"/></actuator>')
    with pytest.warns(UserWarning, match="Actuators of the MJCF that are not read: jet, <adhesion>. They act on no"):
        rt.load(path)


def test_no_joint_has_a_motor_where_none_is_read(tmp_path):
    text = ARM.format(asset="", geom=BOX, more="")
    start, end = text.index("<actuator>"), text.index("</actuator>")
    path = tmp_path / "arm.xml"
    path.write_text(text[:start] + '<actuator><damper joint="shoulder" kv="2" ctrlrange="0 1"/>' + text[end:])
    with pytest.warns(UserWarning, match="not read: <damper>.*No joint has a motor: name those with one by actuated="):
        robot = rt.load(path)
    assert robot.actuated == () and rt.load(path, actuated=["slide"]).actuated == ("slide",)


def test_ranges_are_those_of_positions_beside_a_reference(tmp_path):
    text = ARM.format(asset="", geom=BOX, more="").replace('range="0 0.1"', 'range="0 0.1" ref="0.1"')
    path = tmp_path / "arm.xml"
    path.write_text(text, encoding="utf-8")
    robot = rt.load(path)
    np.testing.assert_allclose([side[2] for side in robot.limits.sides("position")], [0.0, 0.1], atol=1e-15)
    assert robot.neutral[2] == 0.1
