"""Mechanical work and absolute power: closed form, slacks at their meaning, the bound of the smooth form."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName

EXACT = (10.0 - np.sqrt(80.0)) ** 2
"""Least integral of |F v| for 1 kg over 1 m in 1 s with |F| <= 20 N: thrust to v, coast, brake; work v^2."""
RADAU = rt.schemes.RadauIIA(3)


@pytest.fixture(scope="module")
def block() -> rt.Robot:
    return rt.load("block", limits={"effort": 20.0, "position": (-100.0, 100.0)})


def move(block: rt.Robot, objective: rt.objectives.Objective, **changes: object) -> rt.Phase:
    ends = {"start": rt.State(q=0, v=0), "end": rt.State(q=1, v=0)}
    return rt.Phase(block, **({"duration": 1.0, "objective": objective} | ends | changes))


@pytest.mark.parametrize(("intervals", "known"), [(40, 1.11324), (160, 1.11447)])
def test_block_reaches_the_known_work_of_its_meshes(block: rt.Robot, intervals: int, known: float) -> None:
    solution = rt.plan(move(block, rt.objectives.AbsolutePower()), mesh=rt.Mesh(intervals, RADAU))
    assert solution.objective == pytest.approx(known, abs=6e-6)
    assert solution.objective == pytest.approx(EXACT, rel=2e-3)


def test_work_converges_to_the_exact_one(block: rt.Robot) -> None:
    errors = [
        abs(rt.plan(move(block, rt.objectives.AbsolutePower()), mesh=rt.Mesh(n, RADAU)).objective - EXACT)
        for n in (20, 80)
    ]
    assert errors[1] < errors[0] / 4.0
    assert errors[1] < 5e-4 * EXACT


def test_a_tolerance_finds_the_exact_work_without_a_hand_picked_mesh(block: rt.Robot) -> None:
    solution = rt.plan(move(block, rt.objectives.AbsolutePower()), tolerance=1e-6)
    assert solution.objective == pytest.approx(EXACT, abs=1e-6)


LINES = rt.HermiteSimpson(control=rt.schemes.LinearControl())


def test_lines_on_a_moving_mesh_put_knots_on_the_switches(block: rt.Robot) -> None:
    solution = rt.plan(move(block, rt.objectives.AbsolutePower()), mesh=rt.schemes.MovingMesh(10, LINES))
    assert solution.objective == pytest.approx(EXACT, abs=1e-6)
    switch = np.sqrt(EXACT) / 20.0
    for time in (switch, 1.0 - switch):
        assert np.abs(solution.knots - time).min() < 2e-2


def test_torques_on_lines_hide_no_work() -> None:
    # With free mid-point controls the same plan has an objective of 4e-7 J, while its true work is 10.6 J.
    arm = rt.load("ur5")
    phase = rt.Phase(
        arm,
        duration=2.0,
        start=rt.State(q=[0, -1, 1, 0, 1, 0], v=0),
        end=rt.State(v=0),
        objective=rt.objectives.AbsolutePower(),
        constraints=[rt.AtEnd(rt.FramePosition("tool0", [0.4, 0.3, 0.5]))],
    )
    solution = rt.plan(phase, mesh=rt.Mesh(20, LINES))
    times = np.linspace(0.0, 2.0, 20001)
    sample = solution.at(times)
    spent = np.trapezoid(np.abs(sample.tau * sample.v).sum(axis=1), times)
    assert solution.objective == pytest.approx(spent, rel=0.03)


def test_half_of_the_absolute_power_drives_from_rest_to_rest(block: rt.Robot) -> None:
    mesh = rt.Mesh(40, RADAU)
    absolute, positive, half = (
        rt.plan(move(block, objective), mesh=mesh).objective
        for objective in (
            rt.objectives.AbsolutePower(),
            rt.objectives.MechanicalWork(),
            rt.objectives.MechanicalWork(braking=-0.5),
        )
    )
    assert 2.0 * positive == pytest.approx(absolute, abs=2e-3)
    assert half == pytest.approx(0.5 * positive, abs=2e-3)


@pytest.mark.parametrize(
    "scheme", [rt.HermiteSimpson(), RADAU, rt.schemes.GaussLegendre(2), rt.schemes.LobattoIIIA(4)], ids=repr
)
def test_slacks_are_the_braking_power_at_collocation_points(block: rt.Robot, scheme: rt.schemes.LobattoIIIA) -> None:
    solution = rt.plan(move(block, rt.objectives.AbsolutePower() + 1e-3 * rt.Effort()), mesh=rt.Mesh(20, scheme))
    part = solution.phases[0]
    total = 0.0
    for k, (begin, length) in enumerate(zip(part.knots[:-1], np.diff(part.knots), strict=True)):
        sample = part.at(begin + length * scheme.nodes, interval=k)
        power = sample.tau[:, 0] * sample.v[:, 0]
        np.testing.assert_allclose(sample.u["slack.tau.slider"], np.maximum(-power, 0.0), atol=1e-5)
        total += length * scheme.weights @ (np.abs(power) + 1e-3 * sample.tau[:, 0] ** 2)
    assert solution.objective == pytest.approx(total, abs=1e-5)


def test_smooth_form_lies_below_the_exact_one_by_at_most_its_bound_and_converges(block: rt.Robot) -> None:
    mesh = rt.Mesh(20, RADAU)
    exact = rt.plan(move(block, rt.objectives.AbsolutePower()), mesh=mesh)
    gaps = []
    for smoothing in (1.0, 0.1, 0.01):
        smooth = rt.plan(move(block, rt.objectives.AbsolutePower(smoothing=smoothing)), mesh=mesh, guess=exact)
        gaps.append(exact.objective - smooth.objective)
        assert -1e-6 <= gaps[-1] <= smoothing * 1.0
    assert gaps[0] > 5.0 * gaps[1] > 25.0 * gaps[2]


def test_a_system_with_speeds_costs_what_the_robot_does(block: rt.Robot) -> None:
    system = rt.System(["x", "v"], ["F"], lambda point: [point.x["v"], point.u["F"]])
    phase = rt.Phase(
        system,
        duration=1.0,
        start=rt.State([0, 0]),
        end=rt.State([1, 0]),
        controls={"F": rt.between(-20, 20)},
        objective=rt.objectives.AbsolutePower(speeds={"F": "v"}),
    )
    mesh = rt.Mesh(40, RADAU)
    robot = rt.plan(move(block, rt.objectives.AbsolutePower()), mesh=mesh)
    solution = rt.plan(phase, mesh=mesh)
    assert solution.objective == pytest.approx(robot.objective, abs=1e-5)
    assert rt.validate(solution).passed


def test_plans_with_slacks_are_simulated_and_keep_limits(block: rt.Robot) -> None:
    solution = rt.plan(move(block, rt.objectives.AbsolutePower()), mesh=rt.Mesh(40, RADAU))
    report = rt.validate(solution)
    assert report.passed, str(report)
    times = np.linspace(0.0, 1.0, 101)
    assert solution.at(times).tau.shape == (101, 1)
    assert np.abs(solution.at(solution.phases[0].points).tau).max() <= 20.0 + 1e-6


def test_weights_of_joints_scale_their_work() -> None:
    arm = rt.load("two_link_arm")
    phase = dict(duration=5.0, start=rt.State(q=0, v=0), end=rt.State(q=[0.5, 0.0], v=0))
    twice = rt.plan(
        rt.Phase(arm, objective=rt.objectives.MechanicalWork({"shoulder": 2.0}) + 1e-2 * rt.Effort(), **phase)
    )
    point = twice.phases[0]
    assert "slack.tau.shoulder" in point.at(0.1).u
    assert "slack.tau.elbow" not in point.at(0.1).u


@pytest.mark.parametrize("wrong", [{"braking": -1.0}, {"smoothing": 0.0}, {"smoothing": -1.0}, {"braking": np.nan}])
def test_prices_that_have_no_minimum_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        rt.objectives.MechanicalWork(**wrong)


def test_unknown_joints_and_missing_speeds_are_named(block: rt.Robot) -> None:
    with pytest.raises(UnknownName, match="slidr"):
        move(block, rt.objectives.AbsolutePower({"slidr": 1.0}))
    system = rt.System(["x"], ["F"], lambda point: [point.u["F"]])
    with pytest.raises(InputError, match="speeds="):
        rt.Phase(system, duration=1.0, objective=rt.objectives.AbsolutePower())
    with pytest.raises(UnknownName, match="'w'"):
        rt.Phase(system, duration=1.0, objective=rt.objectives.AbsolutePower(speeds={"F": "w"}))


@pytest.mark.slow
def test_the_default_call_hides_no_work_of_an_arm() -> None:
    """Accelerations that bend between the points showed 17 J on 16 intervals, where the motion takes 47 J."""
    start, end = [-1.1, -1.8, 1.6, -1.2, -1.57, 0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]
    ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
    solution = rt.plan(rt.Phase(rt.load("ur5"), 1.5, *ends, rt.objectives.AbsolutePower()))
    assert solution.proof is not None and solution.proof.motion_holds
    times = np.linspace(0.0, 1.5, 20001)
    sample = solution.at(times)
    spent = np.trapezoid(np.abs(sample.tau * sample.v).sum(axis=1), times)
    assert solution.objective == pytest.approx(spent, rel=0.03)
    assert spent < 28.0
