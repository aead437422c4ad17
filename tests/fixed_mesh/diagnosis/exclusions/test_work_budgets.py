"""The work between two given states is the gain of energy and the losses, so that smaller budgets exclude motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.dae import Dynamics
from robotraj.fixed_mesh.diagnosis.exclusions.work_budgets import exceeded_budgets
from robotraj.problem.constraints.base import BoundConstraint, Constraint
from robotraj.solution.conflict import Conflict
from robotraj.solvers.status import Status

LOW, HIGH = [0.0, -0.6, 0.8, 0.0, 0.0, 0.0], [0.4, -1.2, 0.8, 0.0, 0.0, 0.0]


def power(p: Any) -> Any:
    return sum(p.tau[k] * p.v[k] for k in range(6))


def positive(p: Any) -> Any:
    return sum(ca.fmax(p.tau[k] * p.v[k], 0) for k in range(6))


def lift(rate: Any, upper: float | None, lower: float | None = None, **changes: Any) -> rt.Phase:
    """Lift an arm within a budget."""
    budget = rt.constraints.IntegralConstraint(rate, lower, upper, "budget", "J")
    ends = {"start": rt.State(q=LOW, v=0), "end": rt.State(q=HIGH, v=0)} | changes
    robot = rt.load("ur3")
    return rt.Phase(robot, 1.5, objective=rt.Effort(), constraints=[budget], **ends)


def gain() -> float:
    model = rt.load("ur3").model
    data = model.createData()
    low, high = (float(pin.computePotentialEnergy(model, data, np.array(q))) for q in (LOW, HIGH))
    return high - low


def found(phase: rt.Phase) -> tuple[Conflict, ...]:
    return exceeded_budgets(rt.Problem([phase]))


@pytest.mark.parametrize("rate", [power, positive, lambda p: 2e-3 * power(p)], ids=["power", "positive", "scaled"])
def test_a_budget_below_the_gain_of_energy_excludes_every_motion(rate: Any) -> None:
    size = 2e-3 if rate not in (power, positive) else 1.0
    (conflict,) = found(lift(rate, 0.8 * size * gain()))
    assert conflict.certain and conflict.name == "budget"
    assert conflict.needed >= size * gain()
    assert f"{gain():.4g} J more energy" in str(conflict)


@pytest.mark.parametrize(
    "phase",
    [
        lambda: lift(power, 1.01 * gain()),
        lambda: lift(power, None, 0.9 * gain()),
        lambda: lift(positive, None, 2.0 * gain()),
        lambda: lift(lambda p: p.tau[0] ** 2 + p.tau[1] ** 2, 1e-9),
        lambda: lift(lambda p: p.tau[0] * p.v[0], 0.1),
        lambda: lift(lambda p: power(p) - p.v[0] ** 2, 0.1),
        lambda: lift(power, 0.1, end=rt.State(q=HIGH)),
    ],
    ids=["enough", "met below", "more work than the gain", "torques", "one joint", "less than the power", "free end"],
)
def test_other_integrals_exclude_nothing(phase: Any) -> None:
    assert not found(phase())


def test_work_without_losses_cannot_exceed_the_gain_either() -> None:
    (conflict,) = found(lift(power, None, 1.5 * gain()))
    assert conflict.certain and conflict.bound == pytest.approx(1.5 * gain()) and conflict.needed <= gain()


def test_friction_adds_to_the_least_work() -> None:
    arm = replace(rt.load("ur3"), friction=2.0 * np.eye(6)[0], damping=0.5 * np.eye(6)[0])
    budget = rt.constraints.IntegralConstraint(power, upper=1.02 * gain(), name="budget", unit="J")
    phase = rt.Phase(arm, 1.5, rt.State(q=LOW, v=0), rt.State(q=HIGH, v=0), rt.Effort(), [budget])
    (conflict,) = found(phase)
    # The joint turns by 0.4 rad in 1.5 s.
    assert conflict.needed > gain() + 2.0 * 0.35 + 0.5 * 0.4**2 / 1.5
    assert "friction takes at least" in str(conflict)


def test_weak_motors_cannot_lift_in_time_and_the_stated_powers_do() -> None:
    weak = lift(power, None, 0.0).with_(constraints=[rt.constraints.MotorPower(0.1 * gain() / 1.5)])
    conflicts = found(weak)
    assert conflicts and all(each.certain and each.name.startswith("power limit, ") for each in conflicts)
    stated = {each.name.removeprefix("power limit, "): abs(each.needed) for each in conflicts}
    enough = weak.with_(constraints=[rt.constraints.MotorPower({**dict.fromkeys(weak.robot.actuated, 5.0), **stated})])
    assert not found(enough) and rt.plan(enough).success


def test_the_power_of_all_motors_together_is_bounded_too() -> None:
    def limited(total: float) -> rt.Phase:
        return lift(power, None, 0.0).with_(constraints=[rt.constraints.MotorPower(total=total)])

    (conflict,) = found(limited(0.9 * gain() / 1.5))
    assert conflict.name == "total power limit" and conflict.needed > gain() / 1.5
    assert not found(limited(1.1 * gain() / 1.5))


def swing(duration: Any, start: float, end: float, effort: float, speed: float, **losses: float) -> rt.Phase:
    """Swing a pendulum from rest to rest; its energy is -cos(q)."""
    own = rt.load("pendulum")
    limits = own.limits.with_(effort=effort, velocity=speed)
    values: Any = {name: [losses.get(name, 0.0)] for name in ("damping", "friction")}
    robot = replace(own, limits=limits, **values)
    return rt.Phase(robot, duration, rt.State(q=[start], v=0), rt.State(q=[end], v=0), rt.Effort())


@pytest.mark.parametrize("damping", [0.5, 2.0, 20.0])
@pytest.mark.parametrize("friction", [0.0, 3.0])
def test_a_motor_cannot_turn_faster_than_its_effort_beside_the_losses(damping: float, friction: float) -> None:
    """At the constant speed (F - f) / d the losses take all of it: 1 rad takes the time d / (F - f) at least."""
    least = damping / (5.0 - friction)
    of_losses = {"damping": damping, "friction": friction}
    (conflict,) = found(swing(0.95 * least, -0.5, 0.5, 5.0, 1e3, **of_losses))
    assert conflict.certain and conflict.name.startswith("effort limit, ") and abs(conflict.needed) > 5.0 / 0.95
    assert found(swing((0.1 * least, 0.95 * least), -0.5, 0.5, 5.0, 1e3, **of_losses))
    assert not found(swing(1.01 * least, -0.5, 0.5, 5.0, 1e3, **of_losses))
    assert not found(swing((0.1 * least, np.inf), -0.5, 0.5, 5.0, 1e3, **of_losses))


def test_a_motor_of_limited_speed_and_effort_lifts_no_faster_than_both_allow() -> None:
    assert found(swing(1.0, 0.0, 0.5 * np.pi, 0.5, 1.8))
    assert not found(swing(1.0, 0.0, 0.5 * np.pi, 0.6, 1.8))
    assert not found(swing(1.0, 0.0, 0.5 * np.pi, 0.5, 1e9))


def test_a_reach_too_fast_for_damped_motors_stops_at_once_and_the_stated_effort_does() -> None:
    weak = swing(0.3, -0.5, 0.5, 5.0, 1e3, damping=2.0)
    solution = rt.plan(weak, check=False)
    assert solution.status is Status.INFEASIBLE and solution.iterations <= 1
    (conflict,) = solution.conflicts
    assert rt.plan(swing(0.3, -0.5, 0.5, abs(conflict.needed), 1e3, damping=2.0)).success


class Limited(Constraint):
    """A budget of a class of one's own."""

    def __init__(self, upper: float) -> None:
        self.inner = rt.constraints.IntegralConstraint(power, upper=upper, name="budget", unit="J")

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        return self.inner.bind(dynamics, parameters)


def test_the_plan_stops_at_once_and_a_stated_budget_does() -> None:
    phase = lift(power, 0.5 * gain())
    solution = rt.plan(phase, check=False)
    assert solution.status is Status.INFEASIBLE and solution.iterations <= 1
    (conflict,) = solution.conflicts
    # The motion found passes through the arm itself.
    assert rt.plan(lift(power, conflict.needed).with_(self_collision=False)).success


def test_integrals_of_classes_of_ones_own_are_solved_as_any_other() -> None:
    phase = lift(power, 3.0 * gain())
    own = phase.with_(constraints=[Limited(3.0 * gain())])
    given, same = (rt.plan(each, mesh=rt.Mesh(12)) for each in (phase, own))
    assert str(given.settings.solver) == str(same.settings.solver)
    assert same.objective == pytest.approx(given.objective, rel=1e-6)
