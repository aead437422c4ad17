"""Solutions: the collocated polynomials, sampled at any time."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.proof import Goals, Proof
from robotraj.solution.reserves.shares import Share
from robotraj.solution.violation import Violation

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])


@pytest.fixture(scope="module")
def swing() -> rt.Solution:
    rest, up = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    return rt.plan(rt.Phase(rt.load("cartpole"), 2.0, rest, up, rt.Effort(), name="swing"), rt.Mesh(20))


@pytest.fixture(scope="module")
def joined() -> rt.Solution:
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2 + point.x["x"] ** 4)
    first = rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State({"x": 1}), cost, name="out")
    second = rt.Phase(BLOCK, (0.5, 3), None, rt.State([3, 0]), cost, name="back")
    return rt.plan(
        rt.Problem([first, second], [rt.Continuity(0, 1)]), [rt.Mesh(3), rt.Mesh(4, rt.schemes.RadauIIA(points=2))]
    )


def test_one_time_gives_vectors_and_many_give_matrices(swing: rt.Solution) -> None:
    one, many = swing.at(0.31), swing.at(np.linspace(0, 2, 7))
    assert one.q.shape == one.v.shape == one.a.shape == (2,) and one.tau.shape == (1,)
    assert many.q.shape == many.v.shape == many.a.shape == (7, 2) and many.tau.shape == (7, 1)
    assert one.x["q.pole"] == one.q[1] and one.u["tau.slider"] == one.tau[0]
    assert many.x["v.pole"].shape == (7,)
    np.testing.assert_allclose(many.z["a.pole"], many.a[:, 1], atol=1e-8)


def test_the_ends_are_those_of_the_problem(swing: rt.Solution) -> None:
    np.testing.assert_allclose(swing.at(0.0).q, [0, 0], atol=1e-9)
    np.testing.assert_allclose(swing.at(2.0).q, [1, np.pi], atol=1e-7)
    np.testing.assert_allclose(swing.at([0.0, 2.0]).v, 0, atol=1e-7)


def test_positions_velocities_and_accelerations_are_derivatives_of_each_other(swing: rt.Solution) -> None:
    """At the collocation points; between them the position's rate misses v by the error of the mesh."""
    phase = swing.phases[0]
    h = 1e-6
    inner = phase.points[1:-1:2]
    for name, rate in (("q", "v"), ("v", "a")):
        slope = (getattr(swing.at(inner + h), name) - getattr(swing.at(inner - h), name)) / (2 * h)
        np.testing.assert_allclose(slope, getattr(swing.at(inner), rate), atol=1e-5)


def test_knots_and_collocation_points_are_where_the_mesh_put_them(swing: rt.Solution) -> None:
    phase = swing.phases[0]
    np.testing.assert_allclose(phase.knots, np.linspace(0, 2, 21))
    np.testing.assert_allclose(phase.points, np.linspace(0, 2, 41))
    np.testing.assert_allclose(swing.knots, phase.knots)


def test_phases_follow_each_other_in_global_time(joined: rt.Solution) -> None:
    out, back = joined.phases
    assert (out.t0, out.duration) == (0.0, 1.0)
    assert back.t0 == pytest.approx(1.0, abs=1e-9)
    assert joined.duration == pytest.approx(1 + back.duration, abs=1e-9)
    times = np.array([joined.duration - 1e-3, 0.2, 1.5, 0.9])
    mixed = joined.at(times)
    for i, t in enumerate(times):
        assert mixed.x["x"][i] == joined.at(float(t)).x["x"]
        assert mixed.u["u"][i] == joined.at(float(t)).u["u"]
    np.testing.assert_array_equal(mixed.t, times)


def test_at_a_joint_the_later_phase_is_used_and_either_can_be_asked(joined: rt.Solution) -> None:
    out, back = joined.phases
    t = back.t0
    assert joined.at(t).u["u"] == back.at(t).u["u"]
    assert out.at(out.knots[1], interval=0).u["u"] == pytest.approx(out.at(out.knots[1]).u["u"], abs=1e-8)
    before, after = back.at(back.knots[2], interval=1), back.at(back.knots[2])
    assert before.x["x"] == pytest.approx(after.x["x"], abs=1e-9)
    assert abs(before.u["u"] - after.u["u"]) > 1e-6


def test_the_cause_of_a_plan_that_is_stopped_is_what_was_not_proved(swing: rt.Solution) -> None:
    """The message is that of the last solve, which may have succeeded on its mesh."""
    proof = Proof(1e-6, 0.2, 1e-5, 1e-5, Goals())
    stopped = replace(swing, status=rt.solvers.Status.TIME_LIMIT, message="solved; the time limit was reached")
    assert stopped.cause == stopped.message
    unproved = replace(stopped, proof=proof, interval_violations=(), control_interval_violations=())
    assert unproved.cause == "time limit, the excess over limits is 2.0e-01 (allowed 1e-03)"


def test_the_cause_at_a_time_limit_is_what_the_last_iterate_uses_up(swing: rt.Solution) -> None:
    """Rows that are not met yet change from iterate to iterate; the remedy eases what is used up."""
    row = Violation("swing", "continuity", "v.pole", 0.1, 2.0, "rad/s", 0.0, "off")
    torque, cone = (Share(kind, "slider", much, 0.2, 0.1) for kind, much in (("torque", 1.3), ("cone", 0.95)))

    def stopped(*shares: Share) -> rt.Solution:
        solution = replace(swing, status=rt.solvers.Status.TIME_LIMIT, violation_list=(row,))
        vars(solution)["shares"] = shares
        return solution

    assert "continuity" in stopped().cause
    assert "continuity" in stopped(replace(torque, largest=0.5)).cause
    pressed = stopped(cone, torque)
    assert pressed.cause.startswith("time limit, and the last iterate uses 130 % of torque (slider")
    assert "by higher effort limits or a lighter load, more friction" in " ".join(str(pressed).split())


@pytest.mark.parametrize("times", ["end", [[0.1, 0.2]], None])
def test_what_is_no_time_is_refused(joined: rt.Solution, times: Any) -> None:
    for part in (joined, joined.phases[0]):
        with pytest.raises(rt.InputError, match=r"Times must be|t = nan s lies outside"):
            part.at(times)


def test_parameters_are_read_by_name() -> None:
    pushed = rt.System(["x"], [], lambda point: [point.p["speed"]])
    phase = rt.Phase(pushed, 2.0, rt.State([0]), rt.State([3]), parameters={"speed": rt.between(0, 5), "spare": 4.0})
    solution = rt.plan(phase, rt.Mesh(2))
    assert solution.parameters == pytest.approx({"speed": 1.5, "spare": 4.0})


def test_the_costs_integral_is_the_objective(swing: rt.Solution) -> None:
    """Simpson's rule over the mesh is the scheme's own quadrature."""
    phase = swing.phases[0]
    values = swing.at(phase.points).tau[:, 0] ** 2
    h = 2.0 / 20
    assert h / 6 * (values[:-1:2] + 4 * values[1::2] + values[2::2]).sum() == pytest.approx(swing.objective, rel=1e-9)


def test_a_motion_of_other_variables_than_those_of_its_phase_is_refused(swing: rt.Solution) -> None:
    """Swapped phases and dropped contacts would end in errors of arrays wherever the motion is read."""
    part, other = swing.phases[0], rt.Phase(BLOCK, 2.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort(), name="block")
    swapped = replace(part, phase=other)
    for read in (lambda: swapped.at(0.5), lambda: rt.validate(replace(swing, phases=(swapped,)))):
        with pytest.raises(rt.InputError, match="The trajectory has 4 states, but phase 'block' has 2"):
            read()
    assert replace(part, phase=part.phase.with_(name="renamed")).at(0.5).t == 0.5
