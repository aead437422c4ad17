"""Bounds imposed on Bernstein coefficients hold between the collocation points, for states and controls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BPoly

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis
from robotraj.fixed_mesh.between.nlp_violations import violations
from robotraj.solvers.base import Solver
from robotraj.transcription.interval_limits.bernstein_bounds import are_coefficients, coefficients, control_weights
from robotraj.transcription.schemes.collocation import Scheme
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import block, hurried_arm
from tests.transcription.assembly.test_derivatives import assert_close, differences, somewhere

SCHEMES: dict[str, Scheme] = {
    "Hermite-Simpson": rt.HermiteSimpson(),
    "fifth degree": rt.schemes.FifthDegree(),
    "Lobatto 5": rt.schemes.LobattoIIIA(5),
    "Radau 2": rt.schemes.RadauIIA(2),
    "Radau 4": rt.schemes.RadauIIA(4),
    "Gauss 1": rt.schemes.GaussLegendre(1),
    "Gauss 2": rt.schemes.GaussLegendre(2),
    "Gauss 3": rt.schemes.GaussLegendre(3),
}
LOWER, UPPER = -1.0, 0.6
HULL = rt.interval_limits.BernsteinBounds(controls=True)


def drive(**more: Any) -> rt.Problem:
    """Minimum time of a block with drag and a speed limit, whose force has other limits forward than back."""
    system = rt.System(
        states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"] - 0.2 * point.x["v"] ** 2]
    )
    given = {
        "duration": (0.5, 20.0),
        "start": rt.State({"x": 0, "v": 0}),
        "end": rt.State({"x": 3, "v": 0}),
        "states": {"v": rt.between(-1.1, 1.1)},
        "controls": {"u": rt.between(LOWER, UPPER)},
        "objective": rt.Duration(),
    }
    return rt.Problem([rt.Phase(system, **(given | more))])


def stop_and_go() -> rt.Problem:
    """Two phases with the same limits."""
    (phase,) = drive(end=rt.State({"x": 1})).phases
    (last,) = drive(start=None).phases
    return rt.Problem([replace(phase, name="go"), replace(last, name="stop")], links=[rt.Continuity(0, 1)])


def planned(
    problem: rt.Problem,
    mesh: rt.Mesh,
    interval_limits: rt.interval_limits.ConstraintGeneration,
    solver: Solver | None = None,
) -> rt.Solution:
    return rt.plan(
        problem,
        mesh,
        rt.guess.StraightLine(4.0),
        solver or rt.InteriorPoint(fallback=None),
        interval_limits=interval_limits,
        progress=False,
    )


def largest_excess(solution: rt.Solution, names: Sequence[str] = ("u",)) -> float:
    """Violation of the limits of controls at 200 random times of every interval [of their SI unit]."""
    rng = np.random.default_rng(5)
    worst = -np.inf
    for part in solution.phases:
        rows = {row.variable: row for row in part.phase.rows}
        which = [i for i, control in enumerate(part.phase.dae.controls) if control.name in rows]
        limits = [rows[part.phase.dae.controls[i].name] for i in which]
        knots = part.trajectory.u.breaks
        for k, (first, last) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
            u = part.trajectory.u(rng.uniform(first, last, 200), k)[:, which]
            beyond = np.maximum([r.lower for r in limits] - u, u - [r.upper for r in limits])
            worst = max(worst, float(beyond.max()))
    return worst


@pytest.mark.parametrize("sites", [scheme.control_sites for scheme in SCHEMES.values()], ids=SCHEMES)
def test_values_and_rows_are_the_bernstein_coefficients_of_the_control(sites: Array) -> None:
    values = np.random.default_rng(len(sites)).standard_normal(len(sites))
    weights, places = control_weights(tuple(sites))
    own = are_coefficients(sites)
    coefficients = np.append(values[own], weights @ values)[np.argsort(np.append(sites[own], places))]
    tau = np.linspace(0, 1, 33)
    wanted = basis(sites, tau) @ values
    np.testing.assert_allclose(BPoly(coefficients[:, None], [0.0, 1.0])(tau), wanted, atol=1e-12)


def test_the_parabola_of_hermite_simpson_has_the_published_coefficient() -> None:
    weights, places = control_weights((0.0, 0.5, 1.0))
    np.testing.assert_allclose(weights, [[-0.5, 2.0, -0.5]], atol=1e-14)
    assert places == pytest.approx([0.5])


@pytest.mark.parametrize("control", [rt.schemes.LinearControl(), rt.schemes.ConstantControl()])
def test_linear_and_constant_controls_need_no_rows(control: Any) -> None:
    plain, hull = (
        nlp_of(drive(), rt.Mesh(4, rt.HermiteSimpson(control=control)), interval_limits=interval_limits)
        for interval_limits in (rt.interval_limits.ConstraintGeneration(), HULL)
    )
    assert "u" not in {entry.label for nlp in (plain, hull) for entry in nlp.rows.entries}
    controls = np.unique(np.concatenate([i.controls.ravel() for i in hull.layouts[0].intervals]))
    assert np.all(hull.variables.upper[controls] == UPPER)


def test_controls_have_rows_only_with_controls_true() -> None:
    """Without them, the optimum of a scheme is the published one; states have rows in both cases."""
    held, plain = (nlp_of(drive(), rt.Mesh(4), interval_limits=b) for b in (HULL, rt.interval_limits.BernsteinBounds()))
    bounded = [{str(entry) for entry in nlp.rows.entries if "bound" in str(entry)} for nlp in (held, plain)]
    assert bounded == [{"state bound, v", "control bound, u"}, {"state bound, v"}]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_controls_keep_their_limits_everywhere_at_little_cost_in_time(scheme: str) -> None:
    mesh = rt.Mesh(13, SCHEMES[scheme])
    held, free = (
        planned(drive(), mesh, interval_limits)
        for interval_limits in (HULL, rt.interval_limits.ConstraintGeneration(rounds=0))
    )
    assert largest_excess(held) < 1e-6
    # A single Gauss point leaves nothing to bulge.
    assert scheme == "Gauss 1" or largest_excess(free) > 0.05 * UPPER
    assert free.objective - 1e-7 <= held.objective <= free.objective * 1.02


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_both_solvers_find_the_same_optimum(scheme: Scheme) -> None:
    staged, ipopt = (planned(drive(), rt.Mesh(9, scheme), HULL, solver) for solver in (None, rt.Ipopt(tolerance=1e-10)))
    assert staged.objective == pytest.approx(ipopt.objective, rel=1e-6)


@pytest.mark.parametrize(
    ("problem", "mesh", "solver"),
    [
        (stop_and_go(), rt.Mesh(6), None),
        (drive(), rt.schemes.MovingMesh(6), rt.Ipopt()),
        (drive(), rt.Mesh(8, rt.schemes.CompressedHermiteSimpson()), rt.Ipopt()),
        (
            drive(),
            rt.Mesh([0, 0.2, 0.6, 1], [rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(2)]),
            None,
        ),
        (drive(), rt.Mesh(8, rt.schemes.SingleShooting(control=rt.schemes.LinearControl())), rt.Ipopt()),
    ],
    ids=["two phases", "moving mesh", "compressed", "mixed schemes", "single shooting"],
)
def test_controls_hold_on_every_kind_of_mesh(problem: rt.Problem, mesh: rt.Mesh, solver: Solver | None) -> None:
    assert largest_excess(planned(problem, mesh, HULL, solver)) < 1e-6


def test_torques_of_an_arm_hold_in_minimum_time_by_both_solvers() -> None:
    mesh, problem = rt.Mesh(12), hurried_arm()
    joints = [control.name for control in problem.phases[0].dae.controls]
    staged, ipopt = (
        rt.plan(problem, mesh, solver=solver, interval_limits=HULL, progress=False)
        for solver in (rt.InteriorPoint(fallback=None), rt.Ipopt(tolerance=1e-9))
    )
    assert staged.objective == pytest.approx(ipopt.objective, rel=1e-6)
    assert largest_excess(staged, joints) < 1e-4
    assert largest_excess(ipopt, joints) < 1e-4
    free = rt.plan(
        problem,
        mesh,
        solver=rt.InteriorPoint(fallback=None),
        interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0),
        progress=False,
    )
    effort = problem.phases[0].robot.limits.effort  # type: ignore[union-attr]
    assert largest_excess(free, joints) > 0.05 * float(np.min(effort))


@pytest.mark.parametrize("scheme", ["Hermite-Simpson", "Radau 2", "Gauss 2", "fifth degree"])
def test_derivatives_of_the_rows(scheme: str) -> None:
    nlp = nlp_of(stop_and_go(), rt.Mesh(2, SCHEMES[scheme]), interval_limits=HULL)
    w, multipliers = somewhere(nlp)
    assert_close(nlp.jacobian(w).toarray(), differences(nlp.values, w, nlp.scale))

    def lagrangian_gradient(v: Array) -> Array:
        return 0.7 * nlp.gradient(v) + nlp.jacobian(v).T @ multipliers

    assert_close(nlp.hessian(w, multipliers, 0.7).toarray(), differences(lagrangian_gradient, w, nlp.scale))


def test_a_violation_names_its_control_and_time() -> None:
    nlp = nlp_of(drive(duration=4.0), rt.Mesh(4), interval_limits=HULL)
    w = np.zeros(len(nlp.variables))
    # Knots at the limit, 0.1 above it in the middle of the third interval: the coefficient is 0.2 above.
    for interval in nlp.layouts[0].intervals:
        w[interval.controls] = UPPER
    w[nlp.layouts[0].intervals[2].controls[1]] = UPPER + 0.1
    (found,) = (v for v in violations(nlp, w, 1e-6) if "u" in v.label.split(", "))
    assert (found.time, found.amount) == (pytest.approx(2.5), pytest.approx(0.2))


def test_positions_are_covered_where_asked_and_without_contacts() -> None:
    """Corrections of contacts are no part of the polynomial whose coefficients are bounded."""
    hopper = rt.load("hopper", root="planar")
    flight, stance = (rt.Phase(hopper, 0.5, contacts=each) for each in ([], [rt.PointContact("foot")]))
    names = {state.name for state in flight.body.states}
    for positions in (True, False):
        bounds = rt.interval_limits.BernsteinBounds(positions=positions)
        assert {name for name in bounds.covers(flight) if name.startswith("q.")} == (
            {name for name in names if name.startswith("q.")} if positions else set()
        )
        assert not names & bounds.covers(stance)


def test_bounds_that_fix_a_control_or_leave_it_free_are_no_rows() -> None:
    fixed = nlp_of(drive(controls={"u": rt.between(0.5, 0.5)}, end=None), rt.Mesh(3), interval_limits=HULL)
    free = nlp_of(drive(controls={}), rt.Mesh(3), interval_limits=HULL)
    upper = nlp_of(drive(controls={"u": rt.between(None, 0.5)}), rt.Mesh(3), interval_limits=HULL)
    for nlp, rows in ((fixed, 0), (free, 0), (upper, 3)):
        labels = [nlp.rows.entries[meaning].label for meaning in nlp.rows.meaning]
        assert labels.count("u") == rows
    controls = np.concatenate([i.controls.ravel() for i in fixed.layouts[0].intervals])
    assert np.all(fixed.variables.lower[controls] == 0.5)


def test_the_panda_moves_in_minimum_time_within_its_limits() -> None:
    """Three schemes on up to 1600 intervals converge to 0.692778 s."""
    phase = rt.Phase(
        rt.load("panda"),
        duration=(0.1, 3.0),
        start=rt.State(q=[0, -0.785, 0, -2.356, 0, 1.571, 0.785], v=0),
        end=rt.State(q=[1.5, 0.5, -0.5, -1.2, 0.6, 2.2, -0.8], v=0),
        objective=rt.Duration(),
    )
    mesh, solver = rt.Mesh.chebyshev(100, rt.schemes.RadauIIA(2)), rt.InteriorPoint(fallback=None)
    solution = rt.plan(phase, mesh, solver=solver, interval_limits=HULL, progress=False)
    assert solution.objective == pytest.approx(0.692778, rel=1e-4)
    assert largest_excess(solution, [control.name for control in phase.dae.controls]) < 1e-5
    assert phase.robot is not None
    knots, rng = solution.phases[0].knots, np.random.default_rng(2)
    for k, (first, last) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        v = solution.phases[0].at(np.sort(rng.uniform(first, last, 200)), interval=k).v
        assert np.all(np.abs(v) < phase.robot.limits.velocity + 1e-6)


def test_a_block_switches_within_one_interval_at_most_an_interval_late() -> None:
    """The optimum is 2 sqrt(10) s: a parabola within the limits takes a few thousandths longer on 20 intervals."""
    solution = planned(block(), rt.Mesh(20), HULL)
    assert 2 * np.sqrt(10) < solution.objective < 2 * np.sqrt(10) * 1.005


@pytest.mark.parametrize("degree", range(5))
def test_coefficients_are_those_of_the_polynomial_through_the_values(degree: int) -> None:
    rng = np.random.default_rng(degree)
    sites, values = np.sort(rng.random(degree + 1)), rng.standard_normal((degree + 1, 3))
    curve = BPoly(coefficients(sites, values)[:, None], [0.0, 1.0])
    np.testing.assert_allclose(curve(sites), values, atol=1e-9)


@pytest.mark.parametrize("ends", [(1.1, 1.1), (1.1, 0.0), (0.0, 1.1), (0.0, 0.0)], ids=str)
def test_rows_are_relaxed_beside_ends_that_are_fixed_at_a_limit_alone(ends: tuple[float, float]) -> None:
    start, end = (rt.State({"x": x, "v": v}) for x, v in zip((0, 3), ends, strict=True))
    problem = drive(start=start, end=end)
    nlp = nlp_of(problem, rt.Mesh(4, rt.schemes.RadauIIA(3)), interval_limits=HULL)
    chosen = np.array([nlp.rows.entries[k].name == "state bound" for k in nlp.rows.meaning])
    interval = np.minimum((4 * nlp.rows.fraction[chosen]).astype(int), 3)
    beyond = nlp.rows.upper[chosen] > 1.1
    assert chosen.any() and set(interval) == {0, 1, 2, 3}
    at_limit = {0: ends[0] == 1.1, 1: False, 2: False, 3: ends[1] == 1.1}
    assert all(beyond[interval == k].all() if held else not beyond[interval == k].any() for k, held in at_limit.items())
    assert nlp.rows.upper[chosen].max() < 1.1 + 1e-5


def test_the_room_beside_a_fixed_end_is_a_share_of_the_limits_in_every_unit() -> None:
    """A room of 1e-6 in SI units let a motion of micrometres leave its limits by their whole range."""

    def highest(unit: float) -> float:
        system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
        cost = rt.Lagrange(lambda point: point.u["u"] ** 2)
        limits = {"x": rt.between(-unit, unit)}
        phase = rt.Phase(system, 1.0, rt.State([0.9 * unit]), rt.State([0.0]), cost, states=limits)
        rows = nlp_of(rt.Problem([phase]), rt.Mesh(4, rt.schemes.RadauIIA(3)), interval_limits=HULL).rows
        chosen = np.array([rows.entries[k].name == "state bound" for k in rows.meaning])
        return float(rows.upper[chosen].max()) / unit

    assert highest(1.0) == 1.0
    assert highest(1e-6) == pytest.approx(1.0, rel=1e-12)
    assert highest(1e-9) == pytest.approx(1.0, rel=1e-12)
