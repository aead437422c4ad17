"""A force of the world enters plan and simulation alike, and is what it stands for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt


def mass_on_a_rail():
    """Return 2 kg on a level rail with the frame ``mass``."""
    model = pin.Model()
    model.name = "rail"
    free = (np.full(1, x) for x in (50.0, 10.0, -5.0, 5.0))
    joint = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "x", *free)
    model.appendBodyToJoint(joint, pin.Inertia(2.0, np.zeros(3), 0.1 * np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("mass", joint, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    return model


START, END = rt.State(q=1.5, v=0), rt.State(q=-0.5, v=0)


def spring_to_the_wall(place):
    return [-8.0 * (place.position[0] - 0.5), 0.0, 0.0]


def test_a_spring_to_the_wall_is_a_spring_at_the_joint():
    pulled = rt.Phase(
        rt.load(mass_on_a_rail()), 1.0, START, END, rt.Effort(), contacts=[rt.ExternalForce("mass", spring_to_the_wall)]
    )
    sprung = rt.Phase(rt.load(mass_on_a_rail(), springs={"x": (8.0, 0.5)}), 1.0, START, END, rt.Effort())
    one, other = rt.plan(pulled), rt.plan(sprung)
    assert one.proof.holds and one.objective == pytest.approx(other.objective, rel=1e-5)
    assert rt.validate(one).passed


def test_a_force_along_the_motion_changes_the_least_time_as_it_changes_the_motor():
    """50 N either way and 10 N of wind: accelerations (50 + 10) / m and (50 - 10) / m, T = sqrt(2 L (1/a + 1/b))."""
    wind = rt.ExternalForce("mass", lambda place: [-10.0, 0.0, 0.0])
    plan = rt.plan(rt.Phase(rt.load(mass_on_a_rail()), (0.05, 5.0), START, END, rt.Duration(), contacts=[wind]))
    assert plan.duration == pytest.approx(np.sqrt(2.0 * 2.0 * (2.0 / 60.0 + 2.0 / 40.0)), rel=2e-4)


def test_a_force_of_another_size_is_noticed_by_the_simulation():
    robot = rt.load(mass_on_a_rail())
    light, heavy = (rt.ExternalForce("mass", lambda place, f=f: [f, 0.0, 0.0]) for f in (-10.0, -11.0))
    phase = rt.Phase(robot, 1.0, START, END, rt.Effort(), contacts=[light])
    solution, lie = rt.plan(phase), phase.with_(contacts=[heavy])
    told = replace(solution, phases=(replace(solution.phases[0], phase=lie),), problem=rt.Problem([lie]))
    assert rt.validate(solution).passed and not rt.validate(told).passed


def test_mujocos_opinion_is_refused_since_it_would_lack_the_force():
    pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")
    wind = rt.ExternalForce("mass", lambda place: [-10.0, 0.0, 0.0])
    solution = rt.plan(rt.Phase(rt.load(mass_on_a_rail()), 1.0, START, END, rt.Effort(), contacts=[wind]))
    with pytest.raises(rt.InputError, match="no forces such as 'mass'.*use rt.validate"):
        rt.witness.second_opinion(solution)


@pytest.mark.parametrize(
    ("frame", "force", "part"),
    [
        ("mess", lambda place: [0, 0, 0], "no frame named 'mess'"),
        ("mass", lambda place: [0, 0], "return 3 numbers"),
        ("mass", lambda place: [np.nan, 0, 0], "return 3 numbers"),
    ],
)
def test_forces_that_cannot_be(frame, force, part):
    with pytest.raises(rt.InputError, match=part):
        rt.Phase(rt.load(mass_on_a_rail()), 1.0, START, END, rt.Effort(), contacts=[rt.ExternalForce(frame, force)])


def test_a_number_is_no_force():
    with pytest.raises(rt.InputError, match="give a function of the frame's place"):
        rt.ExternalForce("mass", 3.0)
