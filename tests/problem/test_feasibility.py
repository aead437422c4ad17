"""Contradictory conditions at an end are refused before solving, and named."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.dynamics.kinematics import Kinematics


@pytest.mark.parametrize(("where", "which"), [(rt.AtStart, "start"), (rt.AtEnd, "end")])
def test_a_joint_held_elsewhere_at_an_end_contradicts_that_end(where: type, which: str) -> None:
    arm = rt.load("two_link_arm")
    ends = {"start": rt.State(q=0, v=0), "end": rt.State(q=[0.5, 0.5], v=0)}
    held = where(rt.constraints.JointPosition({"shoulder": rt.between(0.1, 0.1)}))
    with pytest.raises(InputError, match=f"the {which} position of 'shoulder' is .* outside"):
        rt.Phase(arm, duration=5.0, constraints=[held], **ends)
    other = where(rt.constraints.JointPosition({"shoulder": rt.between(0.2, 0.2)}))
    with pytest.raises(InputError, match="contradict each other"):
        rt.Phase(arm, duration=5.0, constraints=[held, other])


def test_ends_held_at_different_values_do_not_contradict() -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(
        arm,
        duration=5.0,
        constraints=[
            rt.AtStart(rt.constraints.JointPosition({"elbow": rt.between(0.1, 0.1)})),
            rt.AtEnd(rt.constraints.JointPosition({"elbow": rt.between(0.2, 0.2)})),
        ],
    )
    solution = rt.plan(phase, rt.Mesh(5))
    assert [solution.at(t).q[1] for t in (0.0, 5.0)] == pytest.approx([0.1, 0.2], abs=1e-8)


def test_a_joint_that_moves_no_mass_is_refused_by_name() -> None:
    model = pin.buildSampleModelManipulator()
    last = model.njoints - 1
    model.inertias[last] = pin.Inertia.Zero()
    with pytest.warns(UserWarning, match="No mass moves"):
        robot = rt.load(model)
    with pytest.raises(InputError, match=f"no mass moves with '{model.names[last]}'"):
        rt.Phase(robot, 1.0, limits=None)
    assert rt.Phase(robot, 1.0, limits=None, dynamics=Kinematics())


def test_joints_that_move_no_mass_together_are_refused_by_name() -> None:
    # A head without inertia about its centre of mass turns freely about the line from there to the crossing axes.
    model = pin.Model()
    parent = 0
    for name, joint in (("pitch", pin.JointModelRY()), ("roll", pin.JointModelRX()), ("yaw", pin.JointModelRZ())):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), name)
        model.addJointFrame(parent)
    model.appendBodyToJoint(parent, pin.Inertia(1.0, np.array([0.1, 0.0, 0.2]), np.zeros((3, 3))), pin.SE3.Identity())
    robot = rt.load(model)
    with pytest.raises(InputError, match="'roll' and 'yaw' can turn without moving any mass .*{'yaw': 0.0}"):
        rt.Phase(robot, 1.0, limits=None)
    assert rt.Phase(robot, 1.0, limits=None, dynamics=Kinematics())
    assert rt.Phase(rt.load(model, locked={"yaw": 0.0}), 1.0, limits=None)


@pytest.mark.parametrize("off", [0.0, 1e-3])
def test_a_joint_through_a_centre_of_mass_without_inertia_is_refused_by_name(off: float) -> None:
    model = pin.Model()
    arm = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "arm")
    drill = model.addJoint(arm, pin.JointModelRZ(), pin.SE3.Identity(), "drill")
    for joint in (arm, drill):
        model.addJointFrame(joint)
    model.appendBodyToJoint(drill, pin.Inertia(1.0, np.array([off, 0.0, 0.2]), np.zeros((3, 3))), pin.SE3.Identity())
    robot = rt.load(model)
    if off:  # a millimetre is enough
        assert rt.Phase(robot, 1.0, limits=None)
    else:
        with pytest.raises(InputError, match="'drill' can turn without moving any mass .*{'drill': 0.0}"):
            rt.Phase(robot, 1.0, limits=None)


def test_a_root_without_mass_may_be_held_by_contacts() -> None:
    cart = rt.load("cartpole", root="floating")  # its rail has no mass
    assert rt.Phase(cart, 1.0, limits=None)


@pytest.mark.parametrize(
    ("name", "end", "hint"),
    [
        ("ur5", rt.State(q=[90, 0, 0, 0, 0, 0], v=0), "The unit is rad: 90 degrees are 1.5708 rad."),
        ("ur5", rt.State(q=0, v=[90, 0, 0, 0, 0, 0]), "The unit is rad/s: 90 degrees/s are 1.5708 rad/s."),
        ("cartpole", rt.State(q=[1000, 0], v=0), "The unit is m: 1000 mm are 1 m."),
    ],
)
def test_a_value_in_degrees_or_millimetres_is_refused_with_its_unit(name: str, end: rt.State, hint: str) -> None:
    with pytest.raises(rt.InputError, match=re.escape(hint)):
        rt.Phase(rt.load(name), 2.0, end, rt.State(q=0, v=0))


def test_a_value_that_is_outside_in_any_unit_has_no_hint() -> None:
    with pytest.raises(rt.InputError, match="outside its position limit") as error:
        rt.Phase(rt.load("ur5"), 2.0, rt.State(q=0, v=0), rt.State(q=[1e4, 0, 0, 0, 0, 0], v=0))
    assert "degrees" not in str(error.value)


@pytest.mark.parametrize(
    ("bounds", "hint"),
    [
        (rt.constraints.JointPosition({"elbow_joint": rt.between(-90, 3.1)}), "-90 degrees are -1.5708 rad"),
        (rt.constraints.JointPosition({"elbow_joint": rt.between(-3.1, 120)}), "120 degrees are 2.0944 rad"),
        (rt.constraints.JointVelocity({"elbow_joint": rt.between(-1, 60)}), "60 degrees/s are 1.0472 rad/s"),
    ],
)
def test_a_bound_that_has_an_effect_in_degrees_only_is_warned_of(bounds: object, hint: str) -> None:
    with pytest.warns(UserWarning, match=f"elbow_joint .*has no effect beside .*{hint}") as caught:
        rt.Phase(rt.load("ur5"), 2.0, rt.State(q=0, v=0), rt.State(q=0.1, v=0), constraints=[bounds])
    assert len(caught) == 1


@pytest.mark.parametrize("upper", [0.5, 4.0, 1e4, np.inf])
def test_a_bound_that_is_plausible_as_it_is_or_in_no_unit_is_not_warned_of(upper: float) -> None:
    bounds = rt.constraints.JointPosition({"elbow_joint": rt.between(-upper, upper)})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.Phase(rt.load("ur5"), 2.0, rt.State(q=0, v=0), rt.State(q=0.1, v=0), constraints=[bounds])


@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_a_root_whose_quaternion_has_w_first_is_warned_of(yaw: float) -> None:
    robot = rt.load("solo12", root="floating")
    upright, swapped = np.array(robot.neutral), np.array(robot.neutral)
    upright[3:7] = 0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)
    swapped[3:7] = np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
    with pytest.warns(UserWarning, match="at the start, the root .* is upside down.*w last"):
        rt.Phase(robot, 1.0, rt.State(q=swapped, v=0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.Phase(robot, 1.0, rt.State(q=upright, v=0))


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1.0, 1e6])
@pytest.mark.parametrize(("end", "is_right"), [(1.0 + 1e-7, True), (1.5, False)])
def test_an_end_outside_its_limits_is_refused_in_every_unit(unit: float, end: float, is_right: bool) -> None:
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    limits = {"x": rt.between(-unit, unit)}
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2)

    def posed() -> rt.Phase:
        return rt.Phase(system, 1.0, rt.State([0.0]), rt.State([end * unit]), cost, states=limits)

    if is_right:
        rt.Problem([posed()])
    else:
        with pytest.raises(InputError, match="outside"):
            rt.Problem([posed()])


def test_two_places_of_one_frame_at_one_end_contradict_each_other() -> None:
    def reach(*constraints: rt.constraints.Constraint) -> rt.Phase:
        return rt.Phase(rt.load("ur5"), 1.0, rt.State(v=0), None, rt.Effort(), constraints)

    def at(height: float) -> rt.FramePosition:
        return rt.FramePosition("tool0", (0.4, 0.2, height))

    with pytest.raises(rt.InputError, match=r"position z, tool0 \[0.5, 0.5\] m and .*\[0.3, 0.3\] m contradict"):
        reach(rt.AtEnd(at(0.3)), rt.AtEnd(at(0.5)))
    assert reach(rt.AtStart(at(0.3)), rt.AtEnd(at(0.5)))
    # Expressions of one name may differ.
    assert reach(
        rt.PathConstraint(lambda point: point.q[0], upper=-1.0, name="own"),
        rt.PathConstraint(lambda point: point.q[1], lower=1.0, name="own"),
    )
