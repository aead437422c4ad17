"""rt.load and Robot: what can be loaded, the robot's attributes and methods, and the errors of bad input."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import catalogue, find
from robotraj.robot.known_robots.example_robots import folder

ARM = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><mass value="1"/>{inertia}</inertial></link>
<link name="lower"><inertial><mass value="1"/>{inertia}</inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="2" velocity="3" effort="4"/><dynamics damping="0.5" friction="0.2"/></joint>
<joint name="elbow" type="{kind}"><parent link="{parent}"/><child link="lower"/><axis xyz="0 1 0"/>
  {limit}</joint>
</robot>"""
INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
LIMIT = '<limit lower="0" upper="1" velocity="2" effort="10"/>'


@pytest.fixture
def arm(tmp_path):
    return write(tmp_path)


def write(folder, kind="prismatic", limit=LIMIT, parent="upper", name="arm.urdf"):
    path = folder / name
    path.write_text(ARM.format(kind=kind, limit=limit, parent=parent, inertia=INERTIA), encoding="utf-8")
    return path


# -- sources -----------------------------------------------------------------------------------------------


def test_a_name_a_path_a_model_and_a_wrapper_give_the_same_robot():
    path = find("ur5").urdf
    model = pin.buildModelFromUrdf(str(path))
    wrapper = pin.RobotWrapper.BuildFromURDF(str(path), [str(folder().parents[1])])
    robots = [rt.load(source) for source in ("ur5", path, str(path), model, wrapper)]
    q, v, tau = np.random.default_rng(0).normal(size=(3, 6))
    expected = pin.aba(model, model.createData(), q, v, tau)
    for robot in robots:
        assert robot.joint_names == tuple(model.names)[1:]
        np.testing.assert_array_equal(robot.limits.effort, [150, 150, 150, 28, 28, 28])
        np.testing.assert_allclose(pin.aba(robot.model, robot.model.createData(), q, v, tau), expected, rtol=1e-12)
    assert [robot.name for robot in robots] == ["ur5"] * 5


def test_names_in_robots_win(monkeypatch):
    entries = catalogue()
    names = [entry.name for entry in entries]
    assert len(names) == len(set(names))
    own = [e.name for e in entries if e.source == "robots/"]
    assert own == names[: len(own)]
    from robotraj.robot.known_robots import catalogue as module

    own = dataclasses.replace(find("pendulum"), name="ur5")
    monkeypatch.setitem(vars(module), "own_robot", lambda name: own if name == "ur5" else None)
    assert rt.load("ur5").joint_names == ("pivot",)


def test_the_catalogue_describes_every_robot():
    for entry in catalogue():
        assert entry.urdf.is_file()
        assert entry.srdf is None or entry.srdf.is_file()
        assert entry.source in ("robots/", "example-robot-data")
        assert len(entry.description) > 5
        assert entry.licence


def test_talos_legs_is_talos_with_the_rest_locked_at_its_reference():
    talos, legs = rt.load("talos"), rt.load("talos_legs")
    assert legs.nq == 12
    assert all(joint.startswith("leg_") for joint in legs.joint_names)
    data, mine = talos.model.createData(), legs.model.createData()
    pin.framesForwardKinematics(talos.model, data, talos.neutral)
    pin.framesForwardKinematics(legs.model, mine, legs.neutral)
    hand = "gripper_right_base_link"
    expected = data.oMf[talos.frame(hand)].homogeneous
    np.testing.assert_allclose(mine.oMf[legs.frame(hand)].homogeneous, expected, atol=1e-12)


# -- attributes and methods ----------------------------------------------------------------------------------


def test_sizes_names_units_and_actuation(arm):
    robot = rt.load(arm, actuated=["elbow"])
    assert (robot.name, robot.nq, robot.nv, robot.nu) == ("arm", 2, 2, 1)
    assert robot.joint_names == ("shoulder", "elbow")
    assert robot.units == ("rad", "m")
    assert robot.actuated == ("elbow",)
    np.testing.assert_array_equal(robot.actuation, [[0], [1]])
    assert robot.frame("lower") == robot.model.getFrameId("lower")
    assert robot.joint("elbow") == 1
    assert set(robot.frame_names) >= {"base", "upper", "lower", "shoulder", "elbow"}


def test_actuated_joints_keep_the_order_of_v():
    robot = rt.load("ur5", actuated=("wrist_1_joint", "shoulder_pan_joint"))
    assert robot.actuated == ("shoulder_pan_joint", "wrist_1_joint")
    np.testing.assert_array_equal(robot.actuation[[0, 3]], np.eye(2))
    assert robot.actuation.sum() == 2


def test_a_catalogued_robot_has_its_motors_and_the_caller_may_choose_others():
    assert rt.load("acrobot").actuated == ("elbow",)
    assert rt.load("acrobot", actuated=["shoulder", "elbow"]).nu == 2
    assert rt.load("acrobot", actuated=[]).actuation.shape == (2, 0)
    assert rt.load("cartpole", locked={"pole": 0.0}).joint_names == ("slider",)


def test_damping_and_friction_of_the_urdf_dissipate(arm):
    robot = rt.load(arm)
    np.testing.assert_array_equal(robot.damping, [0.5, 0])
    np.testing.assert_array_equal(robot.friction, [0.2, 0])
    v = np.array([0.03, -1.0])
    expected = 0.5 * 0.03 + 0.2 * np.tanh(0.03 / robot.friction_speed)
    np.testing.assert_allclose(robot.dissipation(v), [expected, 0], rtol=1e-15)
    np.testing.assert_allclose(robot.dissipation([10.0, 0])[0], 5.2, rtol=1e-12)
    assert any("<dynamics>" in note for note in robot.notes)
    rough = dataclasses.replace(robot, damping=[0, 0], friction_speed=1e-3)
    np.testing.assert_allclose(rough.dissipation([1.0, 0]), [0.2, 0], rtol=1e-12)


@pytest.mark.parametrize(("name", "speed"), [("ur5", 0.005), ("z1", 0.005), ("go1", 30.1 / 640)])
def test_friction_is_as_wide_as_joints_are_fast(name, speed):
    assert rt.load(name).friction_speed == pytest.approx(speed)
    assert rt.load(name, limits={"velocity": 1.0}).friction_speed == pytest.approx(speed)


@pytest.mark.parametrize(("name", "speed"), [("talos", 5.4 / 64), ("go1", 30.1 / 64)])
def test_friction_of_a_free_root_is_wider(name, speed):
    assert rt.load(name, root="floating").friction_speed == pytest.approx(speed)


def test_friction_of_a_free_root_is_widest_where_a_joint_has_no_speed_limit(tmp_path):
    leg = """<mujoco><worldbody><body name="trunk"><freejoint/><geom size="0.1"/>
    <body name="leg" pos="0 0 -0.1"><joint name="hip" range="-60 60" frictionloss="0.3"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.02"/></body></body></worldbody></mujoco>"""
    (tmp_path / "leg.xml").write_text(leg)
    robot = rt.load(tmp_path / "leg.xml")
    assert np.isinf(robot.limits.largest("velocity")[-1])
    assert robot.friction_speed == 0.5


def test_damping_follows_locked_and_continuous_joints(tmp_path):
    robot = rt.load(write(tmp_path, "continuous"), locked={"shoulder": 0.1})
    np.testing.assert_array_equal(robot.damping, [0])
    robot = rt.load(write(tmp_path, "continuous"), locked={"elbow": 0.1})
    np.testing.assert_array_equal(robot.damping, [0.5])
    np.testing.assert_array_equal(robot.friction, [0.2])


@pytest.mark.parametrize(
    "value",
    [
        [0.5, 0.25],
        (0.5, 0.25),
        np.array([[0.5], [0.25]]),
        np.array([[0.5, 0.25]]),
        np.array([0.5, 0.25], np.float32),
        {"elbow": 0.25, "shoulder": 0.5},
    ],
    ids=str,
)
def test_configurations_are_coerced(arm, value):
    q = rt.load(arm).configuration(value)
    np.testing.assert_array_equal(q, [0.5, 0.25])
    assert q.dtype == np.float64


def test_a_number_is_for_all_joints_and_a_dict_leaves_the_rest_at_rest():
    robot = rt.load("panda")
    np.testing.assert_array_equal(robot.configuration(0.5), np.full(7, 0.5))
    q = robot.configuration({"panda_joint2": 0.1})
    assert q[1] == 0.1
    np.testing.assert_array_equal(np.delete(q, 1), np.delete(robot.neutral, 1))
    np.testing.assert_array_equal(robot.velocity({"panda_joint2": 0.1}), [0, 0.1, 0, 0, 0, 0, 0])


def test_a_configuration_is_a_copy(arm):
    given = np.array([0.1, 0.2])
    rt.load(arm).configuration(given)[0] = 9
    assert given[0] == 0.1


def test_a_robot_is_frozen(arm):
    robot = rt.load(arm)
    with pytest.raises(dataclasses.FrozenInstanceError):
        robot.name = "other"
    for values in (robot.damping, robot.friction, robot.neutral, robot.actuation, robot.limits.effort):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 1.0


def test_limits_are_overridden_when_loading(arm):
    changes = {"position": {"elbow": (-1, 1)}, "velocity": 3.0, "effort": {"shoulder": 7}, "acceleration": 20}
    limits = rt.load(arm, limits=changes).limits
    np.testing.assert_array_equal(limits.position_lower, [-1, -1])
    np.testing.assert_array_equal(limits.position_upper, [2, 1])
    np.testing.assert_array_equal(limits.velocity, [3, 3])
    np.testing.assert_array_equal(limits.effort, [7, 10])
    np.testing.assert_array_equal(limits.acceleration, [20, 20])
    assert rt.load(arm, limits=limits).limits is limits


def test_printing_shows_joints_units_limits_motors_damping_and_decisions(arm):
    robot = rt.load(arm, actuated=["shoulder"], limits={"velocity": {"elbow": np.inf}})
    title, _, head, shoulder, elbow, units, *notes = str(robot).splitlines()
    assert title.startswith("arm: 2 moving joints, 1 actuated, 2 kg")
    assert head.split()[:4] == ["joint", "unit", "position", "velocity"]
    assert shoulder.split() == ["shoulder", "rad", "[-1,", "2]", "3", "4", "yes", "0.5", "0.2", "0"]
    assert elbow.split() == ["elbow", "m", "[0,", "1]", "-", "10", "no", "0", "0", "0"]
    assert "N m (rad) or N (m)" in units
    assert any("<dynamics>" in note for note in notes)


def test_columns_alike_for_all_joints_of_a_wide_table_become_a_line_and_no_word_is_broken() -> None:
    robot = rt.load("panda", limits={"acceleration": {"panda_joint1": 5.0}})
    _, head, first, *_, last, common, units = str(robot).split("\nnote:")[0].splitlines()
    assert head.split() == ["joint", "position", "velocity", "acceleration", "effort", "neutral"]
    assert first.split() == ["panda_joint1", "[-2.897,", "2.897]", "2.175", "5", "87", "0"]
    assert last.split()[0] == "panda_joint7"
    assert common == "all joints: unit rad, motor yes, damping 0.003"
    assert units.startswith("velocity in unit/s")


@pytest.mark.parametrize("name", ["double_pendulum", "ur5", "talos", "solo12"])
@pytest.mark.parametrize("root", ["fixed", "floating"])
def test_printing_fits_a_terminal_and_a_notebook(name, root):
    robot = rt.load(name, root=root)
    assert repr(robot).startswith(f"<Robot {name!r}: {root} root")
    assert len(repr(robot)) <= 80 and "\n" not in repr(robot)
    assert max(map(len, str(robot).splitlines())) <= 80
    page = robot._repr_html_()
    assert page.count("<tr>") == 1 + robot.nv
    assert all(joint in page for joint in robot.velocity_names)


def test_names_are_escaped_in_a_notebook(arm):
    robot = dataclasses.replace(rt.load(arm), name="<script>")
    assert "<script>" not in robot._repr_html_()
    assert "&lt;script&gt;" in robot._repr_html_()


def test_acceleration_limits_have_a_column_where_there_are_any(arm):
    assert "acceleration" not in str(rt.load("ur5"))
    assert "acceleration" in str(rt.load("ur5", limits={"acceleration": 7.0}))


def test_printing_repeats_the_warnings():
    printed = " ".join(str(rt.load("double_pendulum")).split())
    assert "Joints 'joint1', 'joint2' cannot be planned with their limits" in printed


# -- bad inputs --------------------------------------------------------------------------------------------


def wide_model(joint):
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "hip")
    return model


BAD_LOADS = {
    "unknown robot": (lambda path: rt.load("ur55"), ["'ur55'", "'ur5'", "path of a URDF"]),
    "missing file": (lambda path: rt.load("nowhere/arm.urdf"), ["no URDF file", "nowhere/arm.urdf"]),
    "loaded robot": (lambda path: rt.load(rt.load("pendulum")), ["'pendulum', a robot that is loaded"]),
    "folder": (lambda path: rt.load(path), ["no URDF file"]),
    "number": (lambda path: rt.load(3), ["pin.Model", "got int"]),
    "none": (lambda path: rt.load(None), ["got NoneType"]),
    "unknown root": (lambda path: rt.load("ur5", root="glued"), ["'glued'", "fixed, floating, planar"]),
    "unknown actuated": (
        lambda path: rt.load("acrobot", actuated=["elbo"]),
        ["'elbo'", "'elbow'", "actuated="],
    ),
    "actuated as text": (
        lambda path: rt.load("acrobot", actuated="elbow"),
        ["list of joint names", "['elbow']"],
    ),
    "locked and actuated": (
        lambda path: rt.load("acrobot", actuated=["elbow"], locked={"elbow": 0}),
        ["moving joint named 'elbow'", "shoulder"],
    ),
    "unknown locked": (
        lambda path: rt.load("ur5", locked={"wrist": 0}),
        ["'wrist'", "wrist_1_joint", "locked="],
    ),
    "locked at NaN": (
        lambda path: rt.load("acrobot", locked={"elbow": np.nan}),
        ["'elbow'", "nan", "finite"],
    ),
    "locked at text": (lambda path: rt.load("acrobot", locked={"elbow": "0"}), ["'elbow'", "'0'"]),
    "locked as list": (lambda path: rt.load("acrobot", locked=["elbow"]), ["mapping", "['elbow']"]),
    "all locked": (lambda path: rt.load("pendulum", locked={"pivot": 0}), ["Every joint", "pivot"]),
    "unknown quantity": (lambda path: rt.load("ur5", limits={"speed": 1}), ["'speed'", "position, velocity"]),
    "limits as number": (lambda path: rt.load("ur5", limits=3), ["mapping", "got 3"]),
    "limits of another": (
        lambda path: rt.load("ur5", limits=rt.load("panda").limits),
        ["panda_joint1", "shoulder_pan_joint"],
    ),
    "limit of a stranger": (
        lambda path: rt.load("ur5", limits={"velocity": {"elbow": 1}}),
        ["'elbow'", "elbow_joint"],
    ),
    "free-flyer": (
        lambda path: rt.load(wide_model(pin.JointModelFreeFlyer()), root="fixed"),
        ["free joint 'hip'", "root='floating'"],
    ),
    "ellipsoid": (lambda path: rt.load(wide_model(pin.JointModelEllipsoid(0.1, 0.2, 0.3))), ["'hip'", "Ellipsoid"]),
    "planar joint": (lambda path: rt.load(write(path, "planar")), ["'elbow'", "planar", "0 0 1"]),
    "floating joint": (lambda path: rt.load(write(path, "floating", "")), ["'elbow'", "FreeFlyer"]),
    "empty model": (lambda path: rt.load(pin.Model()), ["no moving joint"]),
    "unknown joint type": (lambda path: rt.load(write(path, "hinge")), ["'elbow'", "'hinge'", "revolute"]),
    "no limit": (lambda path: rt.load(write(path, limit="")), ["'elbow'", "no <limit>"]),
    "limit NaN": (
        lambda path: rt.load(write(path, limit=LIMIT.replace('"2"', '"nan"'))),
        ["'elbow'", "velocity='nan'"],
    ),
    "negative damping": (
        lambda path: rt.load(write(path, limit=LIMIT + '<dynamics damping="-1"/>')),
        ["'elbow'", "damping -1"],
    ),
    "unknown link": (lambda path: rt.load(write(path, parent="uper")), ["'uper'", "'upper'", "'elbow'"]),
}


def test_a_saved_solution_is_no_urdf(tmp_path: Path) -> None:
    (tmp_path / "plan.npz").write_bytes(b"PK")
    with pytest.raises(rt.InputError, match=r"read by rt\.load_solution"):
        rt.load(tmp_path / "plan.npz")


FILES = {
    "no XML": ("<robot", "no well-formed XML"),
    "SDF": ("<sdf/>", "its root is <sdf>"),
    "MJCF": ("<mujoco/>", "its root is <mujoco>"),
    "xacro": (
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/></robot>',
        "or expand it with 'xacro robot.urdf",
    ),
    "no links": ('<robot name="r"></robot>', "no <link> stands below <robot>"),
    "two roots": (
        '<robot name="r"><link name="base"/><link name="a"/><link name="b"/><joint name="j" type="fixed">'
        '<parent link="base"/><child link="b"/></joint></robot>',
        "the links 'base', 'a' are no joint's child",
    ),
    "negative mass": (
        '<robot name="r"><link name="base"><inertial><mass value="-2"/></inertial></link></robot>',
        "link 'base' has the mass '-2'",
    ),
    "no axis": (
        '<robot name="r"><link name="base"/><link name="a"/><joint name="slide" type="prismatic"><axis xyz="0 0 0"/>'
        '<parent link="base"/><child link="a"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint></robot>',
        "'slide' has the axis '0 0 0'",
    ),
}


@pytest.mark.parametrize("case", BAD_LOADS)
def test_bad_loads_are_refused_by_name(case, tmp_path):
    load, parts = BAD_LOADS[case]
    with pytest.raises(rt.InputError) as caught:
        load(tmp_path)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize("case", FILES)
def test_errors_distinguish_files_that_are_not_urdfs(case, tmp_path):
    text, part = FILES[case]
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(rt.InputError, match=part):
        rt.load(path)


BAD_QUESTIONS = {
    "frame typo": (lambda robot: robot.frame("tol0"), ["frame named 'tol0'", "'tool0'"]),
    "frame by number": (lambda robot: robot.frame(3), ["frame named 3"]),
    "joint typo": (lambda robot: robot.joint("elbow"), ["'elbow'", "elbow_joint"]),
    "universe": (lambda robot: robot.joint("universe"), ["'universe'"]),
    "too short": (lambda robot: robot.configuration([0, 0]), ["q has shape (2,)", "6 values", "elbow_joint"]),
    "too long": (lambda robot: robot.configuration(np.zeros(7), "start"), ["start has shape (7,)"]),
    "square": (lambda robot: robot.configuration(np.zeros((2, 3))), ["shape (2, 3)"]),
    "NaN": (lambda robot: robot.configuration([0, 0, np.nan, 0, 0, 0]), ["'elbow_joint'", "nan"]),
    "infinity": (
        lambda robot: robot.velocity({"elbow_joint": np.inf}),
        ["v of", "'elbow_joint'", "inf"],
    ),
    "unknown joint": (lambda robot: robot.configuration({"elbow": 1}), ["'elbow'", "elbow_joint"]),
    "text": (lambda robot: robot.configuration("home"), ["'home'", "6 numbers"]),
    "None": (lambda robot: robot.configuration([None] * 6), ["nan", "'shoulder_pan_joint'"]),
    "ragged": (lambda robot: robot.configuration([[1, 2], [3]]), ["no vector of 6 numbers"]),
    "friction speed": (lambda robot: dataclasses.replace(robot, friction_speed=0), ["friction_speed is 0"]),
}


@pytest.mark.parametrize("case", BAD_QUESTIONS)
def test_bad_questions_are_answered_by_name(case):
    ask, parts = BAD_QUESTIONS[case]
    with pytest.raises(rt.InputError) as caught:
        ask(rt.load("ur5"))
    for part in parts:
        assert part in str(caught.value)


def test_the_cosine_and_sine_of_a_continuous_joint_are_refused_with_a_hint():
    with pytest.raises(rt.InputError, match="takes one angle"):
        rt.load("double_pendulum_continuous").configuration([1, 0, 1, 0])


def test_rooms_below_the_robot_are_found_in_a_fresh_process() -> None:
    program = "import robotraj as rt; print(rt.robot.collision.robot_spheres.__name__, 'collision' in dir(rt.robot))"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["robot_spheres", "True"]


def test_meshes_and_folders_are_named_as_what_they_are(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.stl").write_text("solid arm\nendsolid")
    with pytest.raises(rt.InputError, match="'arm.stl' is a mesh, one shape; give the URDF"):
        rt.load("arm.stl")
    with pytest.raises(rt.InputError, match="no URDF file '.'. It is a folder."):
        rt.load(".")
