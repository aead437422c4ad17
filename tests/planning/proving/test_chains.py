"""Motions in several phases between stops cost the sum of the least costs of their phases.

The state is given at every stop, so that each phase is a problem of its own. A link between given states is a redundant
equation, and the optimum of the chain is known in closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

GRAVITY = 9.81


@dataclass(frozen=True)
class Axis:
    """A mass on a slide, along x or up z, within a force [N] and a speed [m/s]."""

    mass: float
    force: float
    speed: float
    vertical: bool

    def robot(self) -> rt.Robot:
        joint = pin.JointModelPZ() if self.vertical else pin.JointModelPX()
        model = pin.Model()
        index = model.addJoint(0, joint, pin.SE3.Identity(), "slide")
        model.appendBodyToJoint(index, pin.Inertia(self.mass, np.zeros(3), 1e-2 * np.eye(3)), pin.SE3.Identity())
        limits = {"position": (-9, 9), "velocity": self.speed, "effort": self.force}
        return rt.load(model, limits={kind: {"slide": limit} for kind, limit in limits.items()})

    def least_time(self, distance: float) -> float:
        """Time from rest to rest: full force, the speed limit if it is reached, and full force backwards [s]."""
        weight = np.sign(distance) * GRAVITY if self.vertical else 0.0
        faster, slower = self.force / self.mass - weight, self.force / self.mass + weight
        peak = min(np.sqrt(2 * abs(distance) / (1 / faster + 1 / slower)), self.speed)
        half = 0.5 * peak * (1 / faster + 1 / slower)
        return float(2 * half + (abs(distance) - peak * half) / peak)


def drawn(seed: int) -> tuple[list[Axis], list[float]]:
    """Draw the axis of each phase, whose mass changes at the stops, and the stops [m]."""
    rng = np.random.default_rng(seed)
    phases, vertical = int(rng.integers(2, 5)), bool(rng.random() < 0.7)
    stops = np.cumsum(np.append(rng.uniform(-1, 1), rng.choice([-1, 1], phases) * rng.uniform(0.1, 1.5, phases)))
    speed = float(rng.choice([rng.uniform(0.5, 3), 100.0]))
    axes = [Axis(m, float(rng.uniform(1.3, 3) * 4 * GRAVITY), speed, vertical) for m in rng.uniform(0.5, 4, phases)]
    return axes, stops.tolist()


def chain(robots: Sequence[rt.Robot], stops: Sequence[float], longest: float) -> rt.Problem:
    """Move from stop to stop in least time."""
    phases = [
        rt.Phase(robot, (0.01, longest), rt.State(q=[a], v=0), rt.State(q=[b], v=0), rt.Duration())
        for robot, (a, b) in zip(robots, pairwise(stops), strict=True)
    ]
    return rt.Problem(phases, [rt.Continuity(k, k + 1) for k in range(len(phases) - 1)])


@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(s, marks=pytest.mark.slow) for s in range(4, 100))])
def test_least_times_of_an_axis_between_stops_are_sums_of_closed_forms(seed: int) -> None:
    axes, stops = drawn(seed)
    exact = sum(axis.least_time(b - a) for axis, (a, b) in zip(axes, pairwise(stops), strict=True))
    solution = rt.plan(chain([axis.robot() for axis in axes], stops, 5.0 if seed % 2 else 20.0))
    assert solution.proof is not None and solution.proof.holds
    assert solution.duration == pytest.approx(exact, rel=1e-3)


def test_a_system_between_stops_needs_the_sum_of_its_least_times() -> None:
    cart = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    low, high, stops = -2.0, 3.0, [0.0, 1.0, -1.0, 0.5]
    controls = {"u": rt.between(low, high)}
    phases = [
        rt.Phase(cart, (0.01, 20), rt.State([a, 0]), rt.State([b, 0]), rt.Duration(), controls=controls)
        for a, b in pairwise(stops)
    ]
    exact = sum(np.sqrt(2 * abs(b - a) * (1 / high - 1 / low)) for a, b in pairwise(stops))
    solution = rt.plan(rt.Problem(phases, [rt.Continuity(0, 1), rt.Continuity(1, 2)]))
    assert solution.proof is not None and solution.proof.holds
    assert solution.duration == pytest.approx(exact, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_a_pendulum_there_and_back_costs_as_much_as_by_ipopt(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mass, length = rng.uniform(0.5, 4), 0.3
    model = pin.Model()
    index = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "hinge")
    body = pin.Inertia(mass, np.array([0, 0, length]), 0.02 * np.eye(3))
    model.appendBodyToJoint(index, body, pin.SE3.Identity())
    effort, speed = mass * GRAVITY * length * rng.uniform(1.3, 3), rng.uniform(2, 40)
    limits = {"position": (-3, 3), "velocity": speed, "effort": effort}
    robot = rt.load(model, limits={kind: {"hinge": limit} for kind, limit in limits.items()})
    a, b = rng.uniform(-1, 1, 2)
    problem = chain([robot, robot], [a, b, a], 10.0)
    best = rt.plan(problem, rt.Mesh(60), solver=rt.Ipopt()).duration
    assert rt.plan(problem).duration == pytest.approx(best, rel=1e-3)
