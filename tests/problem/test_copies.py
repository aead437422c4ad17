"""Problems are values: a pickle, a copy and a deep copy are the same problem, also after they were used."""

from __future__ import annotations

import copy
from collections.abc import Callable
from contextlib import suppress

import cloudpickle
import numpy as np
import pytest

import robotraj as rt
from robotraj.cli.demos.table import DEMOS
from tests.programs import nlp_of
from tests.solution.test_storage import every_constraint

COPIES = {"pickle": lambda value: cloudpickle.loads(cloudpickle.dumps(value)), "copy": copy.copy, "deep": copy.deepcopy}


def assert_copies(value: object) -> None:
    """Every kind of copy prints as the value does."""
    for copied in COPIES.values():
        assert str(copied(value)) == str(value)


@pytest.mark.parametrize("name", DEMOS)
def test_the_problem_of_a_demo_is_copied_after_it_was_read(name: str) -> None:
    problem = DEMOS[name].make().problem
    problem = rt.Problem([problem]) if isinstance(problem, rt.Phase) else problem
    for phase in problem.phases:
        for each in phase.constraints:
            if isinstance(each, rt.CollisionFree):
                pairs = each.pairs(phase.robot)
                assert pairs.own_tree is not None or phase.robot.root != "fixed"
        assert phase.rows.rows and phase.dae.states
    assert_copies(problem)
    for copied in COPIES.values():
        other = copied(problem)
        assert [len(phase.rows.rows) for phase in other.phases] == [len(phase.rows.rows) for phase in problem.phases]


@pytest.mark.parametrize("constraint", every_constraint(), ids=lambda each: type(each).__name__)
def test_a_constraint_is_copied_after_it_was_bound(constraint: rt.constraints.Constraint) -> None:
    robot = rt.load("cartpole")
    # Some of them need the parameters of a gait, or are equations at every time, which no phase of a cart-pole has.
    with suppress(rt.InputError):
        assert rt.Phase(robot, 1.0, rt.State(q=0), rt.State(q=0), constraints=[constraint]).rows.rows
    assert_copies(constraint)


OBJECTIVES: dict[str, rt.objectives.Objective] = {
    "effort": rt.Effort() + 2.0 * rt.Duration(),
    "jerk": rt.objectives.Jerk(),
    "torque rate": rt.objectives.TorqueRate(),
    "work": rt.objectives.MechanicalWork() + rt.objectives.AbsolutePower(),
    "centering": rt.objectives.JointCentering(),
    "variation": rt.objectives.SpeedVariation(),
    "expressions": rt.Lagrange(lambda point: point.tau[0] ** 2) + rt.Mayer(lambda start, end: end.q[0]),
    "transport": rt.objectives.CostOfTransport(),
}


@pytest.mark.parametrize("objective", OBJECTIVES.values(), ids=OBJECTIVES)
def test_an_objective_is_copied_after_it_was_transcribed(objective: rt.objectives.Objective) -> None:
    robot = rt.load("cartpole")
    phase = rt.Phase(robot, (0.5, 2.0), rt.State(q=0, v=0), rt.State(q=[1, 0.5], v=0), objective)
    known = nlp_of(rt.Problem([phase]), [rt.Mesh(2)])
    for copied in COPIES.values():
        other = nlp_of(copied(rt.Problem([phase])), [rt.Mesh(2)])
        w = known.guess + 0.1 * known.scale
        assert np.isclose(other.objective(w), known.objective(w), rtol=1e-12)
        assert str(copied(objective)) == str(objective)


@pytest.mark.parametrize("root", ["fixed", "planar", "floating"])
@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES)
def test_a_robot_is_copied_after_its_shapes_and_functions_were_used(root: str, copied: Callable) -> None:
    robot = rt.load("solo12" if root == "floating" else "ur5", root=root)
    assert robot.mass > 0.0 and robot.visual_model.ngeoms > 0
    phase = rt.Phase(robot, 1.0, None, None, rt.Effort())
    assert phase.rows.rows
    other = copied(robot)
    assert other.model == robot.model and other.joint_names == robot.joint_names and other.mass == robot.mass


def test_a_value_that_avoids_obstacles_keeps_no_compiled_shapes() -> None:
    robot = rt.load("ur5")
    clear = rt.CollisionFree([rt.obstacles.Box((0.2, 0.2, 0.2), position=(0.5, 0.0, 0.3))])
    q = np.zeros((1, 6))
    known = clear.pairs(robot).distances(q, np.zeros(1))
    for copied in COPIES.values():
        assert np.array_equal(copied(clear).pairs(robot).distances(q, np.zeros(1)), known)
        assert np.array_equal(copied(clear.pairs(robot)).distances(q, np.zeros(1)), known)
