"""Implicit steps: their order, their behaviour on stiff motions, and the Jacobians of plants."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj.witness.plants.of_phase import plant_of
from robotraj.witness.plants.robot_plant import RobotPlant
from robotraj.witness.simulation import sdirk
from robotraj.witness.simulation.spans import Span
from robotraj.witness.simulation.steps import is_stiff, march


@dataclass
class Friction:
    """A point of mass m = 1 with drag d v: v' = (u - d v) / m, x' = v, planned at rest."""

    drag: float = 1.0
    force: float = 0.0

    def states(self, times, interval=None):
        return np.zeros((len(times), 2))

    def given(self, times):
        return (self.force + np.sin(3.0 * times))[:, None]

    def rate(self, t, x, given):
        return np.array([x[1], given[0] - self.drag * x[1] ** 3 - self.drag * x[1]])

    def jacobian(self, t, x, given):
        return np.array([[0.0, 1.0], [0.0, -self.drag * (1.0 + 3.0 * x[1] ** 2)]])


def simulated(driven, steps):
    x = np.array([0.3, 0.5])
    for begin, end in zip(np.linspace(0, 1, steps + 1)[:-1], np.linspace(0, 1, steps + 1)[1:], strict=True):
        span = Span(begin, end, 0)
        reference, plan = sdirk.references(driven, [span])[0], sdirk.sampled(driven, [span])[0]
        at = begin + span.length * sdirk.NODES
        x, _ = sdirk.take_step(driven, x, begin, span.length, at, plan, reference, 1e-10, 1e-10)
    return x


def test_the_method_is_of_order_four():
    driven = Friction()
    exact = solve_ivp(
        lambda t, x: driven.rate(t, x, driven.given(np.array([t]))[0]), (0, 1), [0.3, 0.5], rtol=1e-13, atol=1e-14
    ).y[:, -1]
    errors = [np.abs(simulated(driven, n) - exact).max() for n in (8, 16)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.4)


def test_a_stiff_motion_takes_few_steps_and_keeps_its_tolerance():
    driven = Friction(drag=1e6, force=1.0)
    spans = [Span(0.1 * k, 0.1 * (k + 1), k) for k in range(10)]
    assert is_stiff(driven, spans) and not is_stiff(Friction(), spans)
    motion = march(driven, np.array([0.0, 0.5]), spans, np.ones(2), rtol=1e-6, atol=1e-6)
    assert motion.failure is None and motion.stiff == 0.0 and len(motion.times) < 80
    # The drag passes the force on at once: v (1 + v^2) = u / d.
    assert motion.states[-1, 1] == pytest.approx((1.0 + np.sin(3.0)) / 1e6, rel=1e-2, abs=1e-9)


def test_the_reference_is_exact_for_polynomials_of_its_degree():
    """p(t) = t^3 - t and its rate, from samples at the Chebyshev points of the span."""
    span = Span(2.0, 4.0, 0)
    sites = sdirk.StatePolynomial.times(span)
    np.testing.assert_allclose(sites, 3.0 - np.cos(np.pi * np.arange(sdirk.POINTS) / (sdirk.POINTS - 1)), atol=1e-6)
    t = np.linspace(2.0, 4.0, 7)
    values, rates = sdirk.StatePolynomial(span, (sites**3 - sites)[:, None]).at(t)
    np.testing.assert_allclose(values[:, 0], t**3 - t, atol=1e-4)
    np.testing.assert_allclose(rates[:, 0], 3.0 * t**2 - 1.0, atol=1e-3)


@pytest.mark.parametrize("place", [0, 9])
@pytest.mark.parametrize(("product", "stiff"), [(19.0, False), (21.0, True)])
def test_the_first_and_the_last_span_alone_may_be_stiff(place, product, stiff):
    """A span counts as stiff if the largest eigenvalue times its length exceeds 20."""

    class Sticking(Friction):
        def jacobian(self, t, x, given):
            return np.diag([0.0, -product / 0.1 if int(round(t / 0.1)) == place else -1.0])

    spans = [Span(0.1 * k, 0.1 * (k + 1), k) for k in range(10)]
    assert is_stiff(Sticking(), spans) == stiff


def test_a_motion_that_explodes_is_reported_with_its_time():
    class Explosion(Friction):
        def rate(self, t, x, given):
            return np.array([x[1], x[1] ** 2])

        def jacobian(self, t, x, given):
            return np.array([[0.0, 1.0], [0.0, 2.0 * x[1]]])

    span = Span(0.0, 1.0, 0)
    driven = Explosion()
    plan = sdirk.sampled(driven, [span])[0]
    with pytest.raises(sdirk.Stopped) as stop:
        sdirk.pass_stiffly(
            driven, np.array([0.0, 2.0]), span, sdirk.references(driven, [span])[0], plan, 1.0, 1e-6, 1e-6
        )
    # v = 2 / (1 - 2 t)
    assert stop.value.time == pytest.approx(0.5, abs=1e-3)


def differentiated(plant, x, given):
    columns = []
    for i in range(len(x)):
        unit = 1e-6 * np.eye(len(x))[i]
        columns.append((plant.rate(0.0, x + unit, given) - plant.rate(0.0, x - unit, given)) / 2e-6)
    return np.array(columns).T


def move(robot, contacts=(), **given):
    end = rt.State(v=0) if contacts else None
    return rt.plan(
        rt.Phase(robot, 0.4, rt.State(v=0), end, rt.Effort(), contacts=list(contacts), limits=None, **given),
        mesh=rt.Mesh(4),
        check=False,
    )


def arm():
    return move(rt.load("z1")).phases[0]


def flying():
    return move(rt.load("solo12", root="floating")).phases[0]


def standing():
    feet = [rt.PointContact(f"{leg}_FOOT") for leg in ("FL", "HR")]
    return move(rt.load("solo12", root="floating"), feet).phases[0]


@pytest.mark.parametrize("planned", [arm, flying, standing])
@pytest.mark.parametrize("feedback", [False, True])
def test_jacobians_are_the_derivatives_of_the_rates(planned, feedback):
    phase = planned()
    robot = phase.phase.robot
    rng = np.random.default_rng(3)
    gains = rng.normal(size=(1, len(robot.actuated), 2 * robot.nv))
    plant = RobotPlant(phase, (lambda times: np.repeat(gains, len(times), axis=0)) if feedback else None)
    time = np.array([0.13])
    x, given = plant.states(time)[0], plant.given(time)[0]
    x[robot.nq :] += 0.1 * rng.normal(size=robot.nv)
    expected = differentiated(plant, x, given)
    # A quaternion may be scaled: only directions that keep its length matter to a motion.
    keep = np.eye(len(x))
    if robot.nq > robot.nv:
        unit = x[3:7] / np.linalg.norm(x[3:7])
        keep[3:7, 3:7] -= np.outer(unit, unit)
    found = plant.jacobian(0.13, x, given)
    np.testing.assert_allclose(found @ keep, expected @ keep, atol=2e-5 * np.abs(expected).max())


def test_the_jacobian_of_a_system_is_found_by_differences():
    block = rt.System(
        states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"] - 3.0 * point.x["v"] ** 2]
    )
    phase = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Lagrange(lambda point: point.u["u"] ** 2))
    plant = plant_of(rt.plan(phase, mesh=rt.Mesh(5)).phases[0])
    np.testing.assert_allclose(
        plant.jacobian(0.0, np.array([0.0, 2.0]), np.array([1.0])), [[0, 1], [0, -12]], atol=1e-5
    )
