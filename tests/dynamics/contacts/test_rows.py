"""Contact rows: each level is the time derivative of the one before; forces have the power of the velocity rows."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj.dynamics.contacts.loop_closure import LoopClosure

SEEDS = range(4)
STEP = 1e-5


def shifted(robot: Any, q: Any, v: Any, a: Any, t: float) -> tuple[Any, Any]:
    """Configuration and velocity after t at constant a, to second order."""
    return pin.integrate(robot.model, q, t * v + 0.5 * t * t * a), v + t * a


def test_there_are_as_many_forces_and_names_as_held_rows(case: Any) -> None:
    bound = case.bind()
    q, v, a = case.random(0)
    point = case.numbers(q, v, a)
    anchors = bound.locate(case.robot, q)
    assert list(anchors) == [anchor.name for anchor in bound.anchors]
    sizes = [len(rows) for rows in (bound.position(point, anchors), bound.velocity(point), bound.acceleration(point))]
    assert sizes == [case.rows] * 3
    assert len(bound.forces) == len(bound.holds) == case.rows
    assert len(bound.limits(point, [1.0] * case.rows, anchors)) == len(bound.limit_rows)
    assert len(bound.footing(anchors)) == len(bound.footing_rows)
    assert len(set(bound.forces)) == len(bound.forces)
    assert {anchor.name for anchor in bound.anchors} <= {row.name for row in bound.holds}


def test_each_anchor_is_found_out_by_the_row_of_its_name(case: Any) -> None:
    q, v, a = case.random(1)
    bound = case.placed(q).bind()
    point, anchors = case.numbers(q, v, a), bound.locate(case.robot, q)
    names = [row.name for row in bound.holds]
    found = [names.index(name) for name in anchors]
    slopes = [
        np.array(bound.position(point, {**anchors, name: value + STEP}))[found] / STEP
        for name, value in anchors.items()
    ]
    if slopes:
        assert np.linalg.matrix_rank(slopes, tol=0.1) == len(anchors)


@pytest.mark.parametrize("seed", SEEDS)
def test_position_rows_are_zero_where_the_contact_is_located_or_closed(case: Any, seed: int) -> None:
    q, v, a = case.random(seed)
    if isinstance(case.contact, LoopClosure):
        q = closed(case, q)
    bound = case.placed(q).bind()
    np.testing.assert_allclose(bound.position(case.numbers(q, v, a), bound.locate(case.robot, q)), 0.0, atol=1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_velocity_rows_are_the_rate_of_position_rows_that_are_zero(case: Any, seed: int) -> None:
    q, v, a = case.random(seed)
    if isinstance(case.contact, LoopClosure):
        q = closed(case, q)
    bound = case.placed(q).bind()
    anchors = bound.locate(case.robot, q)
    after, before = (
        np.array(bound.position(case.numbers(*shifted(case.robot, q, v, a, t), a), anchors)) for t in (STEP, -STEP)
    )
    np.testing.assert_allclose((after - before) / (2 * STEP), bound.velocity(case.numbers(q, v, a)), atol=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_acceleration_rows_are_the_rate_of_velocity_rows_anywhere(case: Any, seed: int) -> None:
    q, v, a = case.random(seed)
    bound = case.bind()
    after, before = (np.array(bound.velocity(case.numbers(*shifted(case.robot, q, v, a, t), a))) for t in (STEP, -STEP))
    np.testing.assert_allclose((after - before) / (2 * STEP), bound.acceleration(case.numbers(q, v, a)), atol=1e-7)


@pytest.mark.parametrize("seed", SEEDS)
def test_forces_do_the_power_of_the_velocity_rows(case: Any, seed: int) -> None:
    q, v, a = case.random(seed)
    bound, point = case.bind(), case.numbers(q, v, a)
    forces = np.random.default_rng(seed).normal(size=case.rows)
    power = sum(np.dot(wrench, point.frame(frame).velocity) for frame, wrench in bound.wrench(point, forces))
    assert power == pytest.approx(forces @ np.array(bound.velocity(point), dtype=float), abs=1e-12)


def test_symbols_and_numbers_agree(case: Any) -> None:
    q, v, a = case.random(0)
    case = case.placed(q)
    bound, forces = case.bind(), np.random.default_rng(0).normal(size=case.rows)
    anchors = bound.locate(case.robot, q)
    symbols = [ca.SX.sym("s", n) for n in (len(q), len(v), len(a), case.rows, len(anchors))]
    named = {name: symbols[4][i] for i, name in enumerate(anchors)}

    def rows(point: Any, forces: Any, anchors: Any) -> list[Any]:
        wrenches = [entry for _, wrench in bound.wrench(point, forces) for entry in wrench]
        held = bound.position(point, anchors) + bound.velocity(point) + bound.acceleration(point)
        return held + wrenches + bound.vector(forces) + bound.limits(point, forces, anchors)

    function = ca.Function("rows", symbols, [ca.vertcat(*rows(case.symbols(*symbols[:3]), symbols[3], named))])
    expected = [float(row) for row in rows(case.numbers(q, v, a), forces, anchors)]
    found = np.array(function(q, v, a, forces, list(anchors.values()))).ravel()
    np.testing.assert_allclose(found, expected, atol=1e-11)


def closed(case: Any, q: Any) -> Any:
    """A configuration near q in which the loop is closed, by Newton's method on its own velocity rows."""
    bound, nv = case.bind(), case.robot.nv
    for _ in range(30):
        rows = np.array(bound.position(case.numbers(q, np.zeros(nv), np.zeros(nv)), {}))
        jacobian = np.array([bound.velocity(case.numbers(q, e, np.zeros(nv))) for e in np.eye(nv)]).T
        q = pin.integrate(case.robot.model, q, -np.linalg.pinv(jacobian) @ rows)
    assert np.abs(rows).max() < 1e-10
    return q
