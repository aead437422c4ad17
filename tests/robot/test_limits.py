"""Limits are copied, infinite above 1e20, overridden by name, and checked joint by joint."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.known_robots.catalogue import find


@pytest.fixture
def limits():
    positions = {"hip": (-1, 1), "knee": (-2, 2)}
    return rt.robot.Limits.none(["hip", "knee"]).with_(position=positions, velocity=3, effort=[10, 20])


def test_values_above_1e20_are_no_limits():
    limits = rt.robot.Limits.none(["a", "b"]).with_(
        position={"a": (-1.8e308, 1.8e308), "b": (-1, 1e19)},
        velocity=[1e30, 1],
        acceleration=[2e20, 1],
        effort=[np.inf, 1e20],
    )
    np.testing.assert_array_equal(limits.position_lower, [-np.inf, -1])
    np.testing.assert_array_equal(limits.position_upper, [np.inf, 1e19])
    np.testing.assert_array_equal(limits.velocity, [np.inf, 1])
    np.testing.assert_array_equal(limits.acceleration, [np.inf, 1])
    np.testing.assert_array_equal(limits.effort, [np.inf, 1e20])


def test_pinocchios_unbounded_joints_are_infinite():
    model = pin.Model()
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "free")
    assert model.upperPositionLimit[0] > 1e300
    limits = rt.robot.Limits.of(model)
    for values in (limits.position_upper, -limits.position_lower, limits.velocity, limits.effort, limits.jerk):
        assert np.isposinf(values[0])


def test_the_lower_velocity_limit_of_pinocchio_41_is_not_believed():
    model = pin.buildSampleModelManipulator()
    model.upperVelocityLimit[:] = 2.0
    model.lowerVelocityLimit[:] = 2.0  # the sign that Pinocchio 4.1 writes
    np.testing.assert_array_equal(rt.robot.Limits.of(model).velocity, np.full(model.nv, 2.0))


@pytest.mark.parametrize("lower", [-2.0, 0.0, 1.0])
def test_lower_limits_of_speed_and_effort_are_read_beside_the_upper_ones(lower):
    model = pin.buildSampleModelManipulator()
    model.upperVelocityLimit[:] = model.upperEffortLimit[:] = 5.0
    model.lowerVelocityLimit[:] = model.lowerEffortLimit[:] = -5.0
    model.lowerVelocityLimit[1] = model.lowerEffortLimit[1] = lower
    limits = rt.robot.Limits.of(model)
    for quantity in ("velocity", "effort"):
        low, high = limits.sides(quantity)
        np.testing.assert_array_equal(low, [-5, lower, -5, -5, -5, -5])
        np.testing.assert_array_equal(high, np.full(6, 5.0))
        np.testing.assert_array_equal(limits.largest(quantity), np.full(6, 5.0))
    with pytest.raises(rt.InputError, match=r"effort limits of 'shoulder2_joint' are \[.*, 5\].*limits.effort_lower"):
        _ = limits.effort


@pytest.mark.parametrize("quantity", ["velocity", "acceleration", "jerk", "effort"])
@pytest.mark.parametrize("ends", [(-5, 30), (None, 30), rt.between(0, 30), (2, 30)])
def test_rates_and_efforts_have_two_sides_by_name(limits, quantity, ends):
    low, high = limits.with_(**{quantity: {"knee": ends}}).sides(quantity)
    first = ends.lower if isinstance(ends, rt.constraints.Between) else ends[0]
    assert (low[1], high[1]) == (-np.inf if first is None else first, 30)
    assert low[0] == -high[0]


def test_one_interval_holds_for_all_joints(limits):
    new = limits.with_(effort=rt.between(0, 30))
    np.testing.assert_array_equal(new.sides("effort"), [[0, 0], [30, 30]])
    np.testing.assert_array_equal(new.scaled(effort=0.5, velocity=2.0).sides("effort"), [[0, 0], [15, 15]])
    np.testing.assert_array_equal(new.scaled(effort=0.5, velocity=2.0).velocity, [6, 6])
    half = new.scaled(0.5, velocity=2.0)
    np.testing.assert_array_equal(half.sides("effort"), [[0, 0], [15, 15]])
    np.testing.assert_array_equal(half.velocity, [6, 6])
    np.testing.assert_array_equal(half.sides("position"), new.sides("position"))


@pytest.mark.parametrize(
    ("factors", "part"), [({"torque": 2}, "torque"), ({"effort": 0}, "above 0"), ({"effort": "a"}, "'a'")]
)
def test_impossible_factors_are_refused(limits, factors, part):
    with pytest.raises(rt.InputError, match=part):
        limits.scaled(**factors)


def test_limits_are_copies_that_cannot_be_written():
    model = pin.buildSampleModelManipulator()
    model.upperVelocityLimit[:] = 2.0
    limits = rt.robot.Limits.of(model)
    model.upperVelocityLimit[:] = 9.0
    assert limits.velocity[0] == 2.0
    with pytest.raises(ValueError, match="read-only"):
        limits.velocity[0] = 1.0
    with pytest.raises(AttributeError):
        limits.velocity = 1.0


@pytest.mark.parametrize(
    ("value", "lower", "upper"),
    [
        (0.5, [-0.5, -0.5], [0.5, 0.5]),
        ((-3, 4), [-3, -3], [4, 4]),
        ({"knee": (-0.1, 0.2)}, [-1, -0.1], [1, 0.2]),
        ({"knee": 0.3}, [-1, -0.3], [1, 0.3]),
        ({"knee": (None, 0.2)}, [-1, -np.inf], [1, 0.2]),
        ({"hip": rt.between(-5, np.inf)}, [-5, -2], [np.inf, 2]),
    ],
)
def test_positions_are_overridden(limits, value, lower, upper):
    new = limits.with_(position=value)
    np.testing.assert_array_equal(new.position_lower, lower)
    np.testing.assert_array_equal(new.position_upper, upper)
    np.testing.assert_array_equal(limits.position_lower, [-1, -2])
    np.testing.assert_array_equal(new.effort, limits.effort)


@pytest.mark.parametrize("name", ["velocity", "acceleration", "effort"])
@pytest.mark.parametrize(
    ("value", "expected"),
    [(7, [7, 7]), ([1, 2], [1, 2]), (np.array([[1], [2]], np.float32), [1, 2]), (np.inf, [np.inf, np.inf])],
)
def test_magnitudes_are_overridden(limits, name, value, expected):
    np.testing.assert_array_equal(getattr(limits.with_(**{name: value}), name), expected)


def test_a_mapping_leaves_the_other_joints(limits):
    np.testing.assert_array_equal(limits.with_(effort={"knee": 5}).effort, [10, 5])


@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ({"velocity": {"kneee": 1}}, ["kneee", "'knee'"]),
        ({"position": {"ankle": (0, 1)}}, ["ankle", "hip, knee"]),
        ({"velocity": float("nan")}, ["velocity limit of 'hip'", "nan"]),
        ({"effort": {"knee": -1}}, ["effort limit of 'knee'", "-1"]),
        ({"effort": [1, 2, 3]}, ["3 values", "hip, knee"]),
        ({"effort": "strong"}, ["effort", "'strong'"]),
        ({"effort": {"hip": "strong"}}, ["effort limit of 'hip'", "'strong'"]),
        ({"position": {"hip": (1, -1)}}, ["'hip'", "[1, -1]"]),
        ({"position": {"hip": (0, float("nan"))}}, ["'hip'", "nan"]),
        ({"position": {"hip": (0, 1, 2)}}, ["'hip'", "pair"]),
        ({"position": {"hip": "wide"}}, ["'hip'", "'wide'"]),
    ],
)
def test_bad_overrides_are_named(limits, changes, parts):
    with pytest.raises(rt.InputError) as caught:
        limits.with_(**changes)
    for part in parts:
        assert part in str(caught.value)


def test_a_limit_per_joint_is_needed():
    with pytest.raises(rt.InputError, match=r"Limits.velocity_upper has 1 values; give one per joint, 2"):
        replace(rt.robot.Limits.none(["a", "b"]), velocity_upper=[1])


def test_sound_limits_give_no_warning(limits):
    assert limits.warnings() == ()


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"velocity_lower": [0, -3], "velocity_upper": [0, 3]}, "velocity limit 0 locks it"),
        ({"effort_lower": [0, -3], "effort_upper": [0, 3]}, "effort limit 0 locks it"),
        ({"jerk_lower": [0, -3], "jerk_upper": [0, 3]}, "jerk limit 0 locks it"),
        ({"position_lower": [0, -2], "position_upper": [0, 2], "missing": ("hip",)}, "position limits are missing"),
        ({"position_lower": [0, -2], "position_upper": [0, 2]}, "position limits [0, 0] lock it"),
        ({"position_lower": [2, -2]}, "position limits [2, 1] are inverted"),
        ({"position_lower": [np.nan, -2]}, "are not numbers"),
        ({"velocity_upper": [-4, 3]}, "velocity limits [-3, -4] are inverted"),
        ({"effort_lower": [np.nan, 3]}, "effort limits [nan, 10] are not numbers"),
    ],
)
def test_each_fault_is_one_sentence_of_its_joint_with_the_cure(limits, changes, part):
    warnings = replace(limits, **changes).warnings()
    assert len(warnings) == 1
    assert "'hip'" in warnings[0]
    assert part in warnings[0]
    assert "rt.load(..., limits={" in warnings[0]
    assert "rt.load(..., locked={'hip': " in warnings[0]
    assert "Phase(limits=None)" in warnings[0]


def test_what_holds_for_several_joints_is_one_sentence(limits):
    (warning,) = limits.with_(effort=0).warnings()
    assert warning.startswith("Joints 'hip', 'knee' cannot be planned with their limits: effort limit 0 locks it.")
    assert "{'effort': {'hip': largest, ...}}" in warning


def test_a_joint_without_motor_may_have_no_effort(limits):
    passive = limits.with_(effort={"hip": 0})
    assert passive.warnings(["knee"]) == ()
    (warning,) = passive.warnings(["hip", "knee"])
    assert "leave it out of actuated=[...] if no motor drives it" in warning
    assert len(passive.warnings()) == 1


def test_the_cure_that_is_named_cures():
    robot = rt.load("double_pendulum")
    assert len(robot.limits.warnings()) == 1
    cured = rt.load(
        "double_pendulum",
        limits={"position": (-np.pi, np.pi), "velocity": 10, "effort": {"joint1": 5, "joint2": 5}},
    )
    assert cured.limits.warnings() == ()
    assert cured.limits.effort[1] == 5


def test_zero_limits_of_a_real_robot_are_counted():
    model = pin.buildModelFromUrdf(str(find("romeo").urdf))
    robot = rt.load(model)
    zero = np.flatnonzero(np.array(model.upperVelocityLimit) == 0)
    assert len(zero) == 24
    faults = robot.limits.faults()
    assert {robot.joint_names[i] for i in zero} == {joint for joint in faults if "velocity" in faults[joint]}
    assert len(robot.limits.warnings()) < 5


def test_a_joint_whose_friction_takes_all_of_its_effort_is_noted(urdf):
    rough = '<limit lower="-1" upper="2" velocity="3" effort="4"/><dynamics friction="4"/>'
    path = urdf.chain(("turn", "revolute", "0 1 0", rough), ("slide", "prismatic", "0 0 1", rough))

    def noted(**options):
        return [note for note in rt.load(path, **options).notes if "Friction is at least as large" in note]

    (note,) = noted()
    assert "turn (4 of 4 N m), slide (4 of 4 N)" in note
    assert "slide" not in noted(actuated=["turn"])[0]
    assert "turn" not in noted(limits={"effort": {"turn": 5.0}})[0]
    assert not noted(limits={"effort": 5.0})
