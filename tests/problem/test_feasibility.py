"""What contradicts itself at an end is refused before solving, by name."""

from __future__ import annotations

import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.dynamics.kinematics import Kinematics


@pytest.mark.parametrize(("where", "which"), [(rt.AtStart, "start"), (rt.AtEnd, "end")])
def test_a_joint_held_elsewhere_at_an_end_contradicts_that_end(where: type, which: str) -> None:
    arm = rt.load("two_link_arm")
    ends = {"start": rt.State(q=0, v=0), "end": rt.State(q=[0.5, 0.5], v=0)}
    held = where(rt.constraints.JointPosition({"shoulder": 0.1}))
    with pytest.raises(InputError, match=f"the {which} position of 'shoulder' is .* outside"):
        rt.Phase(arm, duration=5.0, constraints=[held], **ends)
    with pytest.raises(InputError, match="contradict each other"):
        rt.Phase(arm, duration=5.0, constraints=[held, where(rt.constraints.JointPosition({"shoulder": 0.2}))])


def test_ends_held_at_different_values_do_not_contradict() -> None:
    arm = rt.load("two_link_arm")
    phase = rt.Phase(
        arm,
        duration=5.0,
        constraints=[
            rt.AtStart(rt.constraints.JointPosition({"elbow": 0.1})),
            rt.AtEnd(rt.constraints.JointPosition({"elbow": 0.2})),
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
