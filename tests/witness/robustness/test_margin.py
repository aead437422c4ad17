"""The margin of disturbances: known in closed form, repeated by runs that test it, and different between motions."""

import copy
from dataclasses import astuple, dataclass

import numpy as np
import pytest

import robotraj as rt

pytest.importorskip("mujoco")

CALM = rt.witness.Disturbances(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
RUNS = 12


@dataclass(frozen=True)
class Offset(rt.witness.Disturbances):
    """The first position alone is disturbed, by the first random number of a run."""

    def of_model(self, mujoco, model, rng):
        return copy.copy(model)


@pytest.fixture(scope="module")
def hold():
    """A pendulum that hangs at rest: a deviation of its first position only decays."""
    pendulum = rt.load("pendulum")
    rest = rt.State(q=0, v=0)
    return rt.plan(rt.Phase(pendulum, 0.3, rest, rest, rt.Effort()), mesh=rt.Mesh(10))


@pytest.mark.parametrize(("size", "bound"), [(0.01, 0.02), (0.05, 0.02)])
def test_the_factor_is_four_fifths_of_the_largest_that_loses_no_run(hold, size, bound):
    """abs(f size n) <= bound for the normal number n of every run of the search, those after the runs of the test."""
    offset = Offset(size, *astuple(CALM)[1:])
    found = rt.witness.disturbance_margin(hold, RUNS, disturbances=offset, bound=bound, seed=3)
    drawn = [np.random.default_rng(child).standard_normal() for child in np.random.SeedSequence(3).spawn(2 * RUNS)]
    exact = 0.8 * bound / (size * np.abs(drawn[RUNS:]).max())
    assert exact / 1.1 <= found.factor <= exact
    assert found.disturbances == offset.scaled(found.factor)
    held = np.mean(found.factor * size * np.abs(drawn[:RUNS]) <= bound)
    assert found.runs.held == held


def test_the_runs_that_test_the_factor_are_those_of_monte_carlo(hold):
    found = rt.witness.disturbance_margin(hold, 4, bound=0.05, seed=5)
    again = rt.witness.monte_carlo(hold, 4, disturbances=found.disturbances, bound=0.05, seed=5)
    np.testing.assert_array_equal(found.runs.deviations, again.deviations)
    assert f"the plan tolerates {found.factor:.2g} times the disturbances" in str(found) and str(again) in str(found)


def test_a_plan_without_disturbances_tolerates_at_least_the_largest_factor(hold):
    found = rt.witness.disturbance_margin(hold, 2, disturbances=CALM)
    assert found.factor == 8.0 and "at least 8" in str(found)


def test_a_plan_that_is_lost_by_the_least_disturbance_tolerates_none(hold):
    found = rt.witness.disturbance_margin(hold, 2, disturbances=Offset(100.0, *astuple(CALM)[1:]), bound=1e-3)
    assert found.factor == 0.0 and not any(astuple(found.disturbances))


@pytest.mark.slow
def test_the_margin_tells_motions_apart():
    """An acrobot that balances tolerates more than one that swings up with large torques.

    Both motions have one optimum that the default call finds under any round-off; slower swing-ups have several.
    """
    acrobot = rt.load("acrobot")
    up = rt.State(q=[np.pi, 0], v=0)
    rising, swinging = (
        rt.plan(rt.Phase(acrobot, duration, rt.State(q=start, v=0), up, rt.Effort()))
        for duration, start in ((2.0, [np.pi - 0.2, 0]), (3.0, [0, 0]))
    )
    gentle, violent = (rt.witness.disturbance_margin(plan, 20, bound=0.3) for plan in (rising, swinging))
    assert gentle.factor > 2.0 * violent.factor
    assert gentle.runs.held >= 0.95 and violent.runs.held >= 0.95


@pytest.mark.parametrize(
    ("options", "message"), [({"runs": 0}, "runs"), ({"bound": -1.0}, "bound"), ({"rate": 0.0}, "rate")]
)
def test_bad_input(hold, options, message):
    with pytest.raises(rt.InputError, match=message):
        rt.witness.disturbance_margin(hold, **options)
