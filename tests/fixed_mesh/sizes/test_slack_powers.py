"""Slacks of powers start at the power of the greatest effort; those that a guess has stay."""

from __future__ import annotations

import numpy as np

import robotraj as rt
from robotraj.fixed_mesh.sizes.slack_powers import SlackPowers


def reach(objective: rt.objectives.Objective) -> rt.Phase:
    """Move a pendulum from rest to rest."""
    robot = rt.load("pendulum")
    limits = robot.limits.with_(effort=3.0)
    return rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=1, v=0), objective, limits=limits)


def test_slacks_are_the_limit_times_the_mean_speed_of_the_guess() -> None:
    phase, places = reach(rt.objectives.AbsolutePower()), np.linspace(0.25, 0.75, 3)
    plain, filled = (guess.of(phase, 0) for guess in (rt.guess.StraightLine(), SlackPowers(rt.guess.StraightLine())))
    assert [variable.name for variable in phase.dae.controls] == ["tau.pivot", "slack.tau.pivot"]
    # A straight line moves by 1 rad in 2 s.
    np.testing.assert_allclose(filled.controls(places)[:, 1], 3.0 * 0.5)
    np.testing.assert_array_equal(filled.controls(places)[:, 0], plain.controls(places)[:, 0])


def test_other_guesses_stay() -> None:
    places = np.linspace(0.0, 1.0, 5)
    effort = reach(rt.Effort())
    given = rt.guess.StraightLine()
    np.testing.assert_array_equal(
        SlackPowers(given).of(effort, 0).controls(places), given.of(effort, 0).controls(places)
    )
    phase = reach(rt.objectives.AbsolutePower())
    solution = rt.plan(phase, mesh=rt.Mesh(6))
    known = rt.guess.FromSolution(solution)
    np.testing.assert_array_equal(SlackPowers(known).of(phase, 0).controls(places), known.of(phase, 0).controls(places))
