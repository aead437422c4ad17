"""A change of a problem by a millionth of its size changes neither what a plan costs nor what it finds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt

TINY = 1e-6
"""Size of a change, relative to that of what it is added to."""
MOST = 1.5
"""Largest ratio of the iterations, which stand for the time of a plan."""
LOCKED = {"panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}}


def planned(robot: rt.Robot, objective: rt.objectives.Objective, duration: object) -> rt.Solution:
    """Reach from one drawn configuration to another, whose links may overlap."""
    draw = np.random.default_rng(robot.nv)
    low, high = np.maximum(robot.limits.position_lower, -2.0), np.minimum(robot.limits.position_upper, 2.0)
    first, last = (low + (high - low) * share for share in draw.uniform(0.2, 0.8, (2, robot.nq)))
    ends = rt.State(q=first, v=0), rt.State(q=last, v=0)
    return rt.plan(rt.Phase(robot, duration, *ends, objective, self_collision=False))


def integral(solution: rt.Solution, rate: Callable[[rt.solution.Sample], np.ndarray]) -> float:
    times = np.linspace(0.0, solution.duration, 2001)
    return float(np.trapezoid(rate(solution.at(times)), times))


def effort(sample: rt.solution.Sample) -> np.ndarray:
    return np.asarray((sample.tau**2).sum(axis=1))


def absolute_power(sample: rt.solution.Sample) -> np.ndarray:
    return np.asarray(np.abs(sample.tau * sample.v).sum(axis=1))


def positive_power(sample: rt.solution.Sample) -> np.ndarray:
    return np.asarray(np.maximum(sample.tau * sample.v, 0.0).sum(axis=1))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ur5", "panda", "kinova"])
@pytest.mark.parametrize(("objective", "duration"), [(rt.Effort(), 2.5), (rt.Duration(), (0.2, 10.0))], ids=str)
def test_tiny_changes_cost_no_more_iterations_and_no_objective(
    name: str, objective: rt.objectives.Objective, duration: object
) -> None:
    robot = rt.load(name, locked=LOCKED.get(name))
    plain = planned(robot, objective, duration)
    size = TINY * plain.objective
    torque = float(np.sqrt(integral(plain, effort) / plain.duration))
    rubbing = replace(robot, friction=np.full(robot.nv, TINY * torque))
    terms = {
        "effort": size / integral(plain, effort) * rt.Effort(),
        "absolute power": size / integral(plain, absolute_power) * rt.objectives.AbsolutePower(),
        "mechanical work": size / integral(plain, positive_power) * rt.objectives.MechanicalWork(),
        "tinier power": 1e-3 * size / integral(plain, absolute_power) * rt.objectives.AbsolutePower(),
    }
    changed = {change: planned(robot, objective + term, duration) for change, term in terms.items()}
    changed["dry friction"] = planned(rubbing, objective, duration)
    changed["all at once"] = planned(rubbing, objective + terms["effort"] + terms["absolute power"], duration)
    assert plain.proof is not None and plain.proof.holds
    for change, solution in changed.items():
        assert solution.proof is not None and solution.proof.holds, change
        assert solution.iterations <= MOST * plain.iterations, change
        assert plain.iterations <= MOST * solution.iterations, change
        assert sum(each.iterations == 0 for each in solution.history) <= 1
        assert solution.objective == pytest.approx(plain.objective, rel=rt.solution.Goals().objective), change
        # The changed program is no larger: its time differs by no more than its iterations.
        assert variables(solution) == variables(plain), change


def variables(solution: rt.Solution) -> int:
    """Count states, accelerations and controls of a plan."""
    dae = solution.phases[0].phase.dae
    return len(dae.states) + len(dae.algebraic) + len(dae.controls)
