"""The error estimate against the true error: local, interval by interval, and its order in the interval's length."""

from __future__ import annotations

from dataclasses import replace
from time import process_time
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.assess import assess
from robotraj.transcription.refinement.error import interval_errors
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.schemes.shooting import Shooting

COLLOCATION: list[Collocation] = [
    rt.schemes.Trapezoidal(),
    rt.HermiteSimpson(),
    rt.schemes.LobattoIIIA(4),
    rt.schemes.FifthDegree(),
    rt.schemes.RadauIIA(1),
    rt.schemes.RadauIIA(2),
    rt.schemes.RadauIIA(3),
    rt.schemes.RadauIIA(5),
    rt.schemes.GaussLegendre(1),
    rt.schemes.GaussLegendre(2),
    rt.schemes.GaussLegendre(3),
    rt.schemes.GaussLegendre(4),
]
STEPPED: list[Scheme] = [
    rt.schemes.CompressedHermiteSimpson(),
    *(rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(substeps)) for substeps in (1, 2, 4, 8)),
    rt.schemes.SingleShooting(rt.schemes.RungeKutta4(1)),
    rt.schemes.SingleShooting(),
]
CVODES = [
    rt.schemes.Adaptive(1e-4, stiff=True),
    rt.schemes.Adaptive(1e-6),
    rt.schemes.Adaptive(1e-8, stiff=True),
    rt.schemes.Adaptive(1e-10),
]
SHOT = [
    family(integrator) for family in (rt.schemes.MultipleShooting, rt.schemes.SingleShooting) for integrator in CVODES
]


def name(scheme: Scheme) -> str:
    if isinstance(scheme, Shooting):
        return f"{type(scheme).__name__}-{scheme.integrator}"
    return f"{type(scheme).__name__}-{len(scheme.nodes)}"


def rates(t: float, x: Any) -> Any:
    return np.array([x[1], -4 * np.sin(x[0]) + 2 * np.cos(3 * t)])


SWING = rt.System(["q", "w"], [], lambda point: [point.x["w"], -4 * ca.sin(point.x["q"]) + 2 * ca.cos(3 * point.t)])
AS_DAE = rt.System(
    ["q", "w"],
    [],
    lambda point: [point.x["w"], point.z["a"]],
    algebraic=["a"],
    residual=lambda point: [point.z["a"] ** 3 + point.z["a"] - _cubed(point)],
)


def _cubed(point: Any) -> Any:
    a = -4 * ca.sin(point.x["q"]) + 2 * ca.cos(3 * point.t)
    return a**3 + a


def planned(scheme: Scheme, intervals: int, system: rt.System = SWING) -> rt.solution.PhaseSolution:
    """The initial value problem q = 1, w = 0 over 2 s."""
    phase = rt.Phase(system, 2.0, rt.State([1, 0]))
    return rt.plan(phase, rt.Mesh(intervals, scheme), solver=rt.Ipopt(tolerance=1e-12)).phases[0]


def estimate(part: rt.solution.PhaseSolution) -> Any:
    return interval_errors(part.phase, part.trajectory)


def true_errors(part: rt.solution.PhaseSolution) -> Any:
    """Distance, inside every interval, from the exact motion that leaves its first knot; in the estimate's units."""
    dense = np.linspace(0, 2, 801)
    size = np.ptp(part.trajectory.x(dense), axis=0)
    found = []
    for k, (begin, end) in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):
        times = np.linspace(begin, end, 40)
        start = part.trajectory.x(begin, k)
        exact = solve_ivp(rates, (begin, end), start, "DOP853", times, rtol=1e-13, atol=1e-14)
        found.append(np.max(np.abs(part.trajectory.x(times, k) - exact.y.T) / size))
    return np.array(found)


@pytest.mark.parametrize("scheme", [*COLLOCATION, *STEPPED, *SHOT], ids=name)
def test_the_estimate_bounds_the_true_error_of_every_interval_and_is_of_its_size(scheme: Scheme) -> None:
    part = planned(scheme, 16)
    ours, true = estimate(part), true_errors(part)
    assert np.all(true <= 1.25 * ours)
    assert true.max() >= 0.1 * ours.max()


@pytest.mark.parametrize("scheme", COLLOCATION, ids=name)
def test_the_estimate_falls_by_one_order_more_than_the_scheme_has_points(scheme: Collocation) -> None:
    """The residual vanishes at s points, so it is of order h^s, and its integral over an interval of h^(s + 1)."""
    meshes = (16, 32) if len(scheme.nodes) > 3 else (64, 128)
    coarse, fine = (estimate(planned(scheme, n)).max() for n in meshes)
    assert np.log2(coarse / fine) == pytest.approx(len(scheme.nodes) + 1, abs=0.25)


@pytest.mark.parametrize("scheme", STEPPED, ids=name)
def test_estimate_and_true_error_of_stepped_schemes_fall_with_their_order(scheme: Scheme) -> None:
    coarse, fine = (planned(scheme, n) for n in (32, 64))
    for error in (estimate, true_errors):
        assert np.log2(error(coarse).max() / error(fine).max()) == pytest.approx(4, abs=0.25)


def test_substeps_make_shooting_accurate_within_an_interval() -> None:
    one, two, four = (
        estimate(planned(rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(n)), 16)).max() for n in (1, 2, 4)
    )
    assert one > 8 * two > 16 * four


@pytest.mark.parametrize("integrator", CVODES, ids=str)
@pytest.mark.parametrize("intervals", [8, 32])
def test_an_adaptive_integrator_errs_by_its_own_tolerance_on_any_mesh(
    integrator: rt.schemes.Adaptive, intervals: int
) -> None:
    error = estimate(planned(rt.schemes.MultipleShooting(integrator), intervals)).max()
    assert 0.1 * integrator.tolerance < error < 30 * integrator.tolerance


def test_the_compressed_form_has_the_estimate_of_the_separated_one() -> None:
    """They are the same polynomials; the absolute residual is integrated at six points here, at five there."""
    compressed, separated = (
        estimate(planned(s, 16)) for s in (rt.schemes.CompressedHermiteSimpson(), rt.HermiteSimpson())
    )
    np.testing.assert_allclose(compressed, separated, rtol=0.2)


@pytest.mark.parametrize(
    "scheme", [*COLLOCATION, *STEPPED, rt.schemes.MultipleShooting(rt.schemes.Adaptive())], ids=name
)
def test_a_solution_has_an_error_estimate_for_every_scheme(scheme: Scheme) -> None:
    solution = rt.plan(rt.Phase(SWING, 2.0, rt.State([1, 0])), rt.Mesh(8, scheme))
    assert solution.error == estimate(solution.phases[0]).max()
    assert f"error between knots {solution.error:.1e}" in str(solution)


def test_a_dae_has_the_estimate_of_its_differential_equation() -> None:
    """z solves a cubic whose root is the acceleration of the same motion."""
    ode, dae = (estimate(planned(rt.schemes.RadauIIA(3), 10, system)) for system in (SWING, AS_DAE))
    np.testing.assert_allclose(dae, ode, rtol=1e-5)


def test_a_robot_by_inverse_dynamics_has_the_estimate_of_its_forward_dynamics() -> None:
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    found = []
    for dynamics in (rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()):
        phase = rt.Phase(rt.load("cartpole"), 2.0, *ends, rt.Effort(), dynamics=dynamics)
        found.append(estimate(rt.plan(phase, rt.Mesh(12, rt.schemes.RadauIIA(3)), solver=rt.Ipopt(1e-10)).phases[0]))
    np.testing.assert_allclose(found[0], found[1], rtol=1e-4)


def test_what_collocation_meets_exactly_has_no_error() -> None:
    cubic = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    phase = rt.Phase(cubic, 1.0, rt.State([0, 0]), rt.State([1, 0]), effort)
    assert estimate(rt.plan(phase, rt.Mesh(3)).phases[0]).max() < 1e-13


def test_smoothness_and_switches_are_seen() -> None:
    """Bang-bang: the interval of the switch has the jump; the analytic swing decays by decades a degree."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    limits = {"controls": {"u": rt.between(-1, 1)}}
    phase = rt.Phase(block, (0.1, 20), rt.State([4, 0]), rt.State([0, 0]), rt.Duration(), **limits)
    part = rt.plan(phase, rt.Mesh(11, rt.schemes.RadauIIA(3))).phases[0]
    seen = assess(part.phase, part.trajectory, part.mesh, settled=False)
    assert np.argmax(seen.jumps) == 5 and seen.jumps[5] > 0.9
    assert np.all(np.delete(seen.jumps, [4, 5, 6]) < 1e-6)
    smooth = planned(rt.schemes.RadauIIA(8), 10)
    assert assess(smooth.phase, smooth.trajectory, smooth.mesh, settled=True).decays.min() > 0.8
    rough = planned(rt.schemes.RadauIIA(8), 1)
    assert assess(rough.phase, rough.trajectory, rough.mesh, settled=True).decays.min() < 0.5


@pytest.mark.parametrize("unit", [1e-9, 1e6])
def test_the_estimate_of_a_dae_is_the_same_in_any_unit_of_its_algebraic_variable(unit: float) -> None:
    """z^3 + z = sin 3t, with z in another unit: Newton's steps end by the variable's own size."""

    def phase(unit: float) -> rt.Phase:
        def residual(point: Any) -> list[Any]:
            z = point.z["z"] / unit
            return [z**3 + z - ca.sin(3 * point.t)]

        system = rt.System(["x"], [], lambda p: [p.z["z"] / unit], algebraic=["z"], residual=residual)
        return rt.Phase(system, 2.0, rt.State([0.0]))

    motion = rt.plan(phase(1.0), rt.Mesh(4, rt.HermiteSimpson())).phases[0].trajectory
    z = PiecewisePolynomial(motion.z.breaks, motion.z.sites, [unit * np.asarray(values) for values in motion.z.values])
    found, right = (interval_errors(phase(u), replace(motion, z=own)) for u, own in ((unit, z), (1.0, motion.z)))
    np.testing.assert_allclose(found, right, rtol=1e-6)


def test_a_short_event_in_one_long_interval_is_seen_without_a_rule_of_thousands_of_points() -> None:
    """Their eigenvalues took minutes. x follows a line from 0 to 0.1, and its rate is a kick within milliseconds:
    the estimate is the integral of |0.1 - kick| over the second."""

    def kick(t: Any) -> Any:
        return 1e3 / np.sqrt(np.pi) * ca.exp(-(((t - 0.321) / 1e-3) ** 2))

    phase = rt.Phase(rt.System(["x"], [], lambda p: [kick(p.t)]), 1.0, rt.State([0.0]))
    ends = np.array([0.0, 1.0])
    x = PiecewisePolynomial(ends, [ends], [0.1 * ends[:, None]])
    none = PiecewisePolynomial(ends, [ends], [np.empty((2, 0))])
    line = PhaseTrajectory(0.0, 1.0, x, none, none, ends, {})
    t = (np.arange(100_000) + 0.5) / 100_000
    right = np.abs(0.1 - np.array(kick(ca.DM(t)))).mean()
    begin = process_time()
    np.testing.assert_allclose(0.1 * interval_errors(phase, line), right, rtol=1e-2)
    assert process_time() - begin < 1.0
