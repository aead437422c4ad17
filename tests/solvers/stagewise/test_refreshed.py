"""A reduction refreshed for other bounds and constants equals the one made anew."""

from __future__ import annotations

from dataclasses import fields, replace

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.native import Csr, Stacked
from robotraj.solvers.stagewise.native import native_program, refresh
from robotraj.solvers.stagewise.reduction import Reduction, reduce
from robotraj.transcription.nlp import Nlp
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import EVERY

MESH = rt.Mesh(4, rt.HermiteSimpson())


def moved(nlp: Nlp, seed: int = 1) -> Nlp:
    """Other fixed values, bounds and guess; what is open, fixed or limited stays so."""
    rng = np.random.default_rng(seed)
    shift = 0.1 * rng.standard_normal(len(nlp.variables))
    variables = replace(nlp.variables, lower=nlp.variables.lower + shift, upper=nlp.variables.upper + shift)
    # Defects stay zero; what has two different bounds moves.
    apart = nlp.rows.lower < nlp.rows.upper
    rows = replace(nlp.rows, upper=np.where(apart, nlp.rows.upper + 0.1, nlp.rows.upper))
    return replace(nlp, variables=variables, rows=rows, guess=nlp.guess + 0.01)


def assert_same(found: object, wanted: object, name: str = "") -> None:
    """Compare everything that is an array or holds some."""
    if isinstance(wanted, Csr):
        for part in ("starts", "indices", "data"):
            np.testing.assert_array_equal(getattr(found, part), getattr(wanted, part), err_msg=f"{name}.{part}")
    elif isinstance(wanted, Stacked):
        x = np.random.default_rng(0).standard_normal(wanted.columns)
        for part in ("rows", "columns", "entries", "kept"):
            assert getattr(found, part) == getattr(wanted, part), f"{name}.{part}"
        np.testing.assert_array_equal(found @ x, wanted @ x, err_msg=name)  # type: ignore[operator]
    elif isinstance(wanted, tuple):
        assert len(found) == len(wanted)  # type: ignore[arg-type]
        for number, (mine, its) in enumerate(zip(found, wanted, strict=True)):  # type: ignore[call-overload]
            assert_same(mine, its, f"{name}[{number}]")
    elif isinstance(wanted, np.ndarray | float):
        np.testing.assert_array_equal(found, wanted, err_msg=name)  # type: ignore[arg-type]
    elif hasattr(wanted, "indptr"):
        for part in ("indptr", "indices", "data"):
            assert_same(getattr(found, part), getattr(wanted, part), f"{name}.{part}")
    elif hasattr(wanted, "__dataclass_fields__") and not isinstance(wanted, Nlp):
        for field in fields(wanted):  # type: ignore[arg-type]
            assert_same(getattr(found, field.name), getattr(wanted, field.name), f"{name}.{field.name}")


def speed_limits_scale(problem: str) -> bool:
    """Where a duration is free, speed limits are coefficients of it."""
    return problem in ("hurried arm", "smooth arm", "jerky arm", "arm by way", "acrobot", "step", "robot block")


@pytest.mark.parametrize("problem", [p for p in EVERY if not speed_limits_scale(p)])
def test_a_refreshed_reduction_is_the_one_made_anew(problem: str) -> None:
    nlp = nlp_of(EVERY[problem](), MESH)
    first = reduce(nlp)
    other = moved(nlp)
    refreshed = first.refreshed(other)
    assert refreshed is not None
    assert_same(refreshed, reduce(other))
    assert all(
        mine.jacobian is its.jacobian and mine.hessian is its.hessian
        for mine, its in zip(refreshed.program.blocks, first.program.blocks, strict=True)
    )


def test_a_refreshed_program_gives_the_numbers_of_one_made_anew() -> None:
    nlp = nlp_of(EVERY["arm"](), MESH)
    first, other = reduce(nlp), moved(nlp)
    native = native_program(first.program, nlp.engine, 1)
    refreshed = first.refreshed(other)
    assert isinstance(refreshed, Reduction)
    y = np.random.default_rng(0).standard_normal(first.slots.variables.size)
    before = native.rows(y)
    refresh(native, refreshed.program)
    anew = native_program(reduce(other).program, nlp.engine, 1)
    np.testing.assert_array_equal(native.rows(y), anew.rows(y))
    assert native.objective(y) == anew.objective(y)
    np.testing.assert_array_equal(native.jacobian(y), anew.jacobian(y))
    assert not np.array_equal(native.rows(y), before)


def with_constants(nlp: Nlp, row: int, by: float) -> Nlp:
    """Move one of the constants tau, t0 and T that every place has."""
    blocks = tuple(
        replace(b, constants=b.constants + by * (np.arange(b.constants.shape[0]) == row)[:, None]) for b in nlp.blocks
    )
    return replace(nlp, blocks=blocks)


def test_constants_of_curved_functions_are_refreshed_and_coefficients_are_not() -> None:
    system = rt.System(
        states=["angle", "rate"],
        controls=["torque"],
        dynamics=lambda p: [p.x["rate"], p.u["torque"] - ca.sin(p.x["angle"] + p.t)],
    )
    phase = rt.Phase(
        system,
        duration=2.0,
        start=rt.State({"angle": 0, "rate": 0}),
        end=rt.State({"angle": 1, "rate": 0}),
        objective=rt.Lagrange(lambda p: p.u["torque"] ** 2),
    )
    nlp = nlp_of(rt.Problem([phase]), MESH)
    first = reduce(nlp)
    later = with_constants(nlp, 1, 0.3)
    refreshed = first.refreshed(later)
    assert refreshed is not None
    assert_same(refreshed, reduce(later))
    assert not np.array_equal(refreshed.program.blocks[0].block.constants, first.program.blocks[0].block.constants)
    assert first.refreshed(with_constants(nlp, 2, 0.3)) is None


def loosened(nlp: Nlp) -> Nlp:
    """Free one fixed column."""
    upper = nlp.variables.upper.copy()
    upper[np.flatnonzero(nlp.variables.lower == upper)[0]] += 1.0
    return replace(nlp, variables=replace(nlp.variables, upper=upper))


def limited(nlp: Nlp) -> Nlp:
    """Add a bound to one unbounded column."""
    upper = nlp.variables.upper.copy()
    upper[np.flatnonzero(np.isinf(upper))[0]] = 100.0
    return replace(nlp, variables=replace(nlp.variables, upper=upper))


def rescaled(nlp: Nlp) -> Nlp:
    """Other units."""
    return replace(nlp, scale=2.0 * nlp.scale)


@pytest.mark.parametrize("change", [loosened, limited, rescaled])
def test_another_structure_is_not_refreshed(change: object) -> None:
    nlp = nlp_of(EVERY["pendulum"](), MESH)
    assert reduce(nlp).refreshed(change(nlp)) is None  # type: ignore[operator]


def test_another_mesh_or_problem_is_not_refreshed() -> None:
    first = reduce(nlp_of(EVERY["pendulum"](), MESH))
    assert first.refreshed(nlp_of(EVERY["pendulum"](), rt.Mesh(5, rt.HermiteSimpson()))) is None
    assert first.refreshed(nlp_of(EVERY["block"](), MESH)) is None


def test_speed_limits_of_a_free_duration_are_coefficients() -> None:
    nlp = nlp_of(EVERY["hurried arm"](), MESH)
    assert reduce(nlp).refreshed(moved(nlp)) is None
    same = reduce(nlp).refreshed(replace(nlp, guess=nlp.guess.copy()))
    assert same is not None


def another_goal(nlp: Nlp, duration: float) -> Nlp:
    """Other fixed positions, velocities still zero, and a guess of ``duration`` times its own."""
    fixed = (nlp.variables.lower == nlp.variables.upper) & (nlp.variables.lower != 0)
    variables = replace(
        nlp.variables, lower=nlp.variables.lower + 0.01 * fixed, upper=nlp.variables.upper + 0.01 * fixed
    )
    guess = nlp.guess.copy()
    guess[nlp.layouts[0].duration.column] *= duration
    return replace(nlp, variables=variables, guess=guess)


@pytest.mark.parametrize("problem", ["hurried arm", "acrobot"])
def test_a_free_duration_keeps_its_unit_near_the_first_guess(problem: str) -> None:
    """A plan to another goal begins at the last one, whose duration is not the first guess's."""
    nlp = nlp_of(EVERY[problem](), MESH)
    first, other = reduce(nlp), another_goal(nlp, 0.8)
    refreshed, anew = first.refreshed(other), reduce(other)
    assert refreshed is not None
    w = np.abs(other.guess) + 0.01 * np.random.default_rng(2).random(len(other.guess))
    values = []
    for reduction in (refreshed, anew):
        program = native_program(reduction.program, other.engine, 1)
        y = reduction.start(w)
        found = reduction.columns(y)
        values.append((found, program.objective(y)))
    np.testing.assert_allclose(values[0][0], values[1][0], rtol=1e-9, atol=1e-9)
    assert values[0][1] == pytest.approx(values[1][1], rel=1e-9)
    assert first.refreshed(another_goal(nlp, 3.0)) is None


def test_a_minimum_time_plan_to_another_goal_from_the_last_one_ends_where_a_fresh_one_does() -> None:
    (phase,) = EVERY["hurried arm"]().phases
    problem, solver, mesh = rt.Problem([phase]), rt.InteriorPoint(threads=1), rt.Mesh(10)
    first = rt.plan(problem, mesh, solver=solver, check=False)
    goal = np.asarray(phase.end.q) - 0.05
    moved_goal = problem.with_(end=rt.State(q=goal, v=0))
    again = rt.plan(moved_goal, mesh, first, solver=solver, check=False)
    anew = rt.plan(moved_goal, mesh, solver=solver, check=False)
    assert again.objective == pytest.approx(anew.objective, rel=1e-6)
    assert again.iterations < anew.iterations
