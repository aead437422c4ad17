import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from tests.lies import GRIPPER
from tests.robots.cartpole import swing_up

pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")

WITHOUT = rt.witness.NoFeedback()


@pytest.fixture
def swing(make):
    """An exact motion q = (sin 2t, cos 3t) of two links with damping and armature."""
    joints = [("shoulder", pin.JointModelRY()), ("elbow", pin.JointModelRY())]
    robot = make.robot(joints, damping=0.2, armature=0.05)

    def build(duration=1.0, knots=21, **phase):
        return make.solution(
            make.robot_plan(
                robot,
                np.linspace(0, duration, knots),
                lambda t, k: np.array([np.sin(2 * t), np.cos(3 * t)]),
                lambda t, k: np.array([2 * np.cos(2 * t), -3 * np.sin(3 * t)]),
                lambda t, k: np.array([-4 * np.sin(2 * t), -9 * np.cos(3 * t)]),
                **phase,
            )
        )

    return build


def test_without_feedback_the_drift_falls_with_the_square_of_the_step(swing):
    coarse, fine = (rt.witness.second_opinion(swing(), feedback=WITHOUT, step=step) for step in (2e-3, 1e-3))
    assert coarse.completed and fine.completed
    for name in coarse.deviation:
        assert np.log2(coarse.deviation[name].largest / fine.deviation[name].largest) == pytest.approx(2, abs=0.1)
    assert fine.deviation.largest("q.") < 1e-5
    assert fine.step == pytest.approx(1e-3) and fine.simulation.times[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("feedback", [rt.witness.LinearQuadratic(), rt.witness.JointFeedback(frequency=4.0)], ids=str)
def test_feedback_recovers_a_disturbed_start(swing, feedback):
    opinion = rt.witness.second_opinion(swing(), feedback=feedback, offset=[0.05, -0.05, 0.0, 0.0])
    row = opinion.deviation["q.shoulder"]
    assert row.largest >= 0.05 and row.final < 1e-3
    first = opinion.effort["shoulder"]
    assert first.unit == "N m" and first.value > 0.1


def test_joint_feedback_is_the_oscillator_it_promises(make):
    robot = make.robot([("slide", pin.JointModelPX())], mass=2.0)
    resting = make.plan(make.phase(robot=robot), [0.0, 0.5], **{k: (lambda t, k: 0.0) for k in ("q", "v", "a", "tau")})
    feedback = rt.witness.JointFeedback(frequency=2.0, damping=0.5)
    opinion = rt.witness.second_opinion(make.solution(resting), feedback=feedback, offset=[0.01, 0.0], step=1e-4)
    w, t = 2 * np.pi * 2.0, opinion.simulation.times
    turn = w * np.sqrt(1 - 0.5**2)
    expected = 0.01 * np.exp(-0.5 * w * t) * (np.cos(turn * t) + 0.5 * w / turn * np.sin(turn * t))
    # Held over each step of 0.1 ms, the feedback lags by half of it.
    np.testing.assert_allclose(opinion.simulation.q[:, 0], expected, atol=2e-5)


def test_the_regulator_of_a_mass_is_riccatis(make):
    robot = make.robot([("slide", pin.JointModelPX())], mass=2.0)
    limits = make.limits(1, effort=[10.0])
    limits.joints = ("slide",)
    resting = make.plan(
        make.phase(robot=robot, limits=limits), [0.0, 5.0], **{k: (lambda t, k: 0.0) for k in ("q", "v", "a", "tau")}
    )
    feedback = rt.witness.LinearQuadratic(position=0.1, velocity=2.0, effort=0.5)
    # x'' = u / 2 with u priced by 1 / 5^2: p12 = 5 / 0.1 and so on, from the algebraic Riccati equation.
    k1 = 5.0 / 0.1
    k2 = np.sqrt(5.0**2 / 2.0**2 + 2 * 2.0 * k1)
    offset = 1e-3
    opinion = rt.witness.second_opinion(make.solution(resting), feedback=feedback, offset=[offset, 0.0], step=2e-3)
    assert opinion.effort["slide"].value == pytest.approx(k1 * offset, rel=0.02)
    damped = rt.witness.second_opinion(make.solution(resting), feedback=feedback, offset=[0.0, offset], step=2e-3)
    assert damped.effort["slide"].value == pytest.approx(k2 * offset, rel=0.02)


def test_torques_end_at_the_effort_limit(make, swing):
    limits = make.limits(2, effort=[5.0, np.inf])
    limits.joints = ("shoulder", "elbow")
    opinion = rt.witness.second_opinion(swing(limits=limits))
    assert 0 < opinion.saturated < 1
    assert opinion.deviation.largest("q.") > 0.1


def test_ur5_drifts_little_without_feedback():
    ur5 = rt.load("ur5")
    start, end = rt.State(q=[0, -1.5, 1, 0, 0, 0], v=0), rt.State(q=[1, -1, 1.5, 0.5, 0.5, 1], v=0)
    move = rt.Phase(ur5, duration=1.0, start=start, end=end, objective=rt.Effort())
    opinion = rt.witness.second_opinion(
        rt.plan(move, mesh=rt.Mesh(20, rt.schemes.FifthDegree())), feedback=WITHOUT, step=2e-4
    )
    assert opinion.completed
    assert opinion.deviation.largest("q.") < 1e-4


def test_cart_pole_swings_up_with_feedback_on_a_mesh_too_coarse_without():
    phase = swing_up()
    solution = rt.plan(phase, mesh=rt.Mesh(20, rt.HermiteSimpson()))
    alone, held = (rt.witness.second_opinion(solution, feedback=f) for f in (WITHOUT, None))
    assert alone.deviation["q.pole"].final > 0.1
    assert held.completed and held.deviation.largest("q.") < 5e-3
    pushed = rt.witness.second_opinion(solution, offset=[0.05, 0.05, 0.0, 0.0])
    assert pushed.deviation.largest("q.") >= 0.05
    assert max(pushed.deviation[name].final for name in ("q.slider", "q.pole")) < 1e-3


def test_a_periodic_swing_is_followed_over_and_over():
    turn = rt.Phase(
        rt.load("pendulum"),
        duration=1.2,
        start=rt.State(q=0.0, v=rt.between(2.0, 9.0)),
        objective=rt.Effort(),
        limits=None,
    )
    period = rt.Problem([turn], links=[rt.Periodic({"q.pivot": 2 * np.pi})])
    solution = rt.plan(period, mesh=rt.Mesh(30, rt.HermiteSimpson()))
    opinion = rt.witness.second_opinion(solution)
    assert (opinion.periods, opinion.completed) == (3, True)
    assert opinion.duration == pytest.approx(3 * 1.2)
    assert opinion.simulation.q[-1, 0] == pytest.approx(6 * np.pi, abs=1e-3)
    assert rt.witness.second_opinion(solution, 5).simulation.q[-1, 0] == pytest.approx(10 * np.pi, abs=1e-3)


def test_it_prints_what_it_found(swing):
    text = str(rt.witness.second_opinion(swing()))
    assert "MuJoCo follows the plan once, 1 s" in text
    assert text.splitlines()[-1] == "PASSED: the robot completed the plan"
    assert "time-varying LQR" in text and "RK4, steps of 0.0005 s" in text
    assert "q.elbow" in text and "feedback added at most" in text


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"periods": 2}, "periods = 2, but the plan does not end as it starts"),
        ({"periods": 0}, "periods must be a whole number from 1"),
        ({"step": 0.0}, "step = 0.0; give a positive time"),
        ({"offset": [1.0, 2.0]}, "offset has 2 values; give one, or 4"),
        ({"ground": rt.terrain.Flat()}, "ground = Flat.*; give rt.witness.SoftGround"),
        ({"feedback": 3.0}, "feedback = 3.0; give rt.witness.LinearQuadratic"),
    ],
)
def test_options_that_cannot_hold_are_refused(swing, options, message):
    with pytest.raises(InputError, match=message):
        rt.witness.second_opinion(swing(), **options)


@pytest.mark.parametrize(
    ("make_value", "message"),
    [
        (lambda: rt.witness.LinearQuadratic(velocity=0.0), "velocity = 0.0 of LinearQuadratic"),
        (lambda: rt.witness.JointFeedback(frequency=-1.0), "frequency = -1.0 of JointFeedback"),
        (lambda: rt.witness.SoftGround(time=np.nan), "time = nan of SoftGround"),
    ],
)
def test_values_without_meaning_are_refused(make_value, message):
    with pytest.raises(InputError, match=message):
        make_value()


def test_systems_are_refused(make):
    block = rt.System(states=["x"], controls=["u"], dynamics=lambda point: [point.u["u"]])
    planned = make.plan(make.phase(system=block), [0, 1], x=lambda t, k: t, u=lambda t, k: 1.0)
    with pytest.raises(InputError, match="second_opinion\\(\\) simulates robots"):
        rt.witness.second_opinion(make.solution(planned))


def test_a_gripper_that_opens_on_the_way_is_proved_simulated_and_stored(tmp_path):
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    robot = rt.load(tmp_path / "gripper.urdf")
    start, end = rt.State(q={"lift": 0, "left_joint": 0}, v=0), rt.State(q={"lift": 1, "left_joint": 0.04}, v=0)
    solution = rt.plan(rt.Phase(robot, 1.0, start, end, rt.Effort()))
    assert solution.proof.holds
    report = rt.validate(solution)
    assert report.passed and report.energy.relative < 1e-9
    opinion = rt.witness.second_opinion(solution)
    assert opinion.completed
    solution.save(tmp_path / "gripper.npz")
    again = rt.load_solution(tmp_path / "gripper.npz")
    assert rt.validate(again).passed
    # Both fingers are 0.04 m from the middle at the end.
    model, last = again.problem.phases[0].robot.model, again.at(1.0).q
    data = model.createData()
    pin.framesForwardKinematics(model, data, last)
    hand = data.oMi[model.getJointId("lift")]
    left, right = (hand.actInv(data.oMf[model.getFrameId(f)].translation) for f in ("left", "right"))
    np.testing.assert_allclose([left[1], right[1]], [0.04, -0.04], atol=1e-9)
