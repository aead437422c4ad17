"""Settings that are left open: solver and engine by problem, the table, repeated plans, files."""

from __future__ import annotations

import inspect
from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.setting_conditions import ALWAYS
from robotraj.planning.settings import RULES, SETTINGS, resolve, table
from robotraj.problem.objectives.base import Objective
from robotraj.solvers.base import Solver
from robotraj.solvers.stagewise.reduction import reduce
from tests.programs import nlp_of


def chain(states: int, controls: int, **options: object) -> rt.Problem:
    """Integrators in a row, the last driven by all the controls."""
    names = [f"x{i}" for i in range(states)]
    inputs = [f"u{i}" for i in range(controls)]
    system = rt.System(names, inputs, lambda p: [*(p.x[name] for name in names[1:]), sum(p.u[i] for i in inputs)])
    ends = {"start": rt.State([0] * states), "end": rt.State([1] + [0] * (states - 1))}
    return rt.Problem([rt.Phase(system, **({"duration": 1.0, "objective": rt.Effort()} | ends | options))])  # type: ignore[arg-type]


def solver_for(problem: rt.Problem, mesh: rt.Mesh | list[rt.Mesh]) -> Solver:
    return resolve(problem, {"mesh": mesh}).solver


def robot(name: str, **options: object) -> rt.Problem:
    return rt.Problem([rt.Phase(rt.load(name, **options), duration=1.0, objective=rt.Effort())])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "problem",
    [
        chain(2, 1),
        chain(3, 1),
        chain(2, 1, parameters={"m": rt.between(1, 2)}),
        chain(2, 1, constraints=[rt.constraints.IntegralConstraint(lambda p: p.x["x0"], upper=3.0)]),
        robot("ur5"),
        robot("cartpole"),
        robot("solo12", root="floating"),
    ],
    ids=["system", "few controls", "parameters", "integral", "arm", "few motors", "legs"],
)
def test_the_interior_point_method_is_the_default_for_all_kinds_of_problems(problem: rt.Problem) -> None:
    assert isinstance(solver_for(problem, rt.Mesh()), rt.InteriorPoint)


def test_corners_in_the_objective_are_for_ipopt() -> None:
    arm = rt.load("cartpole")
    for objective in (rt.objectives.AbsolutePower(), rt.objectives.AbsolutePower() + rt.objectives.TorqueRate()):
        assert isinstance(solver_for(rt.Problem([rt.Phase(arm, 1.0, objective=objective)]), rt.Mesh()), rt.Ipopt)


def test_narrow_stages_of_robots_take_bernstein_bounds_and_corners_do_not() -> None:
    arm = rt.load("cartpole")

    def chosen(objective: Objective) -> object:
        return resolve(rt.Problem([rt.Phase(arm, 1.0, objective=objective)]), {"mesh": rt.Mesh()}).interval_limits

    assert isinstance(chosen(rt.objectives.TorqueRate() + rt.Effort()), rt.interval_limits.BernsteinBounds)
    assert isinstance(chosen(rt.objectives.AbsolutePower()), rt.interval_limits.ConstraintGeneration)


def test_an_integral_over_an_arms_motion_widens_every_stage() -> None:
    arm = rt.load("cartpole")
    budget = rt.constraints.IntegralConstraint(lambda p: p.tau[0] ** 2, upper=100.0, name="heat")
    bounded = rt.Problem([rt.Phase(arm, 1.0, objective=rt.Duration(), constraints=[budget])])
    assert isinstance(resolve(bounded, {"mesh": rt.Mesh()}).interval_limits, rt.interval_limits.ConstraintGeneration)
    # Every later stage carries the value of the integral so far.
    carried = [reduce(nlp_of(bounded, rt.Mesh(n))).program.nx.max() for n in (5, 10)]
    assert carried[1] > 1.8 * carried[0]


def test_what_has_no_stages_is_for_ipopt() -> None:
    assert isinstance(solver_for(chain(2, 1), rt.Mesh(10, rt.schemes.MultipleShooting())), rt.Ipopt)
    assert isinstance(solver_for(chain(2, 1), [rt.schemes.MovingMesh(5)]), rt.Ipopt)


def test_a_system_reaches_the_optimum_of_its_mesh_and_keeps_nothing_from_its_bounds() -> None:
    """Bernstein bounds are stricter than the bounds; for systems rows are imposed where a plan violates them."""
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    phase = rt.Phase(
        system,
        duration=(0.1, 20.0),
        start=rt.State([0, 0]),
        end=rt.State([10, 0]),
        controls={"u": rt.between(-1, 1)},
        objective=rt.Duration(),
    )
    mesh = rt.Mesh(20, rt.HermiteSimpson(control=rt.schemes.ConstantControl()))
    plans = [rt.plan(phase, mesh, solver=solver) for solver in (None, rt.Ipopt())]
    assert plans[0].message.startswith("interior point")
    assert plans[0].objective == pytest.approx(plans[1].objective, rel=1e-6)
    assert plans[0].objective == pytest.approx(2 * float(ca.sqrt(10)), rel=1e-6)


@pytest.mark.parametrize(
    ("name", "root", "actuated", "solver", "engine"),
    [
        ("ur5", "fixed", None, rt.InteriorPoint(), rt.engines.Native()),
        ("double_pendulum", "fixed", [], rt.InteriorPoint(), rt.engines.Native()),
        ("solo12", "floating", None, rt.InteriorPoint(), rt.engines.Native()),
    ],
)
def test_the_robot_decides(name: str, root: str, actuated: list[str] | None, solver: object, engine: object) -> None:
    robot = rt.load(name, root=root) if actuated is None else rt.load(name, root=root, actuated=actuated)
    problem = rt.Problem([rt.Phase(robot, 1.0, limits=None)])
    settings = resolve(problem, {"mesh": rt.Mesh(5)})
    assert settings.solver == solver
    assert settings.engine == engine


def move(**changes: Any) -> rt.Phase:
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    ends = {"start": rt.State([0, 0]), "end": rt.State([1, 0])}
    force = {"u": rt.between(-8, 8)}
    return rt.Phase(block, **({"duration": 1.0, "objective": rt.Effort(), "controls": force} | ends | changes))


def test_the_table_of_the_docstring_is_the_one_the_rules_give() -> None:
    shown = inspect.cleandoc(rt.plan.__doc__ or "")
    assert table() in shown
    assert all(rule.setting in signature(rt.plan).parameters for rule in RULES)


def test_every_setting_that_may_not_be_none_ends_with_a_rule_that_always_holds() -> None:
    for name in set(SETTINGS) - {"tolerance", "goals", "refinement"}:
        rules = [rule for rule in RULES if rule.setting == name]
        assert [rule.conditions == (ALWAYS,) for rule in rules] == [False] * (len(rules) - 1) + [True]


def test_every_choice_is_printed_with_its_reason_within_80_columns() -> None:
    settings = rt.plan(move(), rt.Mesh(7), tolerance=1e-4).settings
    assert settings is not None
    lines = str(settings).splitlines()
    assert max(map(len, lines)) <= 80
    text = " ".join(" ".join(lines).split())
    assert "Mesh of 7 intervals, HermiteSimpson(): given" in text
    for name in ("solver", "engine", "interval_limits", "refinement", "restarts"):
        assert settings.reasons[name] in text and settings.reasons[name] != "given"


@pytest.mark.parametrize(
    "options",
    [{}, {"solver": rt.Ipopt()}, {"tolerance": 1e-6}, {"mesh": rt.Mesh(9, rt.schemes.Trapezoidal())}],
    ids=["default", "ipopt", "tolerance", "mesh"],
)
def test_settings_repeat_a_plan_bit_for_bit(options: dict[str, Any], tmp_path: Path) -> None:
    problem = rt.Problem([move(duration=(0.3, 5.0), objective=rt.Duration() + 0.01 * rt.Effort())])
    first = rt.plan(problem, **options)
    first.save(tmp_path / "first.npz")
    kept = rt.load_solution(tmp_path / "first.npz", problem).settings
    assert kept == first.settings
    again = rt.plan(problem, settings=kept)
    assert again.settings == first.settings
    assert again.objective == first.objective and again.iterations == first.iterations
    for one, other in zip(first.phases, again.phases, strict=True):
        times = one.t0 + one.duration * np.linspace(0, 1, 50)
        np.testing.assert_array_equal(one.trajectory.x(times), other.trajectory.x(times))


def test_an_option_replaces_one_of_the_earlier_settings_and_leaves_the_others() -> None:
    first = rt.plan(move(), tolerance=1e-4).settings
    assert first is not None
    second = rt.plan(move(), settings=first, solver=rt.Ipopt()).settings
    assert second is not None
    assert second.solver == rt.Ipopt() and second.reasons["solver"] == "given"
    assert (second.engine, second.mesh, second.tolerance) == (first.engine, first.mesh, first.tolerance)


def test_a_solver_that_is_no_plain_data_leaves_its_settings_out_of_the_file(tmp_path: Path) -> None:
    class Mine(Solver):
        def solve(self, *arguments: Any) -> Any:
            return rt.Ipopt().solve(*arguments)

    solution = rt.plan(move(), solver=Mine())
    solution.save(tmp_path / "mine.npz")
    assert rt.load_solution(tmp_path / "mine.npz", solution.problem).settings is None


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"settings": 3}, "settings= must be the settings of a solution"),
        ({"restarts": 3}, r"restarts= must be rt\.planning\.Restarts"),
        ({"refinement": rt.refinement.RaiseOrder(), "mesh": rt.Mesh(5)}, "give tolerance= or goals= as well"),
        ({"engine": "casadi"}, "engine= must be"),
    ],
)
def test_options_of_another_kind_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        rt.plan(move(), **options)


@pytest.mark.parametrize("options", [{"count": -1}, {"count": True}, {"longer": (0.0,)}, {"seeds": (-1,)}])
def test_restarts_refuse_what_they_cannot_do(options: dict[str, Any]) -> None:
    with pytest.raises(rt.InputError, match="Restarts"):
        rt.planning.Restarts(**options)


def test_restarts_are_off_with_contacts_and_may_be_asked_for() -> None:
    dog = rt.load("solo12", root="floating")
    phase = rt.Phase(dog, 1.0, limits=None, objective=rt.Effort(), contacts=[rt.PointContact("FL_FOOT")])
    problem = rt.Problem([phase])
    assert resolve(problem, {}).restarts == rt.planning.Restarts(0)
    assert resolve(problem, {"restarts": rt.planning.Restarts(1)}).restarts.count == 1


def test_restarts_of_count_0_leave_a_failed_plan_alone() -> None:
    never = move(duration=(0.1, 0.3), objective=rt.Duration())
    plans = [rt.plan(never, solver=rt.Ipopt(), check=False, restarts=rt.planning.Restarts(n)) for n in (0, 1, 5)]
    assert not any(plan.success for plan in plans)
    assert plans[1].iterations < plans[2].iterations
    assert all(plan.conflicts for plan in plans)


def test_a_mesh_replaces_the_goals_of_earlier_settings_and_their_refinement() -> None:
    proved = rt.plan(move())
    assert proved.settings.goals is not None and proved.settings.refinement is not None
    alone = rt.plan(move(), rt.Mesh(10), settings=proved.settings)
    assert alone.settings.goals is None and alone.settings.refinement is None and alone.proof is None
    assert rt.plan(move(), settings=proved.settings).objective == proved.objective


@pytest.mark.parametrize(
    ("objective", "obstacles", "count"),
    [
        (rt.Duration(), (), 28),
        (rt.Duration() + 1e-9 * rt.Effort(), (), 28),
        (rt.Duration() + 1e-3 * rt.Effort(), (), 19),
        (rt.Effort(), (), 16),
        (rt.Duration(), (rt.obstacles.Sphere(0.1, (0.5, 0.0, 0.5)),), 16),
    ],
)
def test_least_times_in_the_open_begin_on_more_intervals(
    objective: Objective, obstacles: tuple[rt.obstacles.Sphere, ...], count: int
) -> None:
    apart = [rt.CollisionFree(obstacles)] if obstacles else []
    phase = rt.Phase(rt.load("ur5"), (0.5, 5.0), objective=objective, constraints=apart)
    mesh = resolve(rt.Problem([phase]), {}).mesh
    assert isinstance(mesh, rt.Mesh) and mesh.count == count


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-3}])
def test_what_has_limited_rates_does_not_jump_at_the_knots(options: dict[str, float]) -> None:
    arm = rt.load("z1", locked={"jointGripper": 0.0})
    rest = np.array([0.0, 1.5, -1.0, -0.5, 0.0, 0.0])
    smooth = rt.constraints.JointJerk(rt.between(-400.0, 400.0))
    ends = {"start": rt.State(q=rest, v=0.0), "end": rt.State(q=rest + 0.2, v=0.0)}
    phase = rt.Phase(arm, 1.0, **ends, objective=rt.Effort(), constraints=[smooth])
    mesh = resolve(rt.Problem([phase]), dict(options)).mesh
    assert isinstance(mesh, rt.Mesh) and {type(scheme) for scheme in mesh.schemes} == {rt.HermiteSimpson}
    assert rt.plan(phase, mesh).success


def test_arms_with_dry_friction_in_a_closed_loop_are_planned_as_arms_alone() -> None:
    z1 = rt.load("z1", locked={"jointGripper": 0.0})
    pair = rt.robot.join({"left": z1, "right": z1}, at={"right": (0.0, -0.5, 0.0)})
    hands = rt.contacts.LoopClosure("left_link06", "right_link06", offset_b=(0.0, 0.5, 0.0))
    alone, joined = (
        resolve(rt.Problem([rt.Phase(pair, 2.0, objective=rt.Effort(), contacts=contacts)]), {})
        for contacts in ((), (hands,))
    )
    assert alone.mesh == joined.mesh
    assert alone.refinement == joined.refinement
    linkage = replace(rt.load("five_link", root="fixed", actuated=["left_hip"]), friction=np.full(4, 0.1))
    loop = rt.contacts.LoopClosure("left_foot", "right_foot")
    passive = rt.Problem([rt.Phase(linkage, 2.0, objective=rt.Effort(), contacts=[loop])])
    assert resolve(passive, {}).mesh != alone.mesh
