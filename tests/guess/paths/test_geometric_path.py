"""Paths around obstacles as guesses: free, timed within limits, and taken by default where the straight line is not."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.guess.default import default_guess
from robotraj.guess.least_time import LineLimits, fastest_line
from robotraj.guess.paths.geometric_path import GeometricPath
from robotraj.guess.paths.path_in_time import in_time
from robotraj.guess.paths.phase_scene import scene_of
from robotraj.guess.paths.planner import PathPlanner, RRTConnect
from robotraj.guess.paths.timed_path import timed_path

START, GOAL = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0]), np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
FRACTIONS = np.linspace(0.0, 1.0, 400)


def reach(*obstacles: Obstacle, margin: float = 0.0) -> rt.Phase:
    free = [rt.CollisionFree(obstacles, margin, self_collision=False)] if obstacles else []
    ends = rt.State(q=START, v=0), rt.State(q=GOAL, v=0)
    return rt.Phase(rt.load("ur5"), (0.2, 9), *ends, rt.Duration(), constraints=free)


BOX = rt.obstacles.Box((0.1, 0.1, 0.3), (0.52, 0.07, 0.47))
ASIDE = rt.obstacles.Box((0.1, 0.1, 0.1), (-1.5, 0.0, 0.2))


def test_one_line_is_run_as_the_fastest_line() -> None:
    phase = reach()
    limits, rest = LineLimits.of(phase), np.zeros(6)
    assert limits is not None
    law = fastest_line(phase, np.append(START, rest), np.append(GOAL, rest))
    path = timed_path(limits, np.array([START, GOAL]))
    assert law is not None and path is not None
    assert path.duration == pytest.approx(law.duration, rel=1e-12)
    place, pace, change = law.motion(FRACTIONS)
    for mine, own in zip(path.motion(FRACTIONS), (place, pace, change), strict=True):
        start = START if own is place else 0.0
        np.testing.assert_allclose(mine, start + own[:, None] * (GOAL - START), atol=1e-9)


def test_a_corner_costs_less_than_a_stop_and_keeps_the_limits() -> None:
    phase = reach()
    limits = LineLimits.of(phase)
    middle = 0.5 * (START + GOAL) + np.array([0, 0.3, 0, 0, 0, 0])
    assert limits is not None
    path = timed_path(limits, np.array([START, middle, GOAL]))
    halves = [timed_path(limits, np.array(ends)) for ends in ([START, middle], [middle, GOAL])]
    assert path is not None
    assert path.duration < sum(half.duration for half in halves if half is not None) - 0.05
    q, rate, second = path.motion(FRACTIONS)
    np.testing.assert_allclose(q[[0, -1]], [START, GOAL], atol=1e-12)
    assert np.all(np.abs(rate / path.duration) <= limits.speeds[1] * (1 + 1e-9))
    np.testing.assert_allclose(rate[[0, -1]], 0.0, atol=1e-6)
    # Positions agree with the integral of the rates.
    np.testing.assert_allclose(np.trapezoid(rate, FRACTIONS, axis=0), GOAL - START, atol=2e-2)
    assert second.shape == q.shape


def test_a_free_straight_line_stays_one() -> None:
    phase = reach(ASIDE)
    guess = rt.guess.GeometricPath().of(phase, 0)
    line = rt.guess.StraightLine().of(phase, 0)
    np.testing.assert_array_equal(guess.states(FRACTIONS), line.states(FRACTIONS))


def test_the_default_guess_goes_around_a_box() -> None:
    phase = reach(BOX, margin=0.01)
    guess = default_guess(rt.Problem([phase]))
    assert isinstance(guess, GeometricPath)
    states = guess.of(phase, 0).states(FRACTIONS)
    scene = scene_of(phase)
    assert scene is not None and scene.margin == 0.01
    assert not scene.is_free(START, GOAL)
    assert scene.clearance(*states[:, :6]) > 0.0
    np.testing.assert_allclose(states[[0, -1], :6], [START, GOAL], atol=1e-12)


def test_a_base_that_stands_in_a_table_blocks_no_way() -> None:
    table = rt.obstacles.Box((1.5, 1.5, 0.1), (0.0, 0.0, -0.065))
    phase = reach(BOX, table)
    scene, (constraint,) = scene_of(phase), phase.constraints
    assert scene is not None and isinstance(constraint, rt.CollisionFree)
    spheres = constraint.pairs(phase.robot).spheres
    base = spheres.joint == 0
    assert np.any(spheres.centre[base, 2] - spheres.radius[base] < -0.015)
    assert scene.clearance(START, GOAL) > 0.0
    guess = rt.guess.GeometricPath()
    assert not guess.is_closed(phase, 0)
    assert scene.clearance(*guess.of(phase, 0).states(FRACTIONS)[:, :6]) > 0.0


def test_distances_of_the_scene_are_those_of_the_constraint() -> None:
    phase = reach(BOX, ASIDE)
    scene, pairs = scene_of(phase), phase.constraints[0].pairs(phase.robot)
    q = np.random.default_rng(2).uniform(-3, 3, (50, 6))
    assert scene is not None
    exact = pairs.distances(q, np.zeros(50)).min(axis=1)
    np.testing.assert_allclose(scene.tree.clearances(q.ravel()), exact, atol=1e-12)


def test_further_ranks_are_other_paths_and_slower() -> None:
    phase = reach(BOX)
    durations = [rt.guess.GeometricPath(rank=rank).of(phase, 0).duration for rank in (0, 1, 2)]
    assert durations == sorted(durations) and len(set(durations)) > 1


class Detour(PathPlanner):
    """Always over one configuration."""

    def path(self, scene: object, start: np.ndarray, end: np.ndarray, seed: int) -> np.ndarray:
        return np.array([start, np.full(6, 0.1 * seed), end])


def test_other_planners_stand_behind_the_same_interface() -> None:
    phase = reach(BOX)
    states = rt.guess.GeometricPath(planner=Detour(), tries=1).of(phase, 0).states(np.linspace(0, 1, 4001))
    assert np.abs(states[:, :6]).max(axis=1).min() < 2e-3


def test_no_path_is_found_without_iterations() -> None:
    phase = reach(BOX)
    scene = scene_of(phase)
    assert scene is not None
    assert RRTConnect(iterations=0).path(scene, START, GOAL, 0) is None


GATE = rt.obstacles.Box((1.2, 0.1, 0.8), lambda t: (1.05, 0.1, 0.4 + 0.9 * ca.sin(2.0 * t)), name="gate")


def least_distance(phase: rt.Phase, guess: GeometricPath) -> float:
    """Return the least distance of the guessed motion from what moves [m]."""
    known = guess.of(phase, 0)
    q = known.states(FRACTIONS)[:, :6]
    (pairs,) = (each.pairs(phase.robot) for each in phase.constraints)
    return float(pairs.distances(q, known.duration * FRACTIONS)[:, : pairs.against].min())


def test_a_motion_waits_for_a_gate_that_opens() -> None:
    phase = reach(GATE)
    assert least_distance(phase, GeometricPath()) > 0.0
    quickest = timed_path(LineLimits.of(phase), np.array([START, GOAL]))  # type: ignore[arg-type]
    assert quickest is not None and GeometricPath().of(phase, 0).duration > quickest.duration + 0.05


def test_a_fixed_duration_is_met_by_waiting() -> None:
    phase = reach(GATE).with_(duration=1.2)
    assert GeometricPath().of(phase, 0).duration == 1.2
    assert least_distance(phase, GeometricPath()) > 0.0


def test_obstacles_of_a_later_phase_are_where_they_are_in_that_phase() -> None:
    # The gate opens 0.5 s before the reach begins, and closes during it.
    still = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=START, v=0), rt.State(q=START, v=0), rt.Duration())
    reaching = reach(GATE)
    problem = rt.Problem([still, reaching], links=[rt.Continuity(0, 1)])
    known = default_guess(problem).prepared(problem).of(reaching, 1)
    (pairs,) = (each.pairs(reaching.robot) for each in reaching.constraints)
    apart = pairs.distances(known.states(FRACTIONS)[:, :6], 1.0 + known.duration * FRACTIONS)
    assert apart[:, : pairs.against].min() > 0.0


def test_a_way_that_stays_blocked_has_no_motion_in_time() -> None:
    path = timed_path(LineLimits.of(reach()), np.array([START, GOAL]))  # type: ignore[arg-type]
    assert path is not None

    def halfway(q, times):  # type: ignore[no-untyped-def]
        return np.repeat((q[:, 0] < 0.0)[:, None], len(times), axis=1)

    assert in_time(path, halfway, (0.1, 3.0)) is None
    free = in_time(path, lambda q, times: np.ones((len(q), len(times)), dtype=bool), (0.1, 3.0))
    assert free is path


@pytest.mark.slow
def test_a_plan_through_a_gate_is_proved_and_certified() -> None:
    solution = rt.plan(reach(GATE))
    assert solution.proof is not None and solution.proof.motion_holds
    assert rt.validate(solution).passed


def test_a_start_that_an_obstacle_leaves_too_late_is_refused_before_planning() -> None:
    leaving = rt.obstacles.Box((0.4, 0.4, 0.4), lambda t: (0.1 + t, -0.4, 0.3), name="cart")
    with pytest.raises(rt.InputError, match=r"at the start, t = 0 s, \w+ and cart overlap"):
        rt.plan(reach(leaving))
