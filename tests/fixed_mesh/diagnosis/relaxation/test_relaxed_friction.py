"""Relaxed friction is that of contacts with more friction."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.relaxation.relaxed_friction import MOST, with_free_friction


@pytest.mark.parametrize("cone", [rt.contacts.SecondOrder(), rt.contacts.Linearised(5)])
def test_a_slack_adds_to_the_coefficient(cone: rt.contacts.FrictionCone) -> None:
    robot = rt.load("solo12", root="floating")

    def standing(friction: float) -> rt.Phase:
        contact = rt.PointContact("FL_FOOT", friction=friction, cone=cone)
        return rt.Phase(robot, 0.5, contacts=[contact], parameters={"slack": rt.between(0, None)})

    phase = standing(0.2)
    (free,), relaxed = with_free_friction(phase, "slack")
    assert free.friction == MOST and relaxed is not None
    table, more = phase.rows, standing(0.5).rows
    expression = ca.vertcat(*relaxed.bind(phase.body, phase.parameter_names).expression(table.point))
    values = np.random.default_rng(0).uniform(1.0, 5.0, 400)
    sizes = [symbol.numel() for symbol in table.symbols]
    inputs = [values[sum(sizes[:i]) : sum(sizes[: i + 1])] for i in range(5)]
    inputs[4] = np.where(np.array(phase.parameter_names) == "slack", 0.3, inputs[4])
    found = np.array(ca.Function("relaxed", list(table.symbols), [expression])(*inputs)).ravel()
    rows = [row for row in more.rows if row.joint == "FL_FOOT" and row.name in ("normal force", "friction cone")]
    wanted = np.array(ca.Function("rows", list(more.symbols), [more.column(rows, more.point)])(*inputs)).ravel()
    np.testing.assert_allclose(found, wanted, rtol=1e-12)
