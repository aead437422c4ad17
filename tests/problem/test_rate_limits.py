"""Hard limits of jerks and of rates of torques: closed forms, limits at every time, what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt

Q0 = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
Q1 = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


def _reach(*constraints, duration=(0.1, 10.0), **changes):
    robot = rt.load("ur5")
    return rt.Phase(
        robot, duration, rt.State(q=Q0, v=0), rt.State(q=Q1, v=0), rt.Duration(), constraints=constraints, **changes
    )


def test_a_block_with_a_limit_of_jerk_takes_the_time_of_its_closed_form():
    """From rest to rest with |jerk| <= j alone: T = (32 L / j)^(1/3), and accelerations that start and end at 0."""
    robot = rt.load("block", limits={"effort": 1e3, "velocity": 1e3})
    phase = rt.Phase(
        robot,
        (0.1, 10.0),
        rt.State(q=0, v=0),
        rt.State(q=1, v=0),
        rt.Duration(),
        constraints=[rt.constraints.JointJerk(rt.between(-4, 4))],
    )
    solution = rt.plan(phase, rt.Mesh(40))
    assert solution.duration == pytest.approx((32 * 1.0 / 4.0) ** (1 / 3), rel=1e-4)


@pytest.mark.parametrize("duration", [(0.1, 10.0), 1.0])
def test_jerks_stay_within_their_limit_at_every_time(duration):
    solution = rt.plan(_reach(rt.constraints.JointJerk(rt.between(-200, 200)), duration=duration))
    t = np.linspace(0.0, solution.duration, 4001)
    jerk = np.diff(solution.at(t).a, axis=0) / np.diff(t)[:, None]
    assert np.abs(jerk).max() < 200 * (1 + 1e-6)
    assert rt.validate(solution).passed
    unbounded = rt.plan(_reach(duration=duration))
    t = np.linspace(0.0, unbounded.duration, 4001)
    free = unbounded.at(t)
    assert np.abs(np.diff(free.a, axis=0) / np.diff(t)[:, None]).max() > 400


def test_rates_of_torques_stay_within_their_limit_between_the_points(tmp_path):
    limit = rt.constraints.JointTorqueRate({"elbow_joint": rt.between(-800, 800)})
    solution = rt.plan(_reach(limit))
    t = np.linspace(0.0, solution.duration, 4001)
    rate = np.diff(solution.at(t).tau, axis=0) / np.diff(t)[:, None]
    assert np.abs(rate[:, 2]).max() < 800 * (1 + 2e-3) < np.abs(rate[:, 1]).max()
    assert rt.validate(solution).passed
    solution.save(tmp_path / "motion.npz")
    again = rt.load_solution(tmp_path / "motion.npz")
    assert isinstance(again.problem.phases[0].constraints[0], rt.constraints.JointTorqueRate)
    assert rt.validate(again).passed


def _turning_back(**changes):
    """A pendulum with dry friction that swings out and back to its start."""
    robot = replace(rt.load("pendulum"), friction=np.array([0.5]))
    ends = {"start": rt.State(q=0, v=0.5), "end": rt.State(q=0, v=-0.5)}
    return rt.Phase(robot, 1.0, **ends, objective=rt.Effort(), **changes)


def test_the_dry_friction_of_a_reversal_is_no_part_of_the_bounded_rate():
    """Plan and witness measure tau - F tanh(v / v_s); the torque itself jumps by 2 F."""
    solution = rt.plan(_turning_back(constraints=[rt.constraints.JointTorqueRate(rt.between(-8, 8))]))
    robot = solution.problem.phases[0].robot
    t = np.linspace(0.0, solution.duration, 4001)
    sample = solution.at(t)
    smooth = sample.tau - robot.friction * np.tanh(sample.v / robot.friction_speed)
    bounded, whole = (np.abs(np.diff(each, axis=0)).max() / t[1] for each in (smooth, sample.tau))
    assert bounded < 8 * (1 + 2e-3) < whole
    assert rt.validate(solution).passed


def test_rates_of_torques_that_are_states_stay_within_their_limit_too():
    """``TorqueRate`` makes torques states; without the limit the rate without dry friction is 8.4."""
    limit = rt.constraints.JointTorqueRate(rt.between(-5, 5))
    solution = rt.plan(_turning_back(constraints=[limit]).with_(objective=rt.objectives.TorqueRate()))
    robot = solution.problem.phases[0].robot
    t = np.linspace(0.0, solution.duration, 4001)
    sample = solution.at(t)
    smooth = sample.tau - robot.friction * np.tanh(sample.v / robot.friction_speed)
    assert 4.9 < np.abs(np.diff(smooth, axis=0)).max() / t[1] < 5 * (1 + 2e-3)
    # Limits that are lowered between the points cost 0.31 percent, of which a second solve may gain 0.3.
    assert rt.validate(solution, optimum=None).passed


def test_the_witness_measures_rates_itself():
    solution = rt.plan(_reach(), rt.Mesh(20))
    bounded = solution.problem.phases[0].with_(constraints=[rt.constraints.JointJerk(rt.between(-200, 200))])
    import dataclasses

    part = dataclasses.replace(solution.phases[0], phase=bounded)
    claimed = dataclasses.replace(solution, problem=rt.Problem([bounded]), phases=(part,))
    assert any(v.name == "jerk limit" for v in rt.validate(claimed).violations)


@pytest.mark.parametrize(
    ("changes", "mesh", "words"),
    [
        ({"dynamics": rt.dynamics.ForwardDynamics()}, None, "InverseDynamics"),
        ({}, rt.Mesh(10, rt.schemes.RadauIIA(3)), "continuous at fixed knots"),
        ({}, rt.schemes.MovingMesh(10), "continuous at fixed knots"),
    ],
)
def test_dynamics_and_meshes_on_which_rates_have_no_bound_are_refused(changes, mesh, words):
    with pytest.raises(rt.InputError, match=words):
        rt.plan(_reach(rt.constraints.JointJerk(rt.between(-200, 200)), **changes), mesh)


def test_an_unknown_joint_is_named():
    with pytest.raises(rt.UnknownName, match="elbow_joint"):
        _ = _reach(rt.constraints.JointJerk({"elbow": 1.0})).rows


@pytest.mark.parametrize("kind", ["JointVelocity", "JointAcceleration", "JointEffort", "JointJerk", "JointTorqueRate"])
def test_a_number_is_a_limit_of_both_signs_as_in_limits(kind):
    make = getattr(rt.constraints, kind)
    joints = rt.load("ur5").actuated
    for given in (8.0, dict.fromkeys(joints, 8), [8] * 6, np.full(6, 8.0)):
        rows = make(given).bind(_reach().body).rows
        assert [(row.lower, row.upper) for row in rows] == [(-8.0, 8.0)] * 6
    (row,) = make({"elbow_joint": 8}).bind(_reach().body).rows
    assert (row.joint, row.lower, row.upper) == ("elbow_joint", -8.0, 8.0)
    with pytest.raises(rt.InputError, match=r"-8 is no magnitude: a number x stands for \[-x, x\]"):
        _ = _reach(make({"elbow_joint": -8})).rows
    limited = rt.load("ur5").limits.with_(jerk=8.0, velocity={"elbow_joint": 8})
    assert limited.jerk_lower[0] == limited.velocity_lower[2] == -8.0


@pytest.mark.parametrize("where", [rt.AtStart, rt.AtEnd])
def test_a_number_that_could_be_a_value_or_a_limit_is_refused(where):
    speed, place = rt.constraints.JointVelocity(2.0), rt.constraints.JointPosition({"elbow_joint": 0.2})
    for given, value in ((where(speed), 2), (where(place), 0.2), (place, 0.2)):
        with pytest.raises(
            rt.InputError, match=rf"rt.between\({value}, {value}\) for the value, or rt.between\(-{value}"
        ):
            _ = _reach().with_(start=None, end=None, constraints=[given]).rows
    _ = _reach().with_(start=None, constraints=[where(rt.constraints.JointVelocity(0.0))]).rows


def test_a_failure_with_limits_of_rates_is_explained():
    """The search for undefined expressions once took rates for expressions."""
    with pytest.raises(rt.NoSolutionFound):
        rt.plan(_reach(rt.constraints.JointJerk(rt.between(-1, 1)), duration=1.0), rt.Mesh(10), progress=False)
