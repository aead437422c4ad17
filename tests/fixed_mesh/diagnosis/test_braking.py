"""Motions that cannot stop before a limit: what is named as a remedy is one, and no longer duration is."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.solvers.status import Status


def slide(mass: float, force: float, low: float, high: float, vertical: bool = False) -> rt.Robot:
    model = pin.Model()
    index = model.addJoint(0, pin.JointModelPZ() if vertical else pin.JointModelPX(), pin.SE3.Identity(), "slide")
    model.appendBodyToJoint(index, pin.Inertia(mass, np.zeros(3), 1e-2 * np.eye(3)), pin.SE3.Identity())
    limits = {"position": (low, high), "velocity": 10.0, "effort": force}
    return rt.load(model, limits={kind: {"slide": limit} for kind, limit in limits.items()})


# Axis, position and speed at the start, position at the end, what the least remedies give way: v^2 = 2 (F / m -+ g) d.
CASES = {
    "1 kg, 5 m/s, 1 m": ((1.0, 10.0, -1.0, 1.0), (0.0, 5.0, 0.5), {"effort": 2.5, "position": 0.25}),
    "2 kg, 3 m/s, 0.5 m": ((2.0, 10.0, -1.0, 0.5), (0.0, 3.0, 0.0), {"effort": 8.0, "position": 0.4}),
    "falling at 4 m/s, 0.5 m": ((2.0, 30.0, 0.0, 5.0, True), (0.5, -4.0, 1.0), {"effort": 21.62, "position": 1.04}),
}


@pytest.mark.slow
@pytest.mark.parametrize("objective", [rt.Duration, rt.Effort])
@pytest.mark.parametrize("name", CASES)
def test_the_one_remedy_of_a_motion_that_cannot_stop_is_little_more_than_the_least(
    name: str, objective: type[rt.objectives.Objective]
) -> None:
    axis, (q, v, end), least = CASES[name]
    phase = rt.Phase(slide(*axis), (0.05, 10.0), rt.State(q=[q], v=[v]), rt.State(q=[end], v=0), objective())
    failed = rt.plan(phase, check=False)
    assert failed.status is Status.INFEASIBLE
    (remedy,) = failed.conflicts
    assert remedy.certain and not remedy.reason
    given_way = abs(remedy.needed - remedy.bound) / least[remedy.name.split()[0]]
    assert 1.0 - 1e-3 <= given_way <= 1.15
