"""The stagewise interior-point method against IPOPT: the same optima, or a stated reason."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers import interior_point as module
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.solvers.formulation import formulate, options
from robotraj.transcription.nlp import Nlp
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import EVERY

MESH = rt.Mesh(8)
SAME = [name for name in EVERY if name != "step"]


@pytest.mark.parametrize(
    "interval_limits",
    [rt.interval_limits.ConstraintGeneration(rounds=0), rt.interval_limits.BernsteinBounds(rounds=0, controls=True)],
    ids=["plain", "hull"],
)
@pytest.mark.parametrize("name", SAME)
def test_it_finds_the_optimum_of_ipopt_and_its_multipliers_prove_it(
    name: str, interval_limits: rt.interval_limits.ConstraintGeneration
) -> None:
    staged, ipopt = (
        rt.plan(EVERY[name](), MESH, solver=solver, interval_limits=interval_limits, progress=False)
        for solver in (rt.InteriorPoint(fallback=None), rt.Ipopt())
    )
    assert "interior point" in staged.message
    assert staged.objective == pytest.approx(ipopt.objective, rel=1e-6)
    assert not staged.violations()
    # Stationarity and signs, in scaled units, of the multipliers of eliminated rows.
    known = staged.multipliers
    assert known is not None and known.origin is not None
    nlp, w = known.origin.nlp, known.origin.w
    rows, bounds = known.rows / nlp.row_scale, known.bounds * nlp.scale
    gradient = nlp.scale * (nlp.gradient(w) + nlp.jacobian(w).T @ known.rows + known.bounds)
    size = max(1.0, np.abs(rows).max(), np.abs(bounds).max())
    np.testing.assert_allclose(gradient, 0.0, atol=1e-6 * size)
    values = nlp.values(w) * nlp.row_scale
    sides = (
        (rows, values, nlp.rows.lower * nlp.row_scale, nlp.rows.upper * nlp.row_scale),
        (bounds, w / nlp.scale, nlp.variables.lower / nlp.scale, nlp.variables.upper / nlp.scale),
    )
    for multipliers, value, lower, upper in sides:
        inside = lower < upper
        pushes_up, pushes_down = multipliers < -1e-3 * size, multipliers > 1e-3 * size
        assert np.all(value[inside & pushes_up] < lower[inside & pushes_up] + 1e-4)
        assert np.all(value[inside & pushes_down] > upper[inside & pushes_down] - 1e-4)


@pytest.mark.parametrize(("duration", "intervals"), [(1.6, 40), (2.2, 30)])
def test_the_acrobot_swings_up_as_with_ipopt(duration: float, intervals: int) -> None:
    """From the straight line to one of its many optima; with torques eliminated it took others."""
    robot = rt.load("acrobot")
    ends = {"start": rt.State(q=[0, 0], v=0), "end": rt.State(q=[np.pi, 0], v=0)}
    phase = rt.Phase(robot, duration=duration, objective=rt.Effort(), limits=None, **ends)  # type: ignore[arg-type]
    staged, ipopt = (
        rt.plan(
            phase,
            rt.Mesh(intervals),
            solver=solver,
            interval_limits=rt.interval_limits.ConstraintGeneration(),
            progress=False,
        )
        for solver in (rt.InteriorPoint(fallback=None), rt.Ipopt())
    )
    assert staged.success
    assert staged.objective == pytest.approx(ipopt.objective, rel=1e-6)


def test_a_contact_and_a_mirror_are_solved() -> None:
    from tests.gait.test_five_link import guess

    problem = EVERY["step"]()
    solution = rt.plan(
        problem,
        rt.Mesh(6),
        guess=guess(problem.phases[0].robot),
        solver=rt.InteriorPoint(fallback=None),
        interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0),
        progress=False,
    )
    assert solution.objective == pytest.approx(469.547244, abs=2e-6)


def test_shooting_finds_the_optimum_of_ipopt() -> None:
    shooting = rt.Mesh(10, rt.schemes.MultipleShooting())
    ours, ipopt = (
        rt.plan(EVERY["pendulum"](), shooting, solver=solver, progress=False)
        for solver in (rt.InteriorPoint(fallback=None), rt.Ipopt())
    )
    assert "interior point" in ours.message
    assert ours.objective == pytest.approx(ipopt.objective, rel=1e-6)


def test_the_other_solver_is_not_asked_whether_a_plan_is_impossible() -> None:
    (phase,) = EVERY["arm"]().phases
    weak = phase.with_(limits=phase.robot.limits.with_(effort=5.0))
    other = Recorded()
    solution = rt.plan(weak, rt.Mesh(5), solver=rt.InteriorPoint(fallback=other), check=False, progress=False)
    assert solution.status is rt.solvers.Status.NOT_FOUND and not other.seconds
    assert solution.violations()


def overdetermined() -> rt.Phase:
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    rows = [
        rt.PathConstraint(lambda p: p.x["x"] + p.x["v"] ** 2, lower=1, upper=1),
        rt.PathConstraint(lambda p: p.x["v"] + p.u["u"], lower=1, upper=1),
        rt.PathConstraint(lambda p: p.x["x"] * p.u["u"] + p.x["v"] ** 3, lower=1, upper=1),
    ]
    return rt.Phase(block, 1.0, constraints=rows)


@pytest.mark.parametrize("fallback", [None, rt.Ipopt()], ids=["alone", "with ipopt"])
def test_more_equations_than_unknowns_have_a_status(fallback: rt.Ipopt | None) -> None:
    solution = rt.plan(overdetermined(), rt.Mesh(5), solver=rt.InteriorPoint(fallback=fallback), check=False)
    assert solution.status is rt.solvers.Status.OVERDETERMINED
    assert "equations for" in solution.message
    assert solution.iterations == 0


def test_plans_in_threads_may_start_from_the_same_solution() -> None:
    (phase,) = EVERY["arm"]().phases
    known = rt.plan(phase, MESH, solver=rt.InteriorPoint(threads=1), progress=False)
    ends = [rt.State(q=np.add(phase.end.q, 0.02 * i), v=0) for i in range(12)]

    def plan(end: rt.State) -> float:
        solver = rt.InteriorPoint(threads=1, fallback=None)
        return rt.plan(phase.with_(end=end), MESH, guess=known, solver=solver, progress=False).objective

    alone = [plan(end) for end in ends]
    for _ in range(4):
        with ThreadPoolExecutor(4) as threads:
            together = list(threads.map(plan, ends))
        np.testing.assert_allclose(together, alone, rtol=1e-6)


@pytest.mark.parametrize(
    "engine", [rt.engines.Native(), rt.engines.VirtualMachine()], ids=["native", "virtual machine"]
)
def test_the_parts_of_a_solve_do_not_overlap(engine: rt.engines.Native | rt.engines.VirtualMachine) -> None:
    times = rt.plan(
        EVERY["arm"](), rt.Mesh(30), solver=rt.InteriorPoint(threads=1), engine=engine, progress=False
    ).times
    parts = [times[f"solve: {name}"] for name in ("functions", "combinations", "linear algebra")]
    # Vectors and the line search take their time as well.
    assert sum(parts) < times["solve"]
    assert sum(parts) + times["solve: steps"] == pytest.approx(times["solve"], rel=1e-9)


@dataclass(frozen=True)
class Recorded(Solver):
    """IPOPT, which keeps the seconds that it is given."""

    seconds: list[float] = field(default_factory=list)

    def within(self, seconds: float) -> Recorded:
        self.seconds.append(seconds)
        return self

    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        return rt.Ipopt(max_iterations=1).solve(nlp, progress, multipliers)


def test_another_solver_gets_the_time_that_is_left() -> None:
    other = Recorded()
    solver = rt.InteriorPoint(time_limit=50.0, fallback=other)
    solution = rt.plan(overdetermined(), rt.Mesh(5), solver=solver, check=False, progress=False)
    assert "by Recorded" in solution.message
    assert all(0 < seconds < 50 for seconds in other.seconds) and other.seconds
    assert rt.Ipopt(time_limit=2.0).within(3.0).time_limit == 2.0
    assert rt.InteriorPoint().within(3.0).time_limit == 3.0


def test_limits_of_iterations_and_time_keep_the_last_iterate() -> None:
    few = rt.plan(EVERY["arm"](), MESH, solver=rt.InteriorPoint(max_iterations=3), check=False, progress=False)
    assert few.status is rt.solvers.Status.ITERATION_LIMIT and few.iterations == 3
    assert np.all(np.isfinite(few.at(0.5).q))
    none = rt.plan(EVERY["arm"](), MESH, solver=rt.InteriorPoint(time_limit=1e-6), check=False, progress=False)
    assert none.status is rt.solvers.Status.TIME_LIMIT


def test_as_many_iterations_as_a_solve_takes_are_enough() -> None:
    def plan(iterations: int) -> rt.Solution:
        solver = rt.InteriorPoint(max_iterations=iterations, fallback=None)
        return rt.plan(
            EVERY["arm"](),
            MESH,
            solver=solver,
            interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0),
            check=False,
            progress=False,
        )

    needed = plan(1000)
    assert needed.success
    assert (again := plan(needed.iterations)).success and again.iterations == needed.iterations
    short = plan(needed.iterations - 1)
    assert short.status is rt.solvers.Status.ITERATION_LIMIT and short.iterations == needed.iterations - 1
    assert plan(1).status is rt.solvers.Status.ITERATION_LIMIT and plan(1).iterations <= 1


def test_a_solve_that_begins_again_takes_no_more_iterations_in_all(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    class Stalls:
        """Stops at its seventh iteration, or at its limit."""

        def __init__(self, native: Any) -> None:
            self.native = native

        def solve(self, start: Any, lower: Any, upper: Any, options: Any, **more: Any) -> Any:
            asked.append(options.max_iterations)
            options.max_iterations = min(7, options.max_iterations)
            found = self.native.solve(start, lower, upper, options, **more)
            return SimpleNamespace(
                **{name: getattr(found, name) for name in ("iterations", "times", "y", "lam", "message")},
                status="line search failed" if found.iterations == 7 else found.status,
            )

    make = module.native_program
    monkeypatch.setattr(module, "native_program", lambda *given: Stalls(make(*given)))
    monkeypatch.setattr(module, "of_program", lambda *given: 1.0)
    problem = EVERY["arm"]()
    nlp = nlp_of(problem if isinstance(problem, rt.Problem) else rt.Problem([problem]), MESH)
    few, more = (rt.InteriorPoint(max_iterations=n, fallback=None).solve(nlp) for n in (7, 10))
    assert few.iterations == 7 and few.status is rt.solvers.Status.STALLED
    assert more.iterations == 10 and more.status is rt.solvers.Status.ITERATION_LIMIT
    assert asked == [7, 10, 3]


def test_legs_start_from_a_small_barrier_with_zero_multipliers(monkeypatch: pytest.MonkeyPatch) -> None:
    begun = []

    class Seen:
        """Records the call of the method."""

        def __init__(self, native: Any) -> None:
            self.native = native

        def __getattr__(self, name: str) -> Any:
            return getattr(self.native, name)

        def solve(self, start: Any, lower: Any, upper: Any, options: Any, **more: Any) -> Any:
            begun.append((options.initial_barrier, "lam" in more and not np.any(more["lam"])))
            return self.native.solve(start, lower, upper, options, **more)

    make = module.native_program
    monkeypatch.setattr(module, "native_program", lambda *given: Seen(make(*given)))
    trot = rt.gait.trot(rt.load("solo12", root="floating"), step_length=0.05, duration=0.2, clearance=0.03)
    for barrier in (None, 1e-3):
        solver = rt.InteriorPoint(fallback=None, max_iterations=1, initial_barrier=barrier)
        solver.solve(nlp_of(trot, rt.Mesh(2)))
    assert begun == [(1e-4, True), (1e-3, False)]


@pytest.mark.parametrize(
    ("name", "patience", "expected"),
    [
        ("arm", "PATIENCE_STAGES", [(0.01, 1.0, 5), (1.0, 100.0, 195)]),
        ("step", "PATIENCE_ASSEMBLED", [(0.01, 1.0, 5), (1.0, 100.0, 6), (1.0, 0.1, 189)]),
    ],
)
def test_a_long_solve_begins_again_with_a_larger_barrier_and_other_weights(
    monkeypatch: pytest.MonkeyPatch, name: str, patience: str, expected: list[tuple[float, float, int]]
) -> None:
    asked = []

    class Seen:
        """Records the calls of the method."""

        def __init__(self, native: Any) -> None:
            self.native = native

        def solve(self, start: Any, lower: Any, upper: Any, options: Any, **more: Any) -> Any:
            asked.append((options.initial_barrier, more["objective_scale"], options.max_iterations))
            return self.native.solve(start, lower, upper, options, **more)

    make = module.native_program
    monkeypatch.setattr(module, "native_program", lambda *given: Seen(make(*given)))
    monkeypatch.setattr(module, "of_program", lambda *given: 1.0)
    problem = EVERY[name]()
    nlp = nlp_of(problem if isinstance(problem, rt.Problem) else rt.Problem([problem]), MESH)
    solver = rt.InteriorPoint(fallback=None, max_iterations=200)
    before, known = getattr(module, patience), solver.solve(nlp)
    monkeypatch.setattr(module, patience, (5, 6)[: len(before)])
    found = solver.solve(nlp)
    assert asked == [(0.01, 1.0, min(200, before[0])), *expected]
    assert known.iterations > 5 and found.status is rt.solvers.Status.SOLVED
    assert nlp.objective(found.w) == pytest.approx(nlp.objective(known.w), rel=1e-6)
    few = rt.InteriorPoint(fallback=None, max_iterations=7).solve(nlp)
    assert few.status is rt.solvers.Status.ITERATION_LIMIT and few.iterations == 7


@pytest.mark.parametrize("part", range(3))
def test_a_turning_trot_does_not_wander(part: int) -> None:
    # Changes of round-off decided between 72 iterations and none of 1,000 that solves it.
    limits = {"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7}
    robot = rt.load("solo12", root="floating", limits=limits)
    turn = {"q.root_qz": 0.1 * (1 + part * 1e-9), "q.root_qw": None, "q.root_x": None, "q.root_y": None}
    contact = partial(rt.PointContact, friction=0.6)
    repeat = rt.Periodic(displacement=turn)
    trot = rt.gait.trot(robot, step_length=0.0, duration=0.2, contact=contact, repeat=repeat)
    outcome = rt.InteriorPoint(fallback=None).solve(nlp_of(trot, rt.Mesh(5, rt.schemes.LobattoIIIA(4))))
    assert outcome.status is rt.solvers.Status.SOLVED and outcome.iterations < 400


@pytest.mark.parametrize(
    "objective",
    [
        rt.Mayer(lambda start, end: -end.x["v"]),
        1e-3 * rt.Mayer(lambda start, end: -end.x["v"]),
        rt.Lagrange(lambda point: -(point.u["u"] ** 2)),
    ],
    ids=["stalls", "meets the limit", "stalls at a square"],
)
def test_what_runs_off_is_diverged_and_is_not_handed_on(objective: rt.objectives.Objective) -> None:
    push = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    phase = rt.Phase(push, 1.0, rt.State([0, 0]), rt.State([1, None]), objective)
    solution = rt.plan(phase, solver=rt.InteriorPoint(), check=False, progress=False)
    assert solution.status is rt.solvers.Status.DIVERGED
    assert "Ipopt" not in solution.message and "Bound the states and controls" in str(solution)
    assert np.all(np.isfinite(solution.at(0.5).x["v"]))


def test_multipliers_converge_where_steps_are_near_rounding() -> None:
    system = rt.System(["q", "w"], ["u"], lambda p: [p.x["w"], p.u["u"] - 9.81 * ca.sin(p.x["q"])])
    phase = rt.Phase(system, 1.5, rt.State([0, 0]), rt.State([np.pi, 0]), rt.Effort())
    mesh = rt.Mesh(6, rt.schemes.Trapezoidal())
    solution = rt.plan(phase, mesh, solver=rt.InteriorPoint(fallback=None), progress=False)
    assert solution.iterations < 20
    assert solution.objective == pytest.approx(rt.plan(phase, mesh, solver=rt.Ipopt()).objective, rel=1e-8)


def test_an_objective_that_is_no_number_is_not_solved() -> None:
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    cost = rt.Lagrange(lambda p: ca.log(p.x["x"] - 5))
    ends, controls = (rt.State([0, 0]), rt.State([0, 0])), {"u": rt.between(-1, 1)}
    phase = rt.Phase(block, 2.0, *ends, cost, controls=controls)
    solution = rt.plan(phase, rt.Mesh(10), solver=rt.InteriorPoint(fallback=None), check=False, progress=False)
    assert solution.status is rt.solvers.Status.INVALID_NUMBER


def test_fine_meshes_of_robots_without_all_motors_are_solved_as_a_whole() -> None:
    """One motor brings four states to their end: the recursion over 640 stages loses its digits there."""
    robot = rt.load("acrobot")
    phase = rt.Phase(robot, 2.0, rt.State(q=0, v=0), rt.State(q=[np.pi, 0], v=0), rt.Effort())
    coarse = rt.plan(phase, rt.Mesh(100))
    fine = rt.plan(phase, rt.Mesh(640), guess=coarse, solver=rt.InteriorPoint(fallback=None))
    assert fine.objective == pytest.approx(coarse.objective, rel=1e-4)


def test_robots_alone_have_the_finer_corrections_of_inertia() -> None:
    slide = rt.System(["x", "v"], ["force"], lambda p: [p.x["v"], p.u["force"]])
    moved = rt.Phase(slide, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Lagrange(lambda p: p.u["force"] ** 2))
    reach = rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    of_system, of_robot = (options(formulate(nlp_of(rt.Problem([phase]), MESH))) for phase in (moved, reach))
    assert "first_correction" not in of_system
    assert of_robot["first_correction"] < 1e-4


def test_only_a_guess_on_its_feet_lets_the_barrier_fall_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """From an earlier solution it would fall to the end at once, and the solve takes more iterations."""
    factors: list[float] = []
    plain = rt.InteriorPoint._options

    def recorded(self: rt.InteriorPoint, barrier: float, factor: float, *rest: Any) -> Any:
        factors.append(factor)
        return plain(self, barrier, factor, *rest)

    monkeypatch.setattr(rt.InteriorPoint, "_options", recorded)
    robot = rt.load("solo12", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
    steps = [rt.gait.trot(robot, step_length=length, duration=0.2, clearance=0.04) for length in (0.07, 0.08)]
    mesh, once = rt.Mesh(4), rt.interval_limits.ConstraintGeneration(rounds=0)
    chained = rt.sweep(steps, chain=True, mesh=mesh, solver=rt.InteriorPoint(threads=1), interval_limits=once)
    assert all(solution.success for solution in chained)
    steep = rt.InteriorPoint(threads=1, barrier_factor=50.0)
    rt.plan(steps[0], mesh, solver=steep, interval_limits=once, progress=False)
    rt.plan(EVERY["block"](), MESH, progress=False)
    assert factors == [3000.0, 100.0, 50.0, 100.0]
