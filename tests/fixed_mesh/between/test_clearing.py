"""Plans among obstacles: proved free, and free by coal at every millisecond."""

from __future__ import annotations

from collections.abc import Callable

import coal
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.fixed_mesh.between.clearing import Clearing
from robotraj.fixed_mesh.between.lowered_limits import LoweredLimits
from robotraj.guess.default import as_guess
from robotraj.solvers import interior_point
from tests.programs import nlp_of

START, GOAL = (-1.1, -1.8, 1.6, -1.2, -1.57, 0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)


def coal_clearance(robot: rt.Robot, solution: rt.Solution, box: rt.obstacles.Box) -> float:
    """Least distance of the exact shapes from a box, sampled at 1 ms [m]."""
    shapes, data = robot.collision_model, robot.model.createData()
    placed, least = shapes.createData(), np.inf
    other = coal.Box(*box.sides)
    for t in np.append(np.arange(0.0, solution.duration, 1e-3), solution.duration):
        pin.updateGeometryPlacements(robot.model, data, shapes, placed, solution.at(t).q)
        position, rotation = box.pose(float(t))
        for i, shape in enumerate(shapes.geometryObjects):
            if shape.parentJoint:
                at = coal.Transform3s(placed.oMg[i].rotation, placed.oMg[i].translation)
                where = coal.Transform3s(rotation, position)
                found = coal.distance(shape.geometry, at, other, where, coal.DistanceRequest(), coal.DistanceResult())
                least = min(least, found)
    return float(least)


def reach(box: rt.obstacles.Box, margin: float = 0.0) -> rt.Phase:
    free = rt.CollisionFree([box], margin, self_collision=False)
    ends = (rt.State(q=START, v=0), rt.State(q=GOAL, v=0))
    return rt.Phase(rt.load("ur5"), (0.2, 5), *ends, rt.Duration(), constraints=[free])


@pytest.mark.parametrize("margin", [0.0, 0.02])
def test_a_ur5_passes_a_box_in_its_way(margin: float) -> None:
    box = rt.obstacles.Box((0.1, 0.1, 0.3), (0.52, 0.07, 0.47))
    blocked = rt.plan(reach(box).with_(constraints=[]))
    solution = rt.plan(reach(box, margin))
    robot = solution.phases[0].phase.robot
    assert coal_clearance(robot, blocked, box) <= 0.0
    assert solution.proof.holds and solution.proof.shortfall == 0.0
    assert coal_clearance(robot, solution, box) >= margin
    assert solution.duration >= blocked.duration - 1e-4


def test_a_round_that_only_lowers_limits_solves_the_same_program(monkeypatch: pytest.MonkeyPatch) -> None:
    counts = {"formulate": 0, "_run": 0, "lower": 0}
    for owner, name in ((interior_point, "formulate"), (rt.InteriorPoint, "_run"), (LoweredLimits, "lower")):
        given = getattr(owner, name)

        def counted(*args: object, name: str = name, given: Callable[..., object] = given) -> object:
            counts[name] += 1
            return given(*args)

        monkeypatch.setattr(owner, name, counted)
    solution = rt.plan(reach(rt.obstacles.Box((0.1, 0.1, 0.3), (0.9, 0.0, 0.2))))
    assert solution.proof.holds
    assert counts["lower"] >= 1
    assert counts["formulate"] <= counts["_run"] - counts["lower"]


def test_a_box_that_moves_in_time_is_avoided_when_it_is_there() -> None:
    box = rt.obstacles.Box((0.1, 0.1, 0.3), lambda t: (0.52, 0.07 + 0.3 * (t - 0.36), 0.47))
    solution = rt.plan(reach(box))
    assert solution.proof.motion_holds
    assert coal_clearance(solution.phases[0].phase.robot, solution, box) > 0.0


def first_rows(problem: rt.Problem) -> np.ndarray:
    """Return the values at the guess of the rows on distances of the first solve."""
    nlp = nlp_of(problem, rt.Mesh(10))
    longer = Clearing(nlp, rt.guess.default_guess(problem)).rows(nlp)
    return longer.values(longer.guess)[len(nlp.rows) :]


def test_rows_of_a_later_phase_meet_obstacles_when_the_phase_runs() -> None:
    def box(t0: float) -> rt.obstacles.Box:
        return rt.obstacles.Box((0.1, 0.1, 0.3), lambda t: (0.52, 0.07 + 0.3 * (t - t0 - 0.36), 0.47))

    still = rt.Phase(rt.load("ur5"), 2.0, rt.State(q=START, v=0), rt.State(q=START, v=0), rt.Duration())
    alone = first_rows(rt.Problem([reach(box(0.0))]))
    later = first_rows(rt.Problem([still, reach(box(2.0))], links=[rt.Continuity(0, 1)]))
    assert len(alone) > 0
    np.testing.assert_allclose(later, alone, atol=1e-9)


def test_an_objective_that_rows_increased_is_not_settled() -> None:
    """Further planes may reduce it again, at less expense than a finer mesh."""
    problem = rt.Problem([reach(rt.obstacles.Sphere(0.05, (0.5, 0.0, 0.5)))])
    clearing = Clearing(nlp_of(problem, rt.Mesh(10)), rt.guess.StraightLine())
    histories = {(2.0,): (False, True), (2.0, 2.001): (True, True), (2.0, 2.2): (False, False)}
    histories |= {(2.0, 2.2, 2.1): (False, False), (2.0, 2.2, 2.199): (True, True), (2.2, 2.0): (False, True)}
    histories |= {(-np.inf, 2.0): (False, True), (2.0, -np.inf): (True, True)}
    for objectives, expected in histories.items():
        clearing._objectives = list(objectives)
        assert (clearing.settled, clearing.settled_after_rise) == expected


def test_few_pairs_have_rows_along_a_solution_and_those_that_fall_short_are_added() -> None:
    """A motion that penetrates the box has left what a few rows describe."""
    box = rt.obstacles.Box((0.1, 0.1, 0.3), (0.52, 0.07, 0.47))
    problem = rt.Problem([reach(box)])
    blocked = rt.plan(reach(box).with_(constraints=[]), mesh=rt.Mesh(10))
    nlp = nlp_of(problem, rt.Mesh(10))
    few = Clearing(nlp, as_guess(blocked))
    before = len(few.rows(nlp).rows)
    few.measure(blocked, bound=False)
    assert not few.proved(0.0)
    assert len(few.rows(nlp).rows) > before
