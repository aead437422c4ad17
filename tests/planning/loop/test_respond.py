"""What follows from what a solve lacks, as a table: nothing is solved here."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.teeth import SMOOTH
from robotraj.planning.loop.last_solves import MOST_MESHES
from robotraj.planning.loop.measures import Measured
from robotraj.planning.loop.respond import ENOUGH, ENOUGH_OF_POWERS, is_limited, respond
from robotraj.planning.loop.state import Found, PlanEnd, PlanState, Task, Traits, begin
from robotraj.planning.proving.soft_friction import factor_of, softened
from robotraj.planning.settings import resolve
from robotraj.solution.proof import Proof
from robotraj.solution.records import Lack
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.linear_controls import LINES

ENDLESS = rt.InteriorPoint.max_iterations

GOALS = rt.solution.Goals()
BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
PROBLEM = rt.Problem([rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort())])
COARSE, LINED = rt.Mesh(30), rt.Mesh(30, LINES)


@dataclass(frozen=True)
class Solved:
    """Of a solution, what a response reads."""

    mesh: rt.Mesh = COARSE
    objective: float = 1.0
    status: Status = Status.SOLVED
    iterations: int = 20
    seconds: float = 0.1
    conflicts: tuple[Any, ...] = ()
    proof: Proof | None = None
    multipliers: Any = field(default_factory=lambda: SimpleNamespace(origin=object()))
    refinement: tuple[Any, ...] = ()

    @property
    def success(self) -> bool:
        return self.status is Status.SOLVED

    @property
    def phases(self) -> tuple[Any, ...]:
        trajectory = SimpleNamespace(z=None, u=None, x=SimpleNamespace(breaks=np.array([0.0, 1.0])))
        phase = PROBLEM.phases[0].with_(objective=None)
        return (SimpleNamespace(mesh=self.mesh, phase=phase, trajectory=trajectory, exact=True, points=()),)

    def violations(self, *_: object) -> tuple[Any, ...]:
        return ()


def found(
    error: float = 0.0,
    excess: float = 0.0,
    unsettled: float = 0.0,
    before: Measured | None = None,
    limited: bool = False,
    early: bool = False,
    shortfall: float = 0.0,
    **solved: Any,
) -> Found:
    """Return a solve with these measures on one phase."""
    solution = Solved(**solved)
    if not solution.success:
        return Found(solution)  # type: ignore[arg-type]
    count = solution.mesh.count
    proof = Proof(error, excess, 0.0, unsettled, GOALS, shortfall=shortfall)
    local = (np.full(count, error),)
    measures = Measured(proof, 1.0, (solution.mesh,), local, before, local, (np.zeros(count),), 0.0, 2.0)
    return Found(solution, measures, limited, proof.lacks, early)  # type: ignore[arg-type]


def state(*earlier: Found, **changes: Any) -> PlanState:
    """Return the state after some solves, the last of which is the best."""
    first = begin(PROBLEM, None, resolve(PROBLEM, {}))
    known = {"best": earlier[-1].motion, "first": earlier[0].motion, "number": len(earlier)} if earlier else {}
    return replace(first, **(known | changes))


def failed(status: Status = Status.STALLED, **solved: Any) -> Found:
    return found(status=status, **solved)


ROUGH = found(error=1e-2, unsettled=np.inf)
EARLY = found(unsettled=1e-5, before=ROUGH.measures, early=True, mesh=rt.Mesh(90))
PROVED = replace(EARLY, stopped_early=False)
GAIN = Lack("objective gained on the first mesh", 5e-3, 1e-3)

MESHES = [
    ("a first mesh only approximates the motion", state(), found(), Task.MESH, 45),
    ("one through a shape between its points is left for the guess", state(), found(shortfall=0.1), Task.MESH, 45),
    ("one that touches a shape is a guess", state(), found(shortfall=0.01), Task.MESH, 45),
    ("an error far beyond its goal has the largest growth", state(), found(error=1.0, unsettled=1.0), Task.MESH, 120),
    ("an objective far from settled has a finer mesh", state(ROUGH), found(unsettled=1e-2), Task.MESH, 120),
    ("an objective near its goal has the least growth", state(ROUGH), found(unsettled=1.1e-3), Task.MESH, 48),
    ("a first mesh that fails has a finer one", state(), failed(), Task.MESH, 45),
    ("a later mesh that fails has lines", state(ROUGH, meshes=(COARSE,)), failed(), Task.MESH, LINED),
    (
        "a first mesh without end has lines",
        state(),
        failed(iterations=ENDLESS),
        Task.MESH,
        LINED,
    ),
    ("where lines fail, a motion that is none is dropped", state(ROUGH, meshes=(LINED,)), failed(), Task.MESH, 45),
    ("errors that stagnate have lines", state(ROUGH), found(1e-2, before=ROUGH.measures), Task.MESH, LINES),
    ("a motion that is proved ends a plan", state(ROUGH), PROVED, PlanEnd, ""),
    ("it is solved once more where the solver stopped early", state(ROUGH), EARLY, Task.AGAIN, 90),
    ("enough meshes end a motion", state(ROUGH, number=ENOUGH - 1), found(unsettled=1e-2), PlanEnd, "enough"),
    (
        "while its objective settles, a motion has more",
        state(ROUGH, number=ENOUGH - 1),
        found(unsettled=2e-3, before=found(unsettled=1e-2).measures),
        Task.MESH,
        64,
    ),
    (
        "powers of joints that stick have fewer",
        state(ROUGH, number=ENOUGH_OF_POWERS - 1, traits=Traits(True, True)),
        found(unsettled=1e-2),
        PlanEnd,
        "enough",
    ),
    (
        "patience has more",
        state(ROUGH, number=ENOUGH, traits=Traits(True)),
        found(unsettled=1e-2, before=ROUGH.measures),
        Task.MESH,
        120,
    ),
    ("no plan has more meshes", state(ROUGH, number=MOST_MESHES - 1), found(1e-2), Task.LIMITS, 30),
    ("with limits, the last mesh ends", state(ROUGH, number=MOST_MESHES - 1), found(1e-2, limited=True), PlanEnd, "8"),
    ("a brief plan ends where a solve fails", state(is_brief=True), failed(), PlanEnd, "stalled"),
    ("a limit of the user ends a plan", state(), failed(Status.TIME_LIMIT), PlanEnd, "time"),
    ("no plan begins afresh twice", state(meshes=(LINED,), number=2, afresh=True), failed(), PlanEnd, "stalled"),
]
LAST = [
    ("without a gain a plan ends", state(ROUGH, EARLY, task=Task.AGAIN), Found(Solved()), PlanEnd, ""),  # type: ignore[arg-type]
    (
        "a gain is solved on the meshes of the plan",
        state(ROUGH, EARLY, task=Task.AGAIN, meshes=(rt.Mesh(90),)),
        Found(Solved(objective=0.995), lacks=(GAIN,), gained=5e-3),  # type: ignore[arg-type]
        Task.BETTER,
        90,
    ),
    ("smoother controls come last but one", state(ROUGH, EARLY, task=Task.SMOOTHER), failed(), Task.AGAIN, 90),
]
TABLE = MESHES + LAST


@pytest.mark.parametrize(("before", "solve", "kind", "expected"), [r[1:] for r in TABLE], ids=[r[0] for r in TABLE])
def test_each_lack_has_one_response(before: PlanState, solve: Found, kind: Any, expected: Any) -> None:
    answer = respond(before, solve)
    if kind is PlanEnd:
        assert isinstance(answer, PlanEnd) and expected in answer.why
        return
    assert isinstance(answer, PlanState) and answer.task is kind
    (mesh,) = answer.meshes
    if isinstance(expected, rt.Mesh):
        assert mesh == expected
    elif expected is LINES:
        assert mesh.given == (LINES,)
    else:
        assert mesh.count == expected and mesh.given == COARSE.given


@pytest.mark.parametrize(
    ("before", "solve"), [(state(ROUGH, meshes=(LINED,)), failed()), (state(), found(shortfall=0.1))]
)
def test_a_plan_that_begins_afresh_has_no_motion_and_starts_from_its_guess(before: PlanState, solve: Found) -> None:
    answer = respond(before, solve)
    assert isinstance(answer, PlanState) and answer.afresh
    assert answer.best is None and answer.first is None and answer.begin is answer.guess


def test_the_gain_of_a_motion_that_is_not_found_remains_unsettled() -> None:
    coarse = Solved(objective=0.995)
    better = state(ROUGH, EARLY, task=Task.BETTER, start=coarse, gained=5e-3)
    lost = respond(better, failed())
    assert isinstance(lost, PlanEnd) and lost.solution.proof is not None and lost.solution.proof.unsettled == 5e-3
    same = respond(better, found(before=ROUGH.measures, objective=0.9999, mesh=rt.Mesh(90)))
    assert isinstance(same, PlanEnd) and same.state.best is better.best
    gained = respond(better, found(before=ROUGH.measures, objective=0.996, mesh=rt.Mesh(90)))
    assert isinstance(gained, PlanEnd) and gained.solution.objective == 0.996
    assert gained.solution.proof is not None and gained.solution.proof.unsettled == pytest.approx(1e-3)


def test_knots_at_switches_and_smoother_controls_replace_a_motion_only_where_they_are_no_worse() -> None:
    for task, rise in ((Task.SWITCHES, 0.0), (Task.SMOOTHER, 2e-3)):
        before = state(ROUGH, EARLY, task=task)
        answer = respond(before, found(before=ROUGH.measures, objective=1.0 + rise, mesh=rt.Mesh(91)))
        assert isinstance(answer, PlanState) and answer.best is before.best
    shorter = respond(
        state(ROUGH, EARLY, task=Task.SWITCHES), found(before=ROUGH.measures, objective=0.99, mesh=rt.Mesh(91))
    )
    assert isinstance(shorter, PlanEnd) and shorter.solution.objective == 0.99


def test_a_sum_far_from_its_integral_gets_gauss_rule_on_the_first_mesh() -> None:
    """The same motion is then the guess of a first mesh of as many points, once, and never of a later mesh."""
    arm = rt.Phase(rt.load("two_link_arm"), 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    problem = rt.Problem([arm])
    before = begin(problem, None, resolve(problem, {}))
    gauss = rt.schemes.GaussLegendre(3, joined=True)

    def missing(share: float, mesh: rt.Mesh) -> Found:
        solve = found(unsettled=np.inf, mesh=mesh)
        assert solve.measures is not None
        return replace(solve, measures=replace(solve.measures, proof=replace(solve.measures.proof, quadrature=share)))

    solve = missing(0.08, rt.Mesh(15))
    following = respond(before, solve)
    assert isinstance(following, PlanState)
    assert isinstance(following.guess, Solved) and following.guess.mesh == rt.Mesh(15)
    assert following.best is None and following.approximates
    assert [(mesh.count, mesh.given) for mesh in following.meshes] == [(10, (gauss,))]
    assert following.coarsest == following.meshes and len(following.steps) == 1
    for state_then, then in (
        (before, missing(0.04, rt.Mesh(15))),
        (following, missing(0.08, following.meshes[0])),
        (replace(before, number=1), missing(0.08, rt.Mesh(15))),
    ):
        later = respond(state_then, then)
        assert isinstance(later, PlanState)
        assert later.best is not None and later.number == state_then.number + 1
        assert later.meshes[0].given == then.solution.phases[0].mesh.given


def test_kinks_are_no_longer_rounded_where_the_goal_sees_it() -> None:
    sharp = rt.Problem(list(PROBLEM.phases))
    for rounded, problem in ((0.5 * GOALS.objective, PROBLEM), (2.0 * GOALS.objective, sharp)):
        solved = found(unsettled=1e-2, before=ROUGH.measures)
        assert solved.measures is not None
        solved = replace(solved, measures=replace(solved.measures, rounded=rounded))
        answer = respond(state(ROUGH, sharp=sharp), solved)
        assert isinstance(answer, PlanState) and answer.problem is problem
        assert (answer.meshes == (COARSE,)) is (problem is sharp)


def test_a_motion_beyond_its_limits_ends_as_not_proved() -> None:
    answer = respond(state(ROUGH, number=MOST_MESHES - 1), found(1e-2, limited=True))
    assert isinstance(answer, PlanEnd) and answer.solution.status is Status.NOT_PROVED


def test_softer_friction_becomes_less_soft_until_it_is_the_own_one() -> None:
    soft = replace(state(), traits=Traits(sticking=True), task=Task.SOFTER, softening=(4.0, 2.0))
    answer = respond(soft, found())
    assert isinstance(answer, PlanState) and (answer.task, answer.softening) == (Task.SOFTER, (2.0,))
    assert answer.meshes[0].count > COARSE.count and answer.begin is answer.guess is not None
    last = respond(answer, found(mesh=answer.meshes[0]))
    assert isinstance(last, PlanState) and (last.task, last.softening, last.number) == (Task.MESH, (), 0)
    unguessed = respond(soft, failed())
    assert isinstance(unguessed, PlanState) and unguessed.meshes == soft.meshes and unguessed.guess is None


@pytest.mark.parametrize("status", [Status.INFEASIBLE, Status.STALLED])
def test_softer_friction_ends_where_every_solve_from_a_soft_solution_fails(status: Status) -> None:
    """Smaller and smaller steps fail, too; then a robot has its own friction."""
    rough = replace(rt.load("pendulum"), friction=np.array([0.3]), friction_speed=0.01)
    swing = rt.Problem([rt.Phase(rough, 1.0, rt.State(q=0, v=0), rt.State(q=0.3, v=0), rt.Effort())])
    soft = rt.plan(softened(swing, 8.0, (0.0,)), mesh=rt.Mesh(5))
    assert factor_of(soft) == 8.0
    following: PlanState | PlanEnd = replace(state(), guess=soft, task=Task.SOFTER, softening=(2.0, 0.5))
    tried = []
    for _ in range(20):
        assert isinstance(following, PlanState)
        if following.task is not Task.SOFTER:
            break
        tried.append(following.softening[0])
        following = respond(following, failed(status))
    assert following.task is Task.MESH and following.guess is soft
    assert tried == sorted(set(tried)) and tried[0] == 2.0 and tried[-1] < 8.0


def test_limits_are_imposed_between_the_points_where_they_decide_or_the_plan_ends() -> None:
    assert not is_limited(state()) and not is_limited(state(ROUGH))
    assert is_limited(state(ROUGH, traits=Traits(True, True))) and not is_limited(state(traits=Traits(True, True)))
    assert is_limited(state(ROUGH, number=ENOUGH - 1)) and is_limited(state(ROUGH, task=Task.SMOOTHER))


def with_teeth(height: float, count: int) -> Found:
    """Return a proved motion whose controls have teeth on its second half."""
    solve = found(unsettled=1e-5, before=ROUGH.measures, mesh=rt.Mesh(count))
    assert solve.measures is not None
    errors = np.where(np.arange(count) < count // 2, 0.0, GOALS.error * height / SMOOTH)
    proof = replace(solve.measures.proof, roughness=height)
    measures = replace(solve.measures, proof=proof, errors=(errors,))
    return replace(solve, solution=replace(solve.solution, proof=proof), measures=measures)


def test_teeth_get_smoother_controls_first_and_then_intervals_where_they_are() -> None:
    """What a finer mesh has not made smoother, a third mesh does not either."""
    rough = with_teeth(0.05, 90)
    proved = state(ROUGH, rough)
    again = respond(proved, with_teeth(0.05, 90))
    assert isinstance(again, PlanState) and again.task is Task.SMOOTHER and again.meshes == (rt.Mesh(90),)
    finer = respond(again, failed())
    assert isinstance(finer, PlanState) and finer.task is Task.SMOOTHER and finer.number == again.number + 1
    knots = np.array(finer.meshes[0].knots)
    assert (knots <= 0.5).sum() == pytest.approx(46, abs=2) and (knots > 0.5).sum() > 60
    assert isinstance(respond(finer, failed()), PlanEnd)
