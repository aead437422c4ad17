"""Gauss's rule on motions whose accelerations are continuous at the knots."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

JOINED = rt.schemes.GaussLegendre(3, joined=True)


def swing(name="two_link_arm"):
    robot = rt.load(name)
    start, end = np.linspace(-0.6, 0.9, robot.nq), np.linspace(1.2, -0.7, robot.nq)
    return rt.Phase(robot, 1.0, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort(), limits=None)


def jumps(solution):
    """Return the jumps of accelerations and torques at the inner knots, in the order of their sizes."""
    knots, beside = solution.knots[1:-1], 1e-12
    before, after = solution.at(knots - beside), solution.at(knots + beside)
    return [np.abs(getattr(before, of) - getattr(after, of)).max() for of in ("a", "tau")]


def test_accelerations_and_torques_are_continuous_where_gauss_alone_lets_them_jump():
    free, joined = (rt.plan(swing(), rt.Mesh(6, s)) for s in (rt.schemes.GaussLegendre(3), JOINED))
    assert max(jumps(joined)) < 1e-7
    assert min(jumps(free)) > 1e-3


def test_a_motion_of_least_effort_is_found_exactly_where_it_is_one_of_its_motions():
    """A mass of 1 kg moves by L in T with least integral of its squared force: the force is a line, 12 L^2 / T^3."""
    block = rt.Phase(rt.load("block"), 2.0, rt.State(q=0, v=0), rt.State(q=3, v=0), rt.Effort(), limits=None)
    mass = rt.load("block").mass
    solution = rt.plan(block, rt.Mesh((0.0, 0.3, 0.45, 1.0), JOINED))
    assert solution.objective == pytest.approx(12 * mass**2 * 3**2 / 2**3, rel=1e-9)


def test_no_motion_of_hermite_simpson_costs_less():
    """Both have the same motions; the sum of one is the integral, and that of the other misses it."""
    found = [rt.plan(swing(), rt.Mesh(16, scheme)) for scheme in (rt.HermiteSimpson(), JOINED)]
    times = np.linspace(0.0, 1.0, 20001)
    costs = [np.trapezoid((solution.at(times).tau ** 2).sum(axis=1), times) for solution in found]
    assert costs[1] < costs[0]
    missed = [abs(solution.objective - cost) for solution, cost in zip(found, costs, strict=True)]
    assert missed[1] < 0.1 * missed[0]


def test_its_error_falls_faster_than_that_of_simpsons_rule():
    """Halving the intervals divides the error of the objective by 2^4 at least."""
    exact = rt.plan(swing(), rt.Mesh(64, rt.schemes.GaussLegendre(4))).objective
    errors = [abs(rt.plan(swing(), rt.Mesh(count, JOINED)).objective - exact) for count in (8, 16, 32)]
    assert errors[0] > 16 * errors[1] > 256 * errors[2]


def test_rows_are_named_and_stored(tmp_path):
    nlp = rt.transcription.transcribe(rt.Problem([swing()]), rt.Mesh(4, JOINED), rt.guess.StraightLine())
    joined = [name for name in nlp.row_names if "continuity" in name]
    assert joined[:2] == ["phase: continuity, a.shoulder, t = 0.25 s", "phase: continuity, a.elbow, t = 0.25 s"]
    assert len(joined) == 2 * 3
    solution = rt.plan(swing(), rt.Mesh(4, JOINED))
    again = rt.load_solution(solution.save(tmp_path / "s.npz"))
    assert again.phases[0].mesh.given == (JOINED,)
    assert max(jumps(again)) < 1e-7


def test_a_robot_with_a_joint_without_motor_is_as_before():
    """Accelerations are joined where all are free."""
    cart = rt.load("cartpole")
    ends = rt.State(q=0, v=0), rt.State(q=[0.3, 0.0], v=0)
    phase = rt.Phase(cart, 1.5, *ends, rt.Effort(), limits=None)
    plain, joined = (rt.plan(phase, rt.Mesh(8, s)) for s in (rt.schemes.GaussLegendre(3), JOINED))
    assert joined.objective == pytest.approx(plain.objective, rel=1e-9)
