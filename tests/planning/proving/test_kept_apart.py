"""Plans keep the links of a robot from overlapping; free plans are as they were, and what stays is named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.planning.proving import kept_apart
from robotraj.planning.proving.among_spheres import among_spheres
from robotraj.planning.proving.free_solution import FreeSearch
from robotraj.planning.proving.kept_apart import OVERLAPS, KeptApart
from robotraj.planning.proving.own_overlaps import motion_of
from robotraj.robot.collision.own_body import own_body
from robotraj.solvers.status import Status

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'


def wrist(angle: float) -> rt.State:
    """A ur5 whose first wrist joint has an angle; the wrist overlaps the forearm between 1.2 and 1.9 rad."""
    return rt.State(q=(0, -1.5, 0.5, angle, 0, 0), v=0)


def overlapping_times(solution: rt.Solution) -> int:
    """Number of milliseconds at which Pinocchio finds a pair of links in collision, neighbours left out."""
    robot = solution.phases[0].phase.robot
    shapes, data = robot.collision_model.copy(), robot.model.createData()
    shapes.removeAllCollisionPairs()
    for a, b in own_body(robot).pairs.tolist():
        shapes.addCollisionPair(pin.CollisionPair(min(a, b), max(a, b)))
    results, times = shapes.createData(), np.arange(0.0, solution.duration, 1e-3)
    return sum(pin.computeCollisions(robot.model, data, shapes, results, q, True) for q in solution.at(times).q)


def between_free_ends(name: str, number: int) -> rt.Phase:
    """The least time between two random configurations without overlaps, drawn one after the other."""
    robot, rng = rt.load(name), np.random.default_rng(0)
    body = own_body(robot)
    lower, upper = np.maximum(robot.limits.position_lower, -3), np.minimum(robot.limits.position_upper, 3)
    while number:
        ends = rng.uniform(lower, upper), rng.uniform(lower, upper)
        number -= not (body.touching(robot, ends[0]) or body.touching(robot, ends[1]))
    return rt.Phase(robot, (0.1, 10), rt.State(q=ends[0], v=0), rt.State(q=ends[1], v=0), rt.Duration())


@pytest.mark.slow
@pytest.mark.parametrize("number", [10, 16])
def test_least_times_of_an_arm_do_not_drive_its_wrist_into_its_forearm(number: int) -> None:
    phase = between_free_ends("ur5", number)
    through, around = rt.plan(phase.with_(self_collision=False)), rt.plan(phase)
    assert overlapping_times(through) and not overlapping_times(around)
    assert around.proof.holds and rt.validate(around).passed
    # Rows only take motions away, so that the time grows or stays, up to what the proof leaves.
    assert around.duration > through.duration * (1.0 - 2e-3)


@pytest.mark.slow
def test_a_motion_that_is_symmetric_to_the_overlap_goes_around_it() -> None:
    """No row along the straight motion moves the wrist sideways; a path without overlaps is the guess."""
    solution = rt.plan(rt.Phase(rt.load("ur5"), (0.1, 10), wrist(0.6), wrist(2.4), rt.Duration()))
    assert solution.proof.holds and not overlapping_times(solution)
    assert np.abs(solution.at(np.linspace(0, solution.duration, 50)).q[:, 4]).max() > 0.1


def test_a_plan_that_keeps_off_itself_anyway_is_the_same_as_without() -> None:
    phase = rt.Phase(rt.load("ur5"), 1.0, wrist(0.0), rt.State(q=(1, -1, 0.5, -1, 0, 0), v=0), rt.Effort())
    kept, free = rt.plan(phase), rt.plan(phase.with_(self_collision=False))
    assert kept.objective == free.objective and kept.iterations == free.iterations and kept.proof.holds


def closed(tmp_path: Path, **changes: object) -> rt.Phase:
    """A hand that slides along x through a wall, which is a link of the robot: there is no way around."""
    wall = '<collision><origin xyz="0 0 0"/><geometry><box size="0.02 2 2"/></geometry></collision>'
    hand = '<collision><geometry><sphere radius="0.05"/></geometry></collision>'
    links = (
        f'<link name="wall">{wall}</link><link name="cart">{INERTIAL}</link><link name="hand">{INERTIAL}{hand}</link>'
    )
    limit = '<limit lower="-1" upper="1" velocity="2" effort="50"/>'
    joints = (
        f'<joint name="x" type="prismatic"><parent link="wall"/><child link="cart"/><axis xyz="1 0 0"/>{limit}</joint>'
        f'<joint name="y" type="prismatic"><parent link="cart"/><child link="hand"/><axis xyz="0 1 0"/>{limit}</joint>'
    )
    (tmp_path / "robot.urdf").write_text(f'<robot name="gate">{links}{joints}</robot>')
    gate = rt.load(str(tmp_path / "robot.urdf"))
    ends = rt.State(q=(-0.5, 0), v=0), rt.State(q=(0.5, 0), v=0)
    return rt.Phase(gate, 1.0, *ends, rt.Effort(), name="gate").with_(**changes)


def test_a_closed_way_is_not_proved_and_names_the_links(tmp_path: Path) -> None:
    solution = rt.plan(closed(tmp_path), check=False)
    assert solution.status is Status.NOT_PROVED and not solution.proof.holds
    # The deepest point of the ball is at the far side of the wall, 0.01 m below the nearer face in its middle.
    assert solution.proof.shortfall >= 0.009
    (worst,) = (each for each in solution.interval_violations if each.name == "clearance")
    assert worst.joint == "hand and wall" and worst.phase == "gate"


def test_a_flying_robot_that_cannot_keep_off_itself_is_tried_briefly(tmp_path: Path) -> None:
    closed(tmp_path)
    robot = rt.load(str(tmp_path / "robot.urdf"), root="floating")
    first, last = robot.neutral.copy(), robot.neutral.copy()
    first[[2, 7]], last[[2, 7]] = (1.0, -0.5), (0.8, 0.5)
    phase = rt.Phase(robot, 0.8, rt.State(q=first), rt.State(q=last), rt.Effort())
    through, tried = rt.plan(phase.with_(self_collision=False)), rt.plan(phase)
    assert through.proof.holds and not tried.proof.holds
    assert tried.objective == through.objective and tried.iterations <= through.iterations + PATIENCE


def test_self_collision_false_plans_through_the_robot(tmp_path: Path) -> None:
    solution = rt.plan(closed(tmp_path, self_collision=False))
    assert solution.proof.holds and rt.validate(solution).left_out


@pytest.mark.slow
def test_an_arm_that_would_fold_through_itself_goes_around_itself() -> None:
    """From the straight arm, least effort folds the elbow through the shoulder, eight pairs of links deep."""
    ends = rt.State(q=0, v=0), rt.State(q=(1, -1, 1, 0, 0, 0), v=0)
    phase = rt.Phase(rt.load("ur5"), 2.0, *ends, rt.Effort())
    through, around = rt.plan(phase.with_(self_collision=False)), rt.plan(phase)
    assert overlapping_times(through) > 100 and not overlapping_times(around)
    assert around.proof.holds and around.objective > through.objective
    answers = [each.response for each in around.history.rounds if each.lacked == OVERLAPS]
    assert answers[0] == "a way around itself" and all(answers)


@pytest.mark.slow
def test_a_reach_whose_least_effort_folds_the_arm_into_itself_is_planned_unfolded() -> None:
    """In 5 s the torques of gravity make folding worth it: joints that move by 0.5 rad turn by 4 rad on the way."""
    first = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
    phase = rt.Phase(rt.load("ur5"), 5.0, rt.State(q=first, v=0), rt.State(q=first + 0.5, v=0), rt.Effort())
    solution = rt.plan(phase)
    assert solution.proof.holds and not overlapping_times(solution)


def test_a_plan_from_a_solution_that_rows_keep_apart_has_these_rows_at_once() -> None:
    """Without them it would end at the overlap, and look for a free motion as a plan from nothing does."""
    home = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])

    def reach(*goal: float) -> rt.Phase:
        end = rt.State(q=home + [*goal, 0, 0, 0], v=0)
        return rt.Phase(rt.load("ur5"), 1.0, rt.State(q=home, v=0), end, rt.Effort())

    near, phase = rt.plan(reach(0.8, 0.1, 0.0)), reach(0.82, 0.12, 0.02)
    assert overlapping_times(rt.plan(phase.with_(self_collision=False)))
    cold = rt.plan(phase)
    warm = rt.plan(phase, mesh=near.phases[0].mesh, goals=near.proof.goals, guess=near)
    assert warm.proof.holds and not overlapping_times(warm)
    assert warm.iterations <= 0.4 * cold.iterations
    # Either optimum is one along rows that are fixed on a motion near it.
    assert warm.objective == pytest.approx(cold.objective, rel=2e-3)


def test_rows_that_gain_nothing_but_rounding_are_not_fixed_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """The depth falls by 1e-12 of itself from plan to plan: without a limit of time the plans would have no end."""
    phase = rt.Phase(rt.load("ur5"), 1.0, wrist(0.6), wrist(2.4), rt.Effort(), self_collision=False)
    solution, problem = rt.plan(phase), rt.Problem([phase.with_(self_collision=True)])
    apart = KeptApart(problem, solution.settings)
    pairs, motion = apart._overlaps.of(0, solution.phases[0]), motion_of(solution.phases[0])
    search = FreeSearch.begin(problem, apart._overlaps.bodies, [motion], False, [pairs], solution)
    depths = iter([0.03 * (1.0 - 1e-12) ** k for k in range(9)])
    monkeypatch.setattr(apart._overlaps, "depths_at", lambda *_: [dict.fromkeys(pairs, next(depths))])
    stage, count = kept_apart._Plan(search, kept_apart.NONE_YET), 0
    while apart._further(solution, stage) is not None:
        stage, count = apart._stage, count + 1
    assert pairs and count == 2


def test_a_free_plan_that_is_not_proved_does_not_replace_a_proved_one_that_overlaps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Otherwise the plan ends there, with other motions around the overlap untried."""
    phase = rt.Phase(rt.load("ur5"), 1.0, wrist(0.6), wrist(2.4), rt.Effort())
    through = rt.plan(phase.with_(self_collision=False))
    apart = KeptApart(rt.Problem([phase]), through.settings)
    assert apart.next_attempt(through, None) is not None and not apart.accepts(through)
    monkeypatch.setattr(apart, "_stage", None)
    assert through.proof is not None and apart.accepts(through)
    assert not apart.accepts(replace(through, proof=replace(through.proof, quadrature=1.0)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "last", "duration"),
    [
        ([-1.4, 0.79, -1.94, -1.47, 0.44, 0.75], [-0.94, -1.93, 0.38, 2.3, 0.37, -1.43], 2.443),
        ([0.05, 1.29, 1.42, 1.22, -1.44, 0.02], [2.38, 1.05, 1.36, 2.24, 1.07, 1.71], 1.977),
    ],
)
def test_no_rows_along_an_earlier_motion_hold_a_plan_back(
    first: list[float], last: list[float], duration: float
) -> None:
    """Rows along its own motion would have made these efforts 0.3 to 0.9 percent lower."""
    solution = rt.plan(rt.Phase(rt.load("ur5"), duration, rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Effort()))
    assert solution.proof.holds and not overlapping_times(solution)
    assert any("rows between links may cost" in each.lacked for each in solution.history.rounds)
    report = rt.validate(solution)
    assert report.passed and next(each for each in report.claims if each.name == "optimum").judgement.value == "holds"


@pytest.mark.slow
def test_an_arm_that_folds_deep_into_itself_keeps_spheres_apart() -> None:
    """From rows on the exact shapes alone, which bound distances near one motion, no plan of this reach was found."""
    first, last = [-0.57, 0.84, -1.42, -1.52, 1.38, 0.95, 0.99], [0.52, 1.24, 2.28, -0.72, 1.43, 0.37, 0.99]
    arm = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    phase = rt.Phase(arm, 2.7, rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Effort())
    solution = rt.plan(phase)
    assert solution.proof.holds and not overlapping_times(solution)
    assert "spheres around the links" in [each.response for each in solution.history.rounds]


def test_spheres_are_added_once_and_not_where_an_end_overlaps() -> None:
    phase = rt.Phase(rt.load("ur5"), 1.0, wrist(0.6), wrist(2.4), rt.Effort())
    problem = rt.Problem([phase])
    added = among_spheres(problem, [{0}])
    assert added is not None and added.phases[0].constraints[-1] == rt.CollisionFree(srdf=())
    assert among_spheres(added, [{0}]) is None and among_spheres(problem, [{}]) is None
    folded = rt.State(q=(0, -1.5, 2.8, 1.5, 0, 0), v=0)
    assert among_spheres(rt.Problem([phase.with_(start=folded, self_collision=False)]), [{0}]) is None
