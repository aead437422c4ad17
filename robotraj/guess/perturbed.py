"""Seeded random variations of a guess, smooth and inside the bounds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.checks import number, whole
from robotraj._util.errors import InputError
from robotraj._util.precision import SAMPLES
from robotraj._util.printing import brief
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION
from robotraj.robot.tangent import normalised

MODES = 4
"""Sines in a perturbation; the k-th has k half waves and an amplitude that falls with k."""

WIDEST = 10.0
"""Greatest spread; it is a multiple of the ranges, and no percentage."""


@dataclass(frozen=True)
class Perturbed(InitialGuess):
    """Another guess with smooth random perturbations, reproducible by its seed.

    The perturbation of a state is  size sum_k c_k sin(k pi s) / k,  with s the fraction of the phase and c_k standard
    normal. It is zero at both ends. Velocities and accelerations of a robot follow from its perturbed positions;
    ``pin.integrate`` moves a floating root. Perturbations of a System's controls do not vanish at the ends. ``size`` is
    ``spread`` times half the range between the bounds of the variable. For an unbounded variable it is half the range
    of the guess, at least 1. The result is clipped to the bounds. Free durations are multiplied by exp(spread c).

    Parameters
    ----------
    guess : InitialGuess
        The guess to perturb.
    seed : int or sequence of int
        Seed of NumPy's default generator, combined with the index of the phase.
    spread : float
        Relative size of the perturbations; 0 for none.

    Raises
    ------
    InputError
        There is no guess to perturb, a seed is no integer of 0 or more, or the spread is negative or above 10.
    """

    guess: InitialGuess
    seed: int | tuple[int, ...]
    spread: float = 1.0

    def __post_init__(self) -> None:
        if not isinstance(self.guess, InitialGuess):
            raise InputError(f"Perturbed takes a guess such as rt.guess.StraightLine(), got {brief(self.guess)}.")
        for each in self.seed if isinstance(self.seed, tuple | list) else [self.seed]:
            whole("A seed of Perturbed", each, 0, 2**63 - 1)
        number("The spread of Perturbed", self.spread, 0.0, WIDEST, "times half the ranges")

    def prepared(self, problem: Problem) -> InitialGuess:
        """Prepare the guess that is perturbed."""
        return Perturbed(self.guess.prepared(problem), self.seed, self.spread)

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the perturbed guess of a phase."""
        rng = np.random.default_rng((*np.atleast_1d(self.seed).tolist(), index))
        known = self.guess.of(phase, index)
        low, high = phase.duration_bounds
        duration = float(np.clip(known.duration * np.exp(self.spread * rng.standard_normal()), low, high))
        body = phase.body
        robot = phase.state_robot
        nx, nu = len(body.states), len(body.controls)
        s = np.linspace(0.0, 1.0, SAMPLES)
        x, u = known.states(s)[:, :nx], known.controls(s)[:, :nu]
        nq, nv = (nx, nx) if robot is None else (robot.nq, robot.nv)
        sizes = self._sizes(phase, body.states[:nq], x[:, :nq])
        if robot is not None and robot.root == "floating":
            # Rotations of the root have no bounds; their size is one radian.
            sizes = np.concatenate([sizes[:3], np.full(3, self.spread), sizes[QUATERNION.stop :]])
        waves = rng.standard_normal((MODES, nv)) * sizes
        bounds = phase.rows.limits_of(phase.dae.states)
        pushes = rng.standard_normal((MODES, nu)) * self._sizes(phase, body.controls, u)
        offsets = rng.standard_normal(nu) * self._sizes(phase, body.controls, u)
        if robot is not None:
            pushes, offsets = np.zeros_like(pushes), np.zeros_like(offsets)
        pace = duration if duration > 0 else 1.0
        stretch = known.duration / pace if known.duration > 0 else 1.0

        def states(s: Array) -> Array:
            values = np.array(known.states(s))
            added, rate = _sines(s, waves, 0), _sines(s, waves, 1) / pace
            if robot is None:
                values[:, :nq] += added
            else:
                values[:, nq : nq + nv] *= stretch
                values[:, : nq + nv] = _moved(robot, values[:, : nq + nv], added, rate)
            return np.clip(values, *bounds)

        def algebraic(s: Array) -> Array:
            values = np.array(known.algebraic(s))
            if robot is not None and body.algebraic:
                values[:, :nv] = values[:, :nv] * stretch**2 + _sines(s, waves, 2) / pace**2
            return values

        def controls(s: Array) -> Array:
            values = np.array(known.controls(s))
            names = [c.name for c in phase.dae.controls]
            if [c.name for c in body.controls] == names[:nu]:
                values[:, :nu] += offsets + _sines(s, pushes, 0)
            return np.clip(values, *phase.rows.limits_of(phase.dae.controls))

        return PhaseGuess(duration, states, algebraic, controls, self._parameters(phase, known, rng))

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Return the impulses of the unperturbed guess."""
        return self.guess.of_link(link, index)

    def _sizes(self, phase: Phase, variables: tuple[Variable, ...], values: Array) -> Array:
        lower, upper = phase.rows.limits_of(variables)
        own = np.maximum(1.0, 0.5 * np.ptp(values, axis=0))
        with np.errstate(invalid="ignore"):
            half = 0.5 * (upper - lower)
        return self.spread * np.where(np.isfinite(half), half, own)

    def _parameters(self, phase: Phase, known: PhaseGuess, rng: np.random.Generator) -> dict[str, float]:
        values = {}
        for name, low, high in zip(phase.parameter_names, *phase.parameter_bounds, strict=True):
            share = rng.uniform()
            bounded = np.isfinite(low) and np.isfinite(high) and self.spread > 0
            values[name] = float(low + share * (high - low)) if bounded else known.parameters[name]
        return values


def _moved(robot: Robot, states: Array, added: Array, rate: Array) -> Array:
    """Return states (m, nq + nv) after displacements ``added`` with rates ``rate``, tangent vectors (m, nv) each."""
    q, v = states[:, : robot.nq], states[:, robot.nq :]
    if robot.root != "floating":
        return np.hstack([q + added, v + rate])
    rows = []
    for at, speed, step, slope in zip(normalised(robot.model, q), v, added, rate, strict=True):
        along, by = pin.dIntegrate(robot.model, at, step)
        rows.append(np.concatenate([pin.integrate(robot.model, at, step), along @ speed + by @ slope]))
    return np.array(rows)


def _sines(s: Array, waves: Array, derivative: int) -> Array:
    """Return the sum of waves_k sin(k pi s) / k, or its derivative with respect to s, (m, n)."""
    k = np.arange(1, len(waves) + 1)
    angles = np.pi * np.outer(s, k) + 0.5 * np.pi * derivative
    return np.asarray((np.sin(angles) * (np.pi * k) ** derivative / k) @ waves)
