"""Least time along given paths: closed forms, the path is kept, limits hold, plans are plans like any other."""

from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from scipy import interpolate

import robotraj as rt
from robotraj.applications import as_path
from robotraj.problem.objectives.reference_motion import symbolic_states
from robotraj.solvers.status import Status

WAY = np.array(
    [
        [-1.1, -1.8, 1.6, -1.2, -1.57, 0.0],
        [-0.5, -1.5, 1.2, -1.0, -1.2, 0.6],
        [0.2, -1.2, 1.3, -0.6, -1.0, 0.4],
        [1.1, -0.8, 0.6, -0.6, -0.6, 1.2],
    ]
)


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur5")


@pytest.fixture(scope="module")
def retimed(arm):
    return rt.retime(WAY, arm)


def test_a_block_takes_the_time_of_its_closed_form():
    """1 kg and 1 N from rest to rest over 4 m: T = 2 sqrt(4), whatever the parameter of the path."""
    solution = rt.retime(np.array([[0.0], [1.0], [4.0]]), rt.load("block"), parameters=[0.0, 2.0, 5.0])
    assert solution.duration == pytest.approx(4.0, rel=1e-3)


def test_the_motion_keeps_the_path_and_its_limits(arm, retimed):
    sample = retimed.at(np.linspace(0.0, retimed.duration, 2001))
    path = as_path(WAY)
    assert np.abs(sample.q - path(sample.x["path.s"])).max() < 5e-4
    assert np.allclose(sample.q[[0, -1]], WAY[[0, -1]], atol=1e-7) and np.allclose(sample.v[[0, -1]], 0.0, atol=1e-7)
    assert (np.diff(sample.x["path.s"]) > -1e-9).all()
    assert (np.abs(sample.tau) < arm.limits.effort * (1 + 2e-3)).all()
    assert (np.abs(sample.v) < arm.limits.velocity * (1 + 1e-6)).all()
    assert rt.validate(retimed).passed


def test_it_is_saved_and_loaded_like_any_plan(retimed, tmp_path):
    retimed.save(tmp_path / "path.npz")
    again = rt.load_solution(tmp_path / "path.npz")
    assert isinstance(again.problem.phases[0].constraints[0], rt.constraints.FollowPath)
    assert rt.validate(again).passed
    assert np.array_equal(again.at(0.3).q, retimed.at(0.3).q)


def test_no_motion_on_its_own_path_is_longer(arm):
    slow = rt.plan(rt.Phase(arm, 1.5, rt.State(q=WAY[0], v=0), rt.State(q=WAY[-1], v=0), rt.Effort()), rt.Mesh(12))
    fast = rt.retime(slow)
    assert fast.duration < slow.duration * 0.97
    assert rt.retime(fast).duration == pytest.approx(fast.duration, rel=1e-2)


def test_limits_of_jerk_and_torque_rate_hold_along_the_path(arm, retimed):
    limited = rt.retime(WAY, arm, jerk=300.0, torque_rate={"elbow_joint": 1500.0})
    t = np.linspace(0.0, limited.duration, 4001)
    sample = limited.at(t)
    assert np.abs(np.diff(sample.a, axis=0) / np.diff(t)[:, None]).max() < 300 * (1 + 1e-4)
    assert np.abs(np.diff(sample.tau[:, 2]) / np.diff(t)).max() < 1500 * (1 + 2e-3)
    assert limited.duration > retimed.duration
    assert rt.validate(limited).passed


def test_splines_of_scipy_are_taken_as_they_are(arm):
    s = np.linspace(0.0, 1.0, 4)
    cubic, bspline = interpolate.CubicSpline(s, WAY), interpolate.make_interp_spline(s, WAY, k=3)
    at = np.linspace(0.0, 1.0, 57)
    for spline in (cubic, bspline, lambda x: cubic(x)):
        assert np.allclose(as_path(spline)(at), cubic(at), atol=1e-7)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        (WAY[:, :5], r"array \(m, 6\).* got shape \(4, 5\)"),
        (WAY * 10.0, "outside its"),
        (np.vstack([WAY, WAY[-1:]]), "are equal"),
        ("path", "an array"),
    ],
)
def test_paths_that_are_none_are_refused(arm, path, words):
    with pytest.raises(rt.InputError, match=words):
        rt.retime(path, arm)


def test_a_robot_is_needed():
    with pytest.raises(rt.InputError, match="robot="):
        rt.retime(WAY)


def test_a_path_determines_the_ends_of_its_phase(arm):
    follow = rt.constraints.FollowPath(as_path(WAY))
    with pytest.raises(rt.InputError, match="determines the start"):
        rt.Phase(arm, (0.1, 9.0), rt.State(q=WAY[0], v=0), constraints=[follow])
    with pytest.raises(rt.InputError, match="several FollowPath"):
        rt.Phase(arm, (0.1, 9.0), constraints=[follow, follow])


def test_speeds_of_the_path_at_its_ends(arm):
    moving = rt.retime(WAY, arm, start_speed=0.4, end_speed=None)
    slope = as_path(WAY).derivative()
    assert np.allclose(moving.at(0.0).v, 0.4 * slope(0.0), atol=1e-6)
    assert moving.at(moving.duration).x["path.speed"] > 0.5


def test_objectives_read_torques_and_their_rates_on_a_path(arm, retimed):
    """Terms of a robot without a path have the same values along the motion."""
    gentle = rt.retime(WAY, arm, objective=rt.Duration() + 1e-5 * rt.Effort() + 1e-7 * rt.objectives.TorqueRate())
    t = np.linspace(0.0, gentle.duration, 20001)
    tau = gentle.at(t).tau
    effort = np.trapezoid((tau**2).sum(axis=1), t)
    rate = np.trapezoid((np.gradient(tau, t, axis=0) ** 2).sum(axis=1), t)
    assert gentle.objective == pytest.approx(gentle.duration + 1e-5 * effort + 1e-7 * rate, rel=1e-3)
    assert gentle.duration > retimed.duration


def test_distances_on_a_path_are_proved_but_not_changed(arm, retimed):
    data, middle = arm.model.createData(), as_path(WAY)(0.5)
    pin.framesForwardKinematics(arm.model, data, middle)
    tool = data.oMf[arm.frame("tool0")].translation
    near, far = (
        rt.CollisionFree([rt.obstacles.Sphere(0.05, position=tool + offset)]) for offset in (np.zeros(3), [2.0, 0, 0])
    )
    assert rt.retime(WAY, arm, constraints=[far]).duration == pytest.approx(retimed.duration, rel=1e-6)
    with pytest.raises(rt.InputError, match=r"at s = 0\.\d+ .* sphere overlap by .* No timing changes that") as error:
        rt.retime(WAY, arm, constraints=[near])
    assert len(str(error.value)) < 600
    folded = np.array([WAY[0], [-0.5, -1.5, 3.05, -1.0, -1.2, 0.6], WAY[3]])
    with pytest.raises(rt.InputError, match=r"of the path \w+ and \w+ overlap"):
        rt.retime(folded, arm, constraints=[rt.CollisionFree()])


def test_limits_that_cannot_hold_the_arm_on_the_path_are_named(arm):
    weak = arm.limits.with_(effort=0.1 * arm.limits.effort)
    with pytest.raises(rt.NoSolutionFound, match="shoulder_lift_joint"):
        rt.retime(WAY, arm, limits=weak)


def test_a_motion_on_a_path_is_a_reference_and_a_path_of_another(arm, retimed):
    assert as_path(retimed) is retimed.problem.phases[0].constraints[0].path
    t = ca.SX.sym("t")
    names = [f"q.{joint}" for joint in arm.position_names]
    known = symbolic_states(retimed, names, t)
    reference = ca.Function("reference", [t], [ca.vertcat(*(known[name] for name in names))])
    for at in np.linspace(0.0, retimed.duration, 50):
        assert np.allclose(np.array(reference(at)).ravel(), retimed.at(at).q, atol=1e-7)


def test_a_path_is_left_without_a_stop(arm, retimed):
    """Positions and velocities are continuous into a phase that is on no path."""
    free = arm.limits.with_(position=np.inf)
    path, back = (
        rt.Phase(arm, (0.05, 20.0), objective=rt.Duration(), limits=free, name=name, **more)
        for name, more in (
            ("path", {"constraints": [rt.constraints.FollowPath(as_path(WAY), end_speed=None)]}),
            ("back", {"end": rt.State(q=WAY[0], v=0)}),
        )
    )
    solution = rt.plan(rt.Problem([path, back], links=[rt.Continuity(0, 1)]))
    left = solution.phases[0].duration
    before, after = (part.at(left) for part in solution.phases)
    assert np.allclose(before.q, after.q, atol=1e-7) and np.allclose(before.v, after.v, atol=1e-6)
    assert left < retimed.duration and rt.validate(solution).passed


def test_a_proved_duration_is_within_its_claim_of_a_much_finer_one(arm, retimed):
    """The time that lines between knots lose is estimated from their bends; ``tolerance=`` refines by it."""
    fine = rt.retime(WAY, arm, tolerance=1e-5)
    lost = retimed.duration / fine.duration - 1.0
    assert 0.0 < lost < 2.0 * retimed.proof.unsettled < 2e-3
    assert rt.validate(fine).passed


def test_a_failed_solve_on_a_path_relaxes_limits_and_not_the_path(arm):
    few = rt.InteriorPoint(max_iterations=3, fallback=None)
    solution = rt.retime(WAY, arm, solver=few, check=False)
    assert solution.status is Status.ITERATION_LIMIT
    assert not any("path" in conflict.name for conflict in solution.conflicts)


def test_starts_on_a_path_vary_the_motion_along_it(arm, retimed):
    phase = rt.Phase(arm, (0.1, 20.0), objective=rt.Duration(), constraints=[rt.constraints.FollowPath(as_path(WAY))])
    with ThreadPoolExecutor(1) as executor:
        found = rt.multistart(phase, 2, 0, executor=executor)
    assert found.best.duration == pytest.approx(retimed.duration, rel=2e-3)


def test_a_guess_on_a_path_has_a_duration_and_no_positions(arm, retimed):
    (phase,) = retimed.problem.phases
    assert rt.plan(phase, guess=rt.guess.StraightLine(2.0)).duration == pytest.approx(retimed.duration, rel=2e-3)
    joints = rt.State(q=WAY[0]), rt.State(q=WAY[-1])
    for guess in (rt.guess.Keyframes([0, 1], joints), rt.guess.MinimumJerk(), rt.Guess([0, 1], q=WAY[[0, -1]])):
        with pytest.raises(rt.InputError, match="takes them from the path"):
            rt.plan(phase, guess=guess)


def test_a_plan_from_rest_is_retimed_from_rest(arm):
    """Where dq/ds is 0 the joints rest at any ds/dt: least time along a plan of least time is that of the plan."""
    ends = rt.State(q=WAY[0], v=0), rt.State(q=WAY[-1], v=0)
    plan = rt.plan(rt.Phase(arm, (0.1, 10.0), *ends, rt.Duration()))
    again = rt.retime(plan)
    assert again.duration == pytest.approx(plan.duration, rel=5e-4)
    first, last = again.at(0.0), again.at(again.duration)
    assert max(np.abs(first.v).max(), np.abs(last.v).max()) < 1e-9 and first.x["path.speed"] > 0.5
    assert rt.validate(again).passed


def test_a_smooth_plan_is_retimed_under_a_limit_of_jerk(arm):
    ends = rt.State(q=WAY[0], v=0), rt.State(q=WAY[-1], v=0)
    plan = rt.plan(rt.Phase(arm, 1.0, *ends, rt.objectives.Jerk()))
    again = rt.retime(plan, jerk=2000.0)
    assert again.proof.holds and again.duration < plan.duration
    t = np.linspace(0.0, again.duration, 20001)
    assert np.abs(np.diff(again.at(t).a, axis=0) / np.diff(t)[:, None]).max() < 2000.0 * 1.01


@pytest.mark.slow
@pytest.mark.parametrize("objective", [rt.Duration(), rt.Effort()], ids=["least time", "least effort"])
def test_a_plan_under_a_limit_of_jerk_moves_near_its_own_path(arm, objective):
    duration = (0.1, 5.0) if isinstance(objective, rt.Duration) else 1.0
    own = rt.plan(rt.Phase(arm, duration, rt.State(q=WAY[0], v=0), rt.State(q=WAY[-1], v=0), objective))
    gentle = rt.retime(own, jerk=500.0)
    assert gentle.success and rt.validate(gentle).passed
    t = np.linspace(0.0, gentle.duration, 3001)
    sample = gentle.at(t)
    assert np.abs(np.diff(sample.a, axis=0) / np.diff(t)[:, None]).max() < 500 * (1 + 1e-3)
    known = own.at(np.linspace(0.0, own.duration, 20001)).q
    near = np.abs(sample.q[::30, None] - known[None]).max(axis=2).min(axis=1)
    assert near.max() <= 1e-3 * (1 + 1e-6)
    assert gentle.problem.phases[0].constraints[0].deviation == 1e-3
    assert np.allclose(sample.q[[0, -1]], WAY[[0, -1]], atol=1e-9)
    wider = rt.retime(own, jerk=500.0, deviation=0.02)
    assert wider.duration < gentle.duration


def test_paths_are_kept_without_a_deviation(arm, retimed):
    limited = rt.retime(retimed, jerk=2000.0, deviation=0.0)
    assert limited.problem.phases[0].path.curve is retimed.problem.phases[0].path.curve
    with pytest.raises(rt.InputError, match="deviation must be a number of 0 or more"):
        rt.retime(WAY, arm, deviation=-1.0)


def test_least_work_along_a_path_is_planned_by_our_solver_and_agrees_with_ipopt(arm):
    work = rt.objectives.MechanicalWork() + 50.0 * rt.Duration()
    ours, other = (rt.retime(WAY, arm, objective=work, **options) for options in ({}, {"solver": rt.Ipopt()}))
    assert isinstance(ours.settings.solver, rt.InteriorPoint) and rt.validate(ours).passed
    assert ours.objective == pytest.approx(other.objective, rel=1e-3)


def test_a_moving_obstacle_on_the_path_is_named_with_what_to_change(arm):
    """The obstacle leaves the path's end later than the motion of least time arrives there."""
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, WAY[-1])
    x, y, z = data.oMf[arm.frame("tool0")].translation
    ball = rt.obstacles.Sphere(0.1, position=lambda t: [x, y, z + 0.1 * t])
    met = rt.retime(WAY, arm, constraints=[rt.CollisionFree([ball])], check=False)
    assert met.status is Status.NOT_PROVED and len(met.refinement) == 1
    assert "sphere" in str(met) and "Change the path" in " ".join(str(met).split())
    assert "finer mesh" not in str(met)
    later = rt.CollisionFree([rt.obstacles.Sphere(0.1, position=lambda t: [x, y, z + 5.0 * t])])
    assert rt.retime(WAY, arm, constraints=[later]).proof.holds


def test_a_failure_on_a_path_with_jumps_of_jerk_advises_a_deviation(arm):
    back = np.vstack([WAY, WAY[-2::-1]])
    cubic = interpolate.CubicSpline(np.linspace(0.0, 1.0, len(back)), back)
    few = rt.InteriorPoint(max_iterations=3)
    for path, advised in ((cubic, True), (back, False)):
        failed = rt.retime(path, arm, jerk=300.0, solver=few, check=False)
        assert not failed.success and ("deviation=" in str(failed)) is advised
    assert "deviation=" not in str(rt.retime(cubic, arm, solver=few, check=False))
