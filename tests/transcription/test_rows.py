"""The rows are the scheme's equations, and every row and column has a name."""

from __future__ import annotations

import dataclasses
import gc
import weakref

import casadi as ca
import numpy as np
import pytest
from matplotlib.figure import Figure

import robotraj as rt
from tests.programs import nlp_of

PENDULUM = rt.System(
    ["q", "w"],
    ["u"],
    lambda point: [point.x["w"], point.u["u"] - ca.sin(point.x["q"])],
    units={"q": "rad", "w": "rad/s", "u": "N m"},
)


def phase_of(**more: object) -> rt.Phase:
    given = {
        "duration": 2.0,
        "start": rt.State([0, 0]),
        "end": rt.State([3, 0]),
        "objective": rt.Lagrange(lambda point: point.u["u"] ** 2 + point.t),
    }
    return rt.Phase(PENDULUM, **(given | more))


def rates(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    return np.stack([x[..., 1], u[..., 0] - np.sin(x[..., 0])], axis=-1)


def random_point(nlp: rt.transcription.Nlp) -> np.ndarray:
    return np.random.default_rng(3).normal(size=len(nlp.variables))


def test_rows_and_cost_are_those_of_the_trapezoidal_rule() -> None:
    nlp = nlp_of(rt.Problem([phase_of()]), rt.Mesh([0, 0.3, 1], rt.schemes.Trapezoidal()))
    w = random_point(nlp)
    layout = nlp.layouts[0]
    x = w[layout.knots]
    u = w[[layout.intervals[0].controls[0], layout.intervals[0].controls[1], layout.intervals[1].controls[1]]]
    h = np.array([0.6, 1.4])
    f = rates(x, u)
    expected = x[1:] - x[:-1] - h[:, None] / 2 * (f[:-1] + f[1:])
    np.testing.assert_allclose(nlp.values(w), expected.ravel(), atol=1e-14)
    cost = u[:, 0] ** 2 + np.array([0, 0.6, 2])
    assert nlp.objective(w) == pytest.approx(float(np.sum(h / 2 * (cost[:-1] + cost[1:]))), rel=1e-14)


def test_hermite_simpson_rows_and_cost_are_those_of_the_separated_form() -> None:
    """x_m = (x_0 + x_1)/2 + h/8 (f_0 - f_1) and x_1 = x_0 + h/6 (f_0 + 4 f_m + f_1) span the same rows."""
    nlp = nlp_of(rt.Problem([phase_of()]), rt.Mesh(1))
    w = random_point(nlp)
    interval = nlp.layouts[0].intervals[0]
    x, u = w[interval.states], w[interval.controls]
    f, h = rates(x, u), 2.0
    hermite = x[1] - (x[0] + x[2]) / 2 - h / 8 * (f[0] - f[2])
    simpson = x[2] - x[0] - h / 6 * (f[0] + 4 * f[1] + f[2])
    found = nlp.values(w).reshape(2, 2)
    np.testing.assert_allclose(found[1], simpson, atol=1e-14)
    np.testing.assert_allclose(found[0] - found[1] / 2, hermite, atol=1e-14)
    cost = u[:, 0] ** 2 + np.array([0, 1, 2])
    assert nlp.objective(w) == pytest.approx(h / 6 * (cost[0] + 4 * cost[1] + cost[2]), rel=1e-14)


def test_rows_and_columns_are_named_with_phase_meaning_and_time() -> None:
    speed = rt.PathConstraint(lambda point: point.x["w"] ** 2, upper=9, name="speed", unit="rad^2/s^2")
    phase = phase_of(constraints=[speed], duration=(1, 3), name="swing")
    nlp = rt.transcription.transcribe(
        rt.Problem([phase]), rt.Mesh(2, rt.schemes.Trapezoidal()), rt.guess.StraightLine(duration=2)
    )
    assert nlp.row_names == [
        *(f"swing: defect, {s}, t = {t} s" for t in (1, 2) for s in ("q", "w")),
        *(f"swing: speed, t = {t} s" for t in (0, 1, 2)),
    ]
    assert "swing: duration, t = 0 s" in nlp.variable_names
    assert "swing: control, u, t = 1 s" in nlp.variable_names
    assert len(nlp.variable_names) == len(set(nlp.variable_names)) == len(nlp.variables) == 3 * 2 + 3 + 1


def test_fixed_ends_and_bounds_of_single_variables_are_bounds_not_rows() -> None:
    phase = phase_of(states={"w": rt.between(-4, 4)}, controls={"u": rt.between(-1, 2)})
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(2))
    layout = nlp.layouts[0]
    assert {entry.name for entry in nlp.rows.entries} == {"defect"}
    np.testing.assert_array_equal(nlp.variables.lower[layout.knots[0]], [0, 0])
    np.testing.assert_array_equal(nlp.variables.upper[layout.knots[0]], [0, 0])
    np.testing.assert_array_equal(nlp.variables.upper[layout.knots[1]], [np.inf, 4])
    controls = np.concatenate([interval.controls.ravel() for interval in layout.intervals])
    np.testing.assert_array_equal(nlp.variables.lower[controls], -1)
    np.testing.assert_array_equal(nlp.variables.upper[controls], 2)


def test_one_end_is_bounded_alone() -> None:
    slow = rt.AtEnd(rt.PathConstraint(lambda point: point.x["w"], upper=0.5, name="slow"))
    nlp = nlp_of(rt.Problem([phase_of(end=None, constraints=[slow])]), rt.Mesh(3))
    names = [name for name in nlp.row_names if "slow" in name]
    assert names == ["phase: slow, t = 2 s"]


def test_a_phase_has_one_stage_on_every_mesh_that_frees_the_same_scalars() -> None:
    phase = phase_of()
    meshes = (rt.Mesh(3), rt.Mesh(8, rt.schemes.RadauIIA(3)), rt.schemes.MovingMesh(3), rt.schemes.MovingMesh(8))
    fixed, finer, moving, more = (nlp_of(rt.Problem([phase]), mesh).blocks[0].stage for mesh in meshes)
    assert fixed is finer
    assert moving is more is not fixed
    assert nlp_of(rt.Problem([phase_of()]), meshes[0]).blocks[0].stage is not fixed


def test_stages_are_freed_with_their_phase() -> None:
    phase = phase_of()
    stage = weakref.ref(nlp_of(rt.Problem([phase]), rt.Mesh(3)).blocks[0].stage)
    assert stage() is not None
    del phase
    gc.collect()
    assert stage() is None


def test_spy_draws_both_matrices(problems: dict) -> None:
    figure = nlp_of(*problems["two phases"]()).spy()
    assert isinstance(figure, Figure)
    titles = [axes.get_title() for axes in figure.axes]
    assert "Jacobian" in titles[0] and "Hessian" in titles[1]


@pytest.mark.parametrize("name", ["ode", "free duration", "dae", "ends", "cartpole"])
def test_scaling_does_not_change_the_answer(name: str, problems: dict) -> None:
    problem, mesh = problems[name]()
    nlp = nlp_of(problem, mesh)
    plain = dataclasses.replace(nlp, scale=np.ones_like(nlp.scale), row_scale=np.ones_like(nlp.row_scale))
    assert np.any(nlp.scale != 1) and np.any(nlp.row_scale != 1)
    scaled, unscaled = (rt.Ipopt(tolerance=1e-10).solve(each) for each in (nlp, plain))
    assert scaled.status is unscaled.status is rt.solvers.Status.SOLVED
    assert nlp.objective(scaled.w) == pytest.approx(plain.objective(unscaled.w), rel=1e-7)
    np.testing.assert_allclose(scaled.w, unscaled.w, atol=1e-4)


def test_physical_vectors_do_not_depend_on_the_scales(nlp: rt.transcription.Nlp) -> None:
    plain = dataclasses.replace(nlp, scale=np.ones_like(nlp.scale), row_scale=np.ones_like(nlp.row_scale))
    w = nlp.guess + 0.1
    np.testing.assert_allclose(nlp.values(w), plain.values(w), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(nlp.jacobian(w).toarray(), plain.jacobian(w).toarray(), rtol=1e-10, atol=1e-12)
    assert nlp.objective(w) == pytest.approx(plain.objective(w), rel=1e-12)


@pytest.mark.parametrize(
    "interval_limits", [rt.interval_limits.ConstraintGeneration(), rt.interval_limits.BernsteinBounds(controls=True)]
)
def test_the_guess_is_inside_all_bounds_that_hold_throughout(
    interval_limits: rt.interval_limits.ConstraintGeneration,
) -> None:
    """The straight line has controls of zero, where a reciprocal of the control is infinite."""
    phase = phase_of(controls={"u": rt.between(2.0, 3.0)}, states={"w": rt.between(-4.0, 1.2)})
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4), interval_limits=interval_limits)
    (layout,) = nlp.layouts
    for run in layout.runs:
        np.testing.assert_array_equal(nlp.guess[run.controls], 2.0)
        assert np.all(nlp.guess[run.states[..., 1]] <= 1.2)
