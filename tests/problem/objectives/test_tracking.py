"""Tracking: closed forms, references that can be followed exactly, solutions as references."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName
from robotraj.problem.objectives.reference_motion import symbolic_states

INTEGRATOR = rt.System(["x"], ["u"], lambda point: [point.u["u"]], name="integrator")


@pytest.fixture(scope="module")
def arm() -> rt.Robot:
    return rt.load("two_link_arm", limits={"effort": 100.0, "velocity": 100.0})


def reach(arm: rt.Robot, scheme: rt.schemes.LobattoIIIA, knots: int) -> rt.Solution:
    ends = {"start": rt.State(q=0, v=0), "end": rt.State(q=[0.6, -0.4], v=0)}
    return rt.plan(rt.Phase(arm, duration=2.0, objective=rt.Effort(), **ends), mesh=rt.Mesh(knots, scheme))


def test_a_constant_reference_has_the_cost_of_the_riccati_equation() -> None:
    # min of the integral of (x - 1)^2 + u^2, x(0) = 0: tanh T, with x = 1 - cosh(T - t) / cosh T.
    phase = rt.Phase(
        INTEGRATOR,
        duration=1.5,
        start=rt.State([0.0]),
        objective=rt.objectives.Tracking(lambda t: {"x": 1.0}) + rt.Effort(),
    )
    solution = rt.plan(phase, mesh=rt.Mesh(20, rt.schemes.LobattoIIIA(4)))
    assert solution.objective == pytest.approx(np.tanh(1.5), rel=1e-9)
    assert solution.at(0.7).x["x"] == pytest.approx(1.0 - np.cosh(0.8) / np.cosh(1.5), abs=1e-8)


def test_a_reference_that_can_be_followed_is(arm: rt.Robot) -> None:
    # Velocities belong to the reference: they start as it does.
    phase = rt.Phase(
        arm,
        duration=1.0,
        start=rt.State(q=[0.0, 0.5], v=[1.0, 0.0]),
        objective=rt.objectives.Tracking(lambda t: {"q": [np.sin(t), 0.5 * np.cos(t)]}),
    )
    solution = rt.plan(phase, mesh=rt.Mesh(20))
    times = np.linspace(0.0, 1.0, 40)
    np.testing.assert_allclose(solution.at(times).q, np.column_stack([np.sin(times), 0.5 * np.cos(times)]), atol=1e-4)
    assert solution.objective < 1e-7


@pytest.mark.parametrize("scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(2)], ids=repr)
def test_a_solution_as_an_expression_is_the_solution(arm: rt.Robot, scheme: rt.schemes.LobattoIIIA) -> None:
    solution = reach(arm, scheme, 7)
    t = ca.SX.sym("t")
    names = ["q.shoulder", "v.elbow"]
    function = ca.Function("states", [t], [ca.vertcat(*symbolic_states(solution, names, t).values())])
    times = np.sort(np.random.default_rng(0).uniform(0.0, 2.0, 200))
    sample = solution.at(times)
    np.testing.assert_allclose(
        np.hstack([function(s) for s in times]).T,
        np.column_stack([sample.q[:, 0], sample.v[:, 1]]),
        atol=1e-11,
    )
    before, after = (np.array(function(s)).ravel() for s in (-1.0, 3.0))
    np.testing.assert_allclose(before, [0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(after, [0.6, 0.0], atol=1e-9)


def test_a_solution_is_followed(arm: rt.Robot) -> None:
    first = reach(arm, rt.HermiteSimpson(), 20)
    phase = rt.Phase(arm, duration=2.0, start=rt.State(q=0, v=0), objective=rt.objectives.Tracking(first, q=1.0, v=1.0))
    solution = rt.plan(phase, mesh=rt.Mesh(20))
    # Inside intervals positions are integrals of the speeds, which the scheme's order sets apart from what is followed.
    np.testing.assert_allclose(solution.at(first.knots).v, first.at(first.knots).v, atol=1e-3)
    np.testing.assert_allclose(solution.at(first.knots).q, first.at(first.knots).q, atol=1e-5)


def test_a_frame_follows_a_path(arm: rt.Robot) -> None:
    first = reach(arm, rt.HermiteSimpson(), 20)
    phase = rt.Phase(
        arm,
        duration=2.0,
        start=rt.State(q=0, v=0),
        objective=rt.objectives.Tracking(first, frames={"tip": 100.0}) + 1e-8 * rt.Effort(),
    )
    solution = rt.plan(phase, mesh=rt.Mesh(20))
    data = arm.model.createData()

    def tips(plan: rt.Solution) -> np.ndarray:
        places = []
        for q in plan.at(np.linspace(0.0, 2.0, 20)).q:
            pin.framesForwardKinematics(arm.model, data, q)
            places.append(data.oMf[arm.frame("tip")].translation.copy())
        return np.array(places)

    np.testing.assert_allclose(tips(solution), tips(first), atol=2e-4)


def test_what_the_reference_does_not_give_is_named(arm: rt.Robot) -> None:
    def phase(objective: rt.objectives.Objective) -> rt.Phase:
        return rt.Phase(arm, duration=1.0, objective=objective)

    with pytest.raises(InputError, match="'q'"):
        phase(rt.objectives.Tracking(lambda t: {"v": [0, 0]}))
    with pytest.raises(InputError, match="1 values; it must have 2"):
        phase(rt.objectives.Tracking(lambda t: {"q": 0.0}))
    with pytest.raises(UnknownName, match="tpi"):
        phase(rt.objectives.Tracking(lambda t: {"tpi": [0, 0, 0]}, frames={"tpi": 1.0}))
    with pytest.raises(InputError, match="mapping"):
        phase(rt.objectives.Tracking(lambda t: [0, 0]))
    with pytest.raises(InputError, match="only weights of 0"):
        phase(rt.objectives.Tracking(lambda t: {"q": [0, 0]}, q=0.0))
    with pytest.raises(InputError, match="function of time"):
        phase(rt.objectives.Tracking(3.0))
    with pytest.raises(InputError, match="states="):
        rt.Phase(INTEGRATOR, duration=1.0, objective=rt.objectives.Tracking(lambda t: {"x": 0}, q=1.0))
