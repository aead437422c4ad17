"""The same problem in other units has the same plan and verdict: nothing is relative to 1."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from tests.lies import axis

MASSES, DISTANCES, DURATIONS = (1e-6, 1.0, 2e4), (1e-6, 1e-3, 5.0), (0.01, 1.0, 60.0)


@pytest.mark.parametrize("mass", MASSES)
@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("duration", DURATIONS)
def test_the_effort_of_a_mass_is_that_in_closed_form(
    tmp_path: Path, mass: float, distance: float, duration: float
) -> None:
    """From rest to rest the integral of the squared force is 12 m^2 d^2 / T^3, whatever the limits of the file."""
    robot = axis(tmp_path, mass=mass, travel=100, speed=1e5, effort=1e12)
    phase = rt.Phase(robot, duration, rt.State(q=[0], v=0), rt.State(q=[distance], v=0), rt.Effort())
    solution = rt.plan(phase, progress=False)
    assert solution.objective == pytest.approx(12 * mass**2 * distance**2 / duration**3, rel=1e-4)
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed


@pytest.mark.parametrize("limit", [1.0, 100.0])
@pytest.mark.parametrize(("mass", "distance"), [(1.0, 1e-6), (1e-6, 1e-6), (1e-6, 1.0)])
def test_a_least_time_is_that_in_closed_form(tmp_path: Path, limit: float, mass: float, distance: float) -> None:
    """An acceleration of 4 d takes 1 s, whether the limits of position and speed are 10 or 1e8 times the motion."""
    robot = axis(tmp_path, mass=mass, travel=10 * limit, speed=10 * limit, effort=4 * mass * distance)
    phase = rt.Phase(robot, (1e-3, 100), rt.State(q=[0], v=0), rt.State(q=[distance], v=0), rt.Duration())
    solution = rt.plan(phase, progress=False)
    assert solution.objective == pytest.approx(1.0, rel=1e-3)
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed


@pytest.mark.parametrize("strength", [10.0, 1e4, 1e5])
@pytest.mark.parametrize("mass", [1e-9, 1e-3, 1.0])
def test_the_effort_of_a_strong_motor_is_that_in_closed_form(tmp_path: Path, mass: float, strength: float) -> None:
    """The square of the share that is used was below the tolerance of the solver: optima 6 times the right one."""
    robot = axis(tmp_path, mass=mass, travel=3, speed=3, effort=strength * mass)
    phase = rt.Phase(robot, 4.0, rt.State(q=[0], v=0), rt.State(q=[0.6], v=0), rt.Effort())
    solution = rt.plan(phase, progress=False)
    assert solution.objective == pytest.approx(12 * mass**2 * 0.6**2 / 4.0**3, rel=1e-4)
    assert solution.proof is not None and solution.proof.holds


@pytest.mark.filterwarnings("ignore:.*weighs")
@pytest.mark.parametrize("kilogram", [1e-3, 1e-6, 1e-12])
def test_the_least_time_of_an_arm_is_the_same_in_every_unit_of_mass(kilogram: float) -> None:
    """Rows of limits of 1e-13 N m were solved to 1e-11 N m: other optima, teeth, and five times the iterations."""

    def planned(kilogram: float) -> rt.Solution:
        model = rt.load("two_link_arm").model.copy()
        for body in model.inertias:
            body.mass, body.inertia = kilogram * body.mass, kilogram * body.inertia
        model.upperEffortLimit, model.damping = kilogram * np.array([40.0, 20.0]), kilogram * model.damping
        model.lowerEffortLimit, model.friction = -model.upperEffortLimit, 0.0 * model.friction
        ends = rt.State(q=[-0.5, 0.3], v=0), rt.State(q=[0.8, 1.1], v=0)
        return rt.plan(rt.Phase(rt.load(model), (0.1, 10.0), *ends, rt.Duration()), progress=False)

    solution, known = planned(kilogram), planned(1.0)
    assert solution.objective == pytest.approx(known.objective, rel=1e-3)
    assert solution.iterations < 2 * known.iterations
    assert solution.proof is not None and solution.proof.holds


@pytest.mark.parametrize("amplitude", [1e-6, 1e-2, 1.0])
def test_an_oscillator_is_brought_to_rest_alike_at_every_amplitude(amplitude: float) -> None:
    """x'' = -w^2 x + u from x = A to rest: the optimum is x' W^-1 x by the Gramian W of the reversed motion."""
    w, duration = 60.0, 0.5
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], -(w**2) * p.x["x"] + p.u["u"]])
    phase = rt.Phase(system, duration, rt.State([amplitude, 0]), rt.State([0, 0]), rt.Lagrange(lambda p: p.u["u"] ** 2))
    t = np.linspace(0.0, duration, 200001)
    away = np.vstack([-np.sin(w * t) / w, np.cos(w * t)])
    gramian = np.trapezoid(away[:, None] * away[None], t, axis=2)
    start = np.array([amplitude, 0.0])
    solution = rt.plan(phase, progress=False)
    assert solution.objective == pytest.approx(start @ np.linalg.solve(gramian, start), rel=1e-3)
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed


@pytest.mark.parametrize(("amplitude", "frequency"), [(1.0, 200.0), (1e-6, 200.0), (1e-3, 400.0)])
def test_the_effort_that_stills_an_oscillator_of_many_periods_is_that_by_its_gramian(
    amplitude: float, frequency: float
) -> None:
    """x'' = u - w^2 x from (a, 0) to rest in 1 s: J = a^2 e' W^-1 e with W the Gramian, for 30 to 60 periods.

    With e = (cos w, -w sin w) the integrals of s^2 / w^2, s c / w and c^2 over the second make W.
    """
    w = frequency
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"] - w**2 * p.x["x"]])
    phase = rt.Phase(system, 1.0, rt.State([amplitude, 0]), rt.State([0, 0]), rt.Effort())
    twice = np.sin(2 * w) / (4 * w)
    mixed = np.sin(w) ** 2 / (2 * w**2)
    gramian = np.array([[(0.5 - twice) / w**2, mixed], [mixed, 0.5 + twice]])
    end = amplitude * np.array([np.cos(w), -w * np.sin(w)])
    solution = rt.plan(phase, progress=False)
    assert solution.objective == pytest.approx(end @ np.linalg.solve(gramian, end), rel=1e-3)
    assert solution.proof is not None and solution.proof.holds
