import casadi as ca
import numpy as np
import pytest

from robotraj._util.errors import ValidationFailed
from robotraj.dynamics.row import Row
from robotraj.dynamics.system import System
from robotraj.problem.constraints.base import BoundConstraint
from robotraj.witness import validate

KNOTS = np.linspace(0.0, 1.0, 11)

# An oscillator with a casadi function in it: x'' = -sin x + u + p.
DRIVEN = System(
    states=["x", "v"],
    controls=["u"],
    dynamics=lambda point: [point.x["v"], -ca.sin(point.x["x"]) + point.u["u"] + point.p["bias"]],
    units={"x": "m", "v": "m/s", "u": "N"},
)


def driven(make, bias=0.25, **phase):
    """x = cos 2t with the control that makes it so."""
    return make.plan(
        make.phase(system=DRIVEN, **phase),
        KNOTS,
        parameters={"bias": bias},
        x=lambda t, k: np.array([np.cos(2 * t), -2 * np.sin(2 * t)]),
        u=lambda t, k: -4 * np.cos(2 * t) + np.sin(np.cos(2 * t)) - 0.25,
        z=lambda t, k: np.zeros(0),
    )


def test_a_system_moves_by_its_own_equations(make):
    report = validate(make.solution(driven(make)))
    assert report.passed and report.energy is None
    assert report.drift.largest() < 1e-9
    assert report.residual.rate["v"].value < 1e-9
    assert report.residual.dynamics == {}
    assert "energy" not in str(report)


def test_a_wrong_parameter_is_seen_in_the_state_it_moves(make):
    report = validate(make.solution(driven(make, bias=0.35)))
    assert report.residual.rate["v"].value == pytest.approx(0.1, abs=1e-8)
    assert report.residual.rate["x"].value < 1e-9
    assert report.drift["x"].unit == "m"
    with pytest.raises(ValidationFailed, match=r"violates .* misses its end: v by 0\.0025 m/s"):
        report.check()


def test_constraints_of_systems_are_evaluated_on_numbers(make):
    row = Row("power", "W", -np.inf, 1.0)
    power = BoundConstraint("power", (row,), lambda point: [point.x["v"] * point.u["u"]])
    (violation,) = validate(make.solution(driven(make, bound_constraints=(power,)))).violations
    t = np.linspace(0, 1, 100001)
    exact = -2 * np.sin(2 * t) * (-4 * np.cos(2 * t) + np.sin(np.cos(2 * t)) - 0.25)
    assert violation.amount == pytest.approx(exact.max() - 1.0, abs=1e-4)
    assert violation.time == pytest.approx(t[exact.argmax()], abs=0.005)


# The pendulum in Cartesian coordinates, index 1: lam holds the acceleration along the rod.
PENDULUM = System(
    states=["x", "y", "vx", "vy"],
    controls=[],
    algebraic=["lam"],
    dynamics=lambda point: [
        point.x["vx"],
        point.x["vy"],
        -point.z["lam"] * point.x["x"],
        -point.z["lam"] * point.x["y"] - 9.81,
    ],
    residual=lambda point: [
        point.x["vx"] ** 2
        + point.x["vy"] ** 2
        - point.z["lam"] * (point.x["x"] ** 2 + point.x["y"] ** 2)
        - 9.81 * point.x["y"]
    ],
)


def circling(make, wrong=0.0):
    """The separatrix: theta = 4 atan(exp(w t)) - pi from the horizontal, at its closed form."""
    w = np.sqrt(9.81)

    def angle(t):
        return 4 * np.arctan(np.exp(w * (t - 0.5))) - np.pi

    def x(t, k):
        th = angle(t)
        rate = 2 * w * np.cos(th / 2)
        return np.array([np.sin(th), -np.cos(th), rate * np.cos(th), rate * np.sin(th)])

    def z(t, k):
        th = angle(t)
        return (2 * w * np.cos(th / 2)) ** 2 + 9.81 * np.cos(th) + wrong

    return make.plan(make.phase(system=PENDULUM), KNOTS, x=x, z=z, u=lambda t, k: np.zeros(0))


def test_algebraic_variables_are_solved_for(make):
    report = validate(make.solution(circling(make)))
    assert report.drift.largest() < 1e-7
    assert report.residual.dynamics["residual 0"].value < 1e-7


def test_wrong_planned_algebraic_variables_do_not_move_the_simulation_but_show_in_the_residual(make):
    report = validate(make.solution(circling(make, wrong=0.2)))
    assert report.drift.largest() < 1e-7
    assert report.residual.dynamics["residual 0"].value == pytest.approx(0.2, abs=1e-6)
    with pytest.raises(ValidationFailed, match="residual 0|vx|vy"):
        report.check(residual=0.1)


def test_a_residual_without_a_root_stops_the_simulation_with_its_time(make):
    rootless = System(
        states=["x"],
        controls=[],
        algebraic=["z"],
        dynamics=lambda point: [1.0 + 0.0 * point.z["z"]],
        residual=lambda point: [point.z["z"] ** 2 + point.x["x"] - 0.5],
    )
    planned = make.plan(
        make.phase(system=rootless, name="fold"),
        KNOTS,
        x=lambda t, k: t,
        z=lambda t, k: np.sqrt(max(0.5 - t, 0.0)),
        u=lambda t, k: np.zeros(0),
    )
    report = validate(make.solution(planned))
    assert report.failure is not None and "phase 'fold', t = 0." in report.failure
    stopped = float(report.failure.split("t = ")[1].split(" s")[0])
    assert stopped == pytest.approx(0.5, abs=0.1)
