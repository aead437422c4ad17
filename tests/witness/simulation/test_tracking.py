import numpy as np
import pinocchio as pin
import pytest

from robotraj._util.errors import InputError
from robotraj.dynamics.system import System
from robotraj.witness import track, validate


def upright(make, slip=0.0):
    """Balance an inverted pendulum for 3 s, with torques that are slightly wrong."""
    robot = make.robot([("hinge", pin.JointModelRY())])
    return make.plan(
        make.phase(robot=robot),
        np.linspace(0, 3, 31),
        q=lambda t, k: np.pi,
        v=lambda t, k: 0.0,
        a=lambda t, k: 0.0,
        tau=lambda t, k: slip,
    )


def test_feedback_holds_an_unstable_motion_that_open_loop_loses(make):
    solution = make.solution(upright(make, slip=1e-3))
    assert validate(solution).drift["q.hinge"].largest > 0.5
    tracking = track(solution, kp=60.0, kd=15.0)
    assert tracking.failure is None
    # At rest the feedback and gravity hold the slip: (kp - m g l) error = slip.
    assert tracking.error["q.hinge"].final == pytest.approx(1e-3 / (60.0 - 9.81), rel=1e-3)
    peak = tracking.feedback["hinge"]
    assert (peak.unit, peak.value) == ("N m", pytest.approx(1e-3 * 60 / (60 - 9.81), rel=0.05))


def test_a_disturbed_start_is_recovered(make, swinging):
    tracking = track(make.solution(swinging()), kp=[400.0, 200.0], kd=[60.0, 20.0], offset=[0.05, 0.0, 0.0, 0.0])
    row = tracking.error["q.shoulder"]
    assert row.largest == pytest.approx(0.05, rel=1e-6) and row.time == 0.0
    assert row.final < 0.005
    assert str(tracking).startswith("With feedback: q.shoulder by 0.05 rad from the plan at t = 0 s in phase ")
    assert tracking.feedback["shoulder"].value == pytest.approx(400 * 0.05, rel=1e-6)


def test_without_gains_it_is_the_open_loop_drift(make):
    solution = make.solution(upright(make, slip=1e-6))
    open_loop = validate(solution).drift["q.hinge"].largest
    assert track(solution, 0.0, 0.0).error["q.hinge"].largest == pytest.approx(open_loop, rel=1e-4)


@pytest.mark.parametrize(
    ("kp", "kd", "message"),
    [
        ([1.0, 2.0, 3.0], 1.0, "kp has 3 values"),
        (1.0, -1.0, "kd = -1.0 must be"),
        (np.nan, 1.0, "kp = nan must be"),
    ],
)
def test_gains_that_do_not_fit_are_refused(make, swinging, kp, kd, message):
    with pytest.raises(InputError, match=message):
        track(make.solution(swinging()), kp, kd)


def test_gains_without_a_step_that_fits_end_the_motion(make, swinging):
    tracking = track(make.solution(swinging()), kp=1.0, kd=1e308)
    assert tracking.failure is not None and "t = 0 s" in tracking.failure


def test_systems_have_no_joints_to_feed_back(make):
    block = System(states=["x"], controls=["u"], dynamics=lambda point: [point.u["u"]])
    planned = make.plan(make.phase(system=block), [0, 1], x=lambda t, k: t, u=lambda t, k: 1.0)
    with pytest.raises(InputError, match="moves a System"):
        track(make.solution(planned), 1.0, 1.0)
