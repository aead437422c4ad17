"""One joint in several phases of least time, and the sum of their optima in the phase plane.

The joint slides or turns, with gravity, viscous damping, one-sided efforts, another load in each phase, and rests or
passes at a given speed between them. At a place and speed its acceleration lies between two bounds, which have opposite
signs below the limit of speed. The least time goes forward by the upper bound, along the limit, and then by the lower
one: the curve from the start and the curve into the end meet.
Source: Bobrow, Dubowsky and Gibson, Time-optimal control of robotic manipulators along specified paths (1985).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import robotraj as rt

Array = np.ndarray
Curve = Callable[[float], tuple[float, float]]
"""From a place to the speed there and the time from the curve's start [s]."""

GRAVITY = 9.81


@dataclass(frozen=True)
class JointPhases:
    """A joint, its places (n + 1,) [rad, m], its speeds there, and its load in each of n phases [kg].

    A joint that turns has its centre of mass at the distance ``arm`` [m], level at 0.
    """

    turns: bool
    mass: float
    arm: float
    inertia: float
    efforts: Array
    limit: float
    damping: float
    loads: Array
    places: Array
    speeds: Array

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> JointPhases:
        """Draw two to four phases of a joint that can hold its weight anywhere."""
        turns, count, mass = bool(rng.random() < 0.5), int(rng.integers(2, 5)), 10.0 ** rng.uniform(-2, 2)
        arm, size = (10.0 ** rng.uniform(-1, 0.3), 1.0) if turns else (0.0, 10.0 ** rng.uniform(-1, 0.5))
        inertia = 0.16 * mass * arm**2 if turns else mass
        moved, weight = (mass * arm**2 + inertia, mass * GRAVITY * arm) if turns else (mass, mass * GRAVITY)
        efforts = weight * rng.uniform(1.3, 4.0, 2)
        spare = efforts.min() - weight
        steps = size * rng.uniform(0.1, 0.8, count)
        signs = rng.choice([-1.0, 1.0], count) if rng.random() < 0.7 else np.ones(count)
        limit = np.sqrt(spare / moved * size) * rng.uniform(0.4, 2.0)
        passing = np.zeros(count + 1)
        for k in np.flatnonzero(signs[1:] == signs[:-1]) + 1:
            if rng.random() < 0.4:
                passing[k] = signs[k] * min(0.7 * limit, np.sqrt(0.6 * spare / moved * min(steps[k - 1 : k + 1])))
        return cls(
            turns,
            mass,
            arm,
            inertia,
            efforts * [-1.0, 1.0],
            float(limit),
            # At its highest speed, and with its heaviest load, the joint still accelerates.
            float(max(efforts.min() - 1.2 * weight, 0.0) / limit * rng.choice([0.0, rng.uniform(0.05, 0.5)])),
            mass * np.where(rng.random(count) < 0.5, 0.0, rng.uniform(0.0, 0.15, count)),
            np.cumsum(np.append(0.0, steps * signs)),
            passing,
        )

    @property
    def problem(self) -> rt.Problem:
        """The phases in least time."""
        ends = [rt.State(q=[q], v=[v]) for q, v in zip(self.places, self.speeds, strict=True)]
        phases = [
            rt.Phase(self._robot(k), (1e-2 * best, 50.0 * best), ends[k], ends[k + 1], rt.Duration(), name=f"{k}")
            for k, best in enumerate(map(self.least, range(len(self.loads))))
        ]
        return rt.Problem(phases, [rt.Continuity(k, k + 1) for k in range(len(phases) - 1)])

    @property
    def optimum(self) -> float:
        """The sum of the least times [s]."""
        return float(sum(map(self.least, range(len(self.loads)))))

    def least(self, phase: int) -> float:
        """Return the least time of a phase [s]."""
        mass, scale = self.mass + self.loads[phase], 1.0 + self.loads[phase] / self.mass
        moved = mass * self.arm**2 + self.inertia * scale if self.turns else mass
        first, last = self.places[phase : phase + 2]
        sign, length = np.sign(last - first), abs(last - first)
        most, least = sorted(sign * self.efforts, reverse=True)

        def acceleration(effort: float) -> Callable[[float, float], float]:
            def at(place: float, speed: float) -> float:
                q = first + sign * place
                # A positive turn about y lowers the arm.
                pull = mass * GRAVITY * (self.arm * np.cos(q) if self.turns else -1.0)
                return float((effort + sign * pull - self.damping * speed) / moved)

            return at

        begin, end = np.abs(self.speeds[phase : phase + 2])
        forward = self._curve(0.0, begin, acceleration(most), 1.0, length)
        backward = self._curve(length, end, acceleration(least), -1.0, length)
        edge = 1e-12 * length
        meet = brentq(lambda place: forward(place)[0] - backward(place)[0], edge, length - edge, xtol=1e-14 * length)
        return forward(meet)[1] + backward(meet)[1]

    def _curve(
        self, place: float, speed: float, rate: Callable[[float, float], float], way: float, length: float
    ) -> Curve:
        """Return the curve from a place and speed, forward (``way`` 1) or backward (-1), up to the limit of speed."""

        def fast(t: float, x: Array) -> float:
            return float(x[1] - self.limit)

        def far(t: float, x: Array) -> float:
            return float((x[0] - place) * way - (1.0 + 1e-9) * length)

        for event in (fast, far):
            event.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            lambda t, x: [way * x[1], way * rate(*x)],
            (0.0, 1e3 * length / self.limit),
            [place, speed],
            events=[fast, far],
            rtol=1e-11,
            atol=1e-13 * length,
            dense_output=True,
            method="DOP853",
        )
        until, reached, highest = float(found.t[-1]), *map(float, found.y[:, -1])

        def at(here: float) -> tuple[float, float]:
            if (here - reached) * way >= 0.0:
                return highest, until + abs(here - reached) / highest
            t = brentq(lambda t: found.sol(t)[0] - here, 0.0, until, xtol=1e-14 * until)
            return float(found.sol(t)[1]), t

        return at

    def _robot(self, phase: int) -> rt.Robot:
        model, mass = pin.Model(), self.mass + self.loads[phase]
        joint = pin.JointModelRY() if self.turns else pin.JointModelPZ()
        limits = (np.array([each]) for each in (np.abs(self.efforts).max(), self.limit, -1e3, 1e3))
        joint = model.addJoint(0, joint, pin.SE3.Identity(), "joint", *limits)
        turned = self.inertia * mass / self.mass * np.eye(3)
        model.appendBodyToJoint(joint, pin.Inertia(mass, np.array([self.arm, 0.0, 0.0]), turned), pin.SE3.Identity())
        model.lowerEffortLimit, model.upperEffortLimit = self.efforts[:1], self.efforts[1:]
        model.damping = np.array([self.damping])
        return rt.load(model)
