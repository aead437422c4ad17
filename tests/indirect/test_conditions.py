"""The report on Pontryagin's necessary conditions accepts optima and rejects other motions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial


def tampered(solution: rt.Solution, factor: Any) -> rt.Solution:
    """The solution with costates multiplied by ``factor``, one number a state."""
    duals = solution.duals[0]
    curve = duals.costate
    wrong = PiecewisePolynomial(curve.breaks, curve.sites, [v * np.asarray(factor) for v in curve.values])
    return replace(solution, duals=(replace(duals, costate=wrong),))


@pytest.mark.parametrize(
    "scheme",
    [rt.HermiteSimpson(), rt.schemes.FifthDegree(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(3)],
    ids=str,
)
def test_all_conditions_hold_on_a_smooth_optimum_and_the_finer_the_mesh_the_better(kirk: Any, scheme: Any) -> None:
    coarse, fine = (rt.indirect.conditions(rt.plan(kirk.phase(), rt.Mesh(n, scheme))) for n in (8, 32))
    assert fine.passed
    fine.check()
    for name in ("costate equation", "stationarity", "Hamiltonian"):
        assert fine.worst(name) < max(0.2 * coarse.worst(name), 1e-8)


def test_a_state_constraint_that_is_touched_is_part_of_the_costate_equation(bryson_denham: Any) -> None:
    for as_path in (False, True):
        report = rt.indirect.conditions(rt.plan(bryson_denham.phase(as_path=as_path), rt.Mesh(30)), tolerance=1e-3)
        assert report.passed, str(report)


def test_a_robot_with_a_saturated_motor_is_reported_by_joint(swing_up: Any) -> None:
    report = rt.indirect.conditions(rt.plan(swing_up(force=12.0), rt.Mesh(80)))
    assert report.passed, str(report)
    saturated = [c for c in report.conditions if c.name == "saturation"]
    assert [c.label for c in saturated] == ["tau.slider"]
    assert "costate equation  v.pole" in str(report)
    assert "effort limit, slider" in str(report)


def test_minimum_time_has_a_hamiltonian_of_minus_one(block: Any) -> None:
    # The control is curved in the interval beside the switch, where the error of H is of the order of h^2.
    report = rt.indirect.conditions(rt.plan(block(), rt.Mesh(20)), tolerance=2e-2)
    assert report.passed, str(report)
    final = next(c for c in report.conditions if c.label == "final time")
    assert final.residual < 1e-5
    assert "H = -1" in final.note


def test_free_ends_ask_for_the_gradient_of_the_end_cost(algebraic: Any) -> None:
    report = rt.indirect.conditions(rt.plan(algebraic(), rt.Mesh(20)))
    assert report.passed, str(report)
    line = next(c for c in report.conditions if c.name == "transversality")
    assert line.label == "x at the end"
    assert line.residual < 1e-6


def test_a_hamiltonian_that_depends_on_time_changes_by_its_explicit_rate() -> None:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], 2 * p.u["u"] - ca.sin(3 * p.t)])
    phase = rt.Phase(
        system, (0.5, 4), rt.State([0, 0]), rt.State([2, None]), rt.Lagrange(lambda p: p.u["u"] ** 2) + rt.Duration()
    )
    solution = rt.plan(phase, rt.Mesh(40))
    report = rt.indirect.conditions(solution)
    assert report.passed, str(report)
    assert report.worst("Hamiltonian") < 1e-4
    assert np.ptp(rt.indirect.costates(solution).at(solution.knots).hamiltonian) > 0.1


def test_wrong_costates_are_found_out_and_named(kirk: Any) -> None:
    solution = rt.plan(kirk.phase(), rt.Mesh(20))
    report = rt.indirect.conditions(tampered(solution, [1.0, 1.2]))
    assert not report.passed
    assert {(c.name, c.label) for c in report.failed} >= {("costate equation", "v"), ("stationarity", "u")}
    with pytest.raises(rt.ValidationFailed, match="refine the mesh"):
        report.check()
    assert "OFF" in str(report)


def test_a_control_at_the_wrong_bound_is_found_out(block: Any) -> None:
    report = rt.indirect.conditions(tampered(rt.plan(block(), rt.Mesh(20)), [-1.0, -1.0]))
    assert report.worst("saturation") > 0.5


def test_end_constraints_carry_their_multipliers_into_transversality() -> None:
    arm = rt.load("two_link_arm")
    tip = rt.PathConstraint(lambda p: [p.frame("tip").position[i] for i in (0, 1)], [1.7, 0.95], [1.7, 0.95], "tip")
    phase = rt.Phase(arm, 2.0, rt.State(q=[0.3, 0.2], v=0), rt.State(v=0), rt.Effort(), constraints=[rt.AtEnd(tip)])
    report = rt.indirect.conditions(rt.plan(phase, rt.Mesh(40)))
    assert report.worst("transversality") < 1e-5
    assert report.passed, str(report)


def test_a_tolerance_below_zero_is_refused(kirk: Any) -> None:
    with pytest.raises(rt.InputError, match="above 0"):
        rt.indirect.conditions(rt.plan(kirk.phase(), rt.Mesh(5)), tolerance=0)


def test_integral_constraints_weigh_in_the_hamiltonian() -> None:
    # x'' = u, least u^2 / 2 with the integral of x held at 0.6: u = -lambda_v, H = -72.
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    effort = rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2)
    held = rt.constraints.IntegralConstraint(lambda point: point.x["x"], 0.6, 0.6, name="area")
    solution = rt.plan(rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), effort, [held]), rt.Mesh(20))
    report = rt.indirect.conditions(solution)
    assert report.passed, str(report)
    sample = rt.indirect.costates(solution).at(0.3)
    assert sample.hamiltonian == pytest.approx(-72.0, rel=1e-5)
    assert sample.path["area"] == pytest.approx(-72.0, rel=1e-5)
    np.testing.assert_allclose(rt.indirect.costates(solution).phases[0].initial, [-48, -12], rtol=1e-5)
    with pytest.raises(rt.InputError, match="does not support integral constraints such as 'area'"):
        rt.indirect.polish(solution)


@pytest.mark.parametrize("mesh", [rt.Mesh(30), rt.Mesh(20, rt.schemes.RadauIIA(3))], ids=str)
def test_an_integral_of_controls_is_no_row_at_an_end(mesh: rt.Mesh) -> None:
    # Least T where the integral of u^2, at least 12 / T^3, is at most 5: H = -1, and dT/d5 = -T / 15.
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    energy = rt.constraints.IntegralConstraint(lambda point: point.u["u"] ** 2, upper=5.0, name="energy")
    phase = rt.Phase(block, (0.1, 20), rt.State([0, 0]), rt.State([1, 0]), rt.Duration(), [energy])
    solution = rt.plan(phase, mesh)
    report = rt.indirect.conditions(solution)
    assert report.passed and report.worst("transversality") < 1e-6, str(report)
    sample = rt.indirect.costates(solution).at(0.3)
    assert sample.hamiltonian == pytest.approx(-1.0, rel=1e-6)
    assert sample.path["energy"] == pytest.approx((12 / 5) ** (1 / 3) / 15, rel=1e-6)


def test_terms_that_cancel_are_what_a_residual_is_weighed_by() -> None:
    # Least time to orbit above a flat moon: dH/du = 0 by two terms, and H = -1 by three, with no integrand.
    def rates(point: Any) -> list[ca.SX]:
        angle = point.u["b"]
        return [point.x["v"], 4.86 * ca.cos(angle), 4.86 * ca.sin(angle) - 1.62]

    launch = rt.System(["h", "u", "v"], ["b"], rates)
    ends = rt.State([0, 0, 0]), rt.State([18520, 1627, 0])
    report = rt.indirect.conditions(rt.plan(rt.Phase(launch, (1, 2000), *ends, rt.Duration()), tolerance=1e-6))
    assert report.passed and report.worst("stationarity") < 1e-6, str(report)
    # A ball thrown up: H = 0 throughout.
    ball = rt.System(["x", "v"], [], lambda point: [point.x["v"], -1.0])
    highest = rt.Mayer(lambda start, end: -end.x["x"])
    report = rt.indirect.conditions(rt.plan(rt.Phase(ball, (0.1, 5), rt.State([0, 1]), None, highest), tolerance=1e-6))
    assert report.passed, str(report)
