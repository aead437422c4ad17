"""What the terms of an objective, and dry friction, amount to along a plain motion.

Settings follow from these shares, so that a term or a friction that is too small to matter changes nothing. The plain
motion goes from the first to the last state of each phase by the quintic polynomial of least jerk, from rest to rest.
Its torques are those of inverse dynamics. Phases without such a motion have the shares of an objective that is all
integral, and all kinked if a term is.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import gauss
from robotraj._util.precision import DIFFERENCE
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.kinematics import Kinematics
from robotraj.guess.ends import default_parameters, ends_of, guessed_duration
from robotraj.guess.joint_motion import joint_motion
from robotraj.problem.augmentation import Augmented
from robotraj.problem.initial_guess import PhaseGuess, with_copies
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.schemes.lobatto import HermiteSimpson

KINKED = 0.3
"""Part of an objective that is kinked from which a plan treats it as such.

Below, Hermite-Simpson needs fewer iterations than lines, and finds objectives at least as low
(``benchmarks/shares.md``).
"""
STICKING = 0.01
"""``Shares.friction`` from which a plan starts from softer friction, to find where joints stick.

From there on a solver of a least time also stops where the time no longer falls. What sticking gains is of second order
in it: below, less than 1e-4, a tenth of the default goal of the objective.
"""
PLACES, WEIGHTS = 0.5 * (gauss(16)[0] + 1.0), 0.5 * gauss(16)[1]
"""Gauss's rule along a phase: kinks leave an error of about one percent."""


@dataclass(frozen=True)
class Shares:
    """Parts of an objective, from 0 to 1, and of the torques.

    Attributes
    ----------
    ends : float
        Part of the terms of the end points in the sum of the sizes of all terms, such as of a least time.
    kinks : float
        Part of the integrals that are not smooth, such as of absolute powers.
    rate : float
        Sum of the sizes of all terms over the duration of all phases; 0 where it is not known.
    friction : float
        Length of the vector of dry frictions of all joints, relative to the root mean square of that of the torques.
    """

    ends: float
    kinks: float
    friction: float
    rate: float = 0.0

    @property
    def kinked(self) -> bool:
        """Whether kinks matter."""
        return self.kinks >= KINKED

    @property
    def sticking(self) -> bool:
        """Whether joints stick and slide to save effort; only the part of the integrals counts."""
        return (1.0 - self.ends) * self.friction >= STICKING

    @property
    def rubbing(self) -> bool:
        """Whether dry friction matters beside the torques, whatever the objective."""
        return self.friction >= STICKING


_KNOWN: WeakKeyDictionary[Problem, Shares] = WeakKeyDictionary()


def shares_of(problem: Problem) -> Shares:
    """Return the shares of a problem; they are computed once."""
    if problem not in _KNOWN:
        _KNOWN[problem] = _new_shares(problem)
    return _KNOWN[problem]


def has_kinks(problem: Problem) -> bool:
    """Whether kinks matter; a problem without any is not measured."""
    return any(is_kinked(phase.dae) for phase in problem.phases) and shares_of(problem).kinked


def _new_shares(problem: Problem) -> Shares:
    sums = {"end": 0.0, "kinked": 0.0, "smooth": 0.0}
    for phase in problem.phases:
        for kind, size in _sizes(phase):
            sums[kind] += size
    total = sum(sums.values()) or 1.0
    ends = sums["end"] / total
    kinks = 1.0 if any(map(_has_kinked_rows, problem.phases)) else sums["kinked"] / total
    measured = all(map(_is_measured, problem.phases))
    rate = total / sum(_motion(phase).duration for phase in problem.phases) if measured else 0.0
    return Shares(ends, kinks, max(map(_friction, problem.phases)), rate)


def _kinds(phase: Phase) -> list[str]:
    """Return the kind of each term, those of the end points first."""
    kinds = ["end" for _ in phase.end_costs]
    return kinds + ["kinked" if is_kinked(term.augment(phase.body)) else "smooth" for _, term in phase.integrals]


def _is_measured(phase: Phase) -> bool:
    """Whether the sizes of terms are those along a plain motion; terms of one kind need none."""
    return len(set(_kinds(phase))) > 1 and _has_plain_motion(phase)


def _sizes(phase: Phase) -> Sequence[tuple[str, float]]:
    """Return kind and size of each term."""
    kinds = _kinds(phase)
    if not _is_measured(phase):
        # Without a motion to measure, a kink or else an integral counts as the whole.
        sole = next((kind for kind in ("kinked", "smooth", "end") if kind in kinds), None)
        return [] if sole is None else [(sole, 1.0)]
    with np.errstate(all="ignore"):
        values = np.abs(np.nan_to_num(_values(phase), nan=0.0, posinf=0.0, neginf=0.0))
    return list(zip(kinds, values.tolist(), strict=True))


def is_kinked(dynamics: Dynamics) -> bool:
    """Whether an objective or a constraint that is not smooth has added variables."""
    while isinstance(dynamics, Augmented):
        if not dynamics.smooth:
            return True
        dynamics = dynamics.inner
    return False


def _has_kinked_rows(phase: Phase) -> bool:
    """Whether kinks are those of constraints, whatever the objective; on a path only the timing is left to choose."""
    terms = (term.augment(phase.body) for _, term in phase.integrals)
    return phase.path is None and is_kinked(phase.dae) and not any(map(is_kinked, terms))


def _has_plain_motion(phase: Phase) -> bool:
    return phase.path is None and is_exact(phase, (HermiteSimpson(),))


def _motion(phase: Phase) -> PhaseGuess:
    """Return the plain motion of a robot with a motor at every joint."""
    robot = phase.robot
    assert robot is not None
    first, last = (state[: robot.nq] for state in ends_of(phase))
    duration = guessed_duration(phase, None)

    def motion(s: Array) -> tuple[Array, Array, Array]:
        way, t = last - first, s[:, None]
        place, pace, bend = (t**3 * (10 - 15 * t + 6 * t**2), 30 * (t - t**2) ** 2, 60 * t * (1 - t) * (1 - 2 * t))
        return first + place * way, pace * way / duration, bend * way / duration**2

    return with_copies(joint_motion(phase, duration, motion, default_parameters(phase)), phase.dae)


def _values(phase: Phase) -> Array:
    """Return the values of the terms of the end points, then of the integrals, along the plain motion."""
    rows, motion = phase.rows, _motion(phase)
    symbols, point = rows.symbols, rows.point
    t, x, _, _, p = symbols
    s, y = ca.SX.sym("s"), ca.SX.sym("y", x.numel())
    last = phase.dae.point(s, y, None, None, p, phase.parameter_names)
    costs = [weight * as_rows(term.value(point, last), "Mayer expression")[0] for weight, term in phase.end_costs]
    rates = [weight * as_rows(term.rate_of_motion(point), "integrand")[0] for weight, term in phase.integrals]
    ends = ca.Function("ends", [t, x, s, y, p], [ca.vertcat(ca.SX(0, 1), *costs)])
    along = ca.Function("along", [*symbols], [ca.densify(ca.vertcat(ca.SX(0, 1), *rates))])
    parameters = np.array([motion.parameters[name] for name in phase.parameter_names])
    states = motion.states(PLACES)
    columns = (PLACES[None] * motion.duration, states.T, motion.algebraic(PLACES).T, _controls(phase, motion).T)
    values = along.map(len(PLACES))(*columns, np.tile(parameters[:, None], len(PLACES)))
    first, final = motion.states(np.array([0.0, 1.0]))
    known = np.array(ends(0.0, first, motion.duration, final, parameters)).ravel()
    return np.concatenate([known, motion.duration * (np.array(values) @ WEIGHTS)])


def _controls(phase: Phase, motion: PhaseGuess) -> Array:
    """Return the controls at ``PLACES``; those that are rates of states, such as jerks, by central differences."""
    values = np.array(motion.controls(PLACES))
    slopes = (motion.states(PLACES + DIFFERENCE) - motion.states(PLACES - DIFFERENCE)) / (
        2.0 * DIFFERENCE * motion.duration
    )
    t, x, z, u, p = phase.rows.symbols
    slope = ca.jacobian(phase.dae.rates(phase.rows.point), u)
    for state, control in zip(*ca.Sparsity(slope.sparsity()).get_triplet(), strict=True):
        values[:, control] = slopes[:, state]
    return values


def _friction(phase: Phase) -> float:
    """Return the size of dry friction relative to the torques; 0 without, infinite where there is no motion.

    It is 0 on a given path, too, which determines where joints reverse.
    """
    robot = phase.robot
    if robot is None or robot.root != "fixed" or isinstance(phase.dynamics, Kinematics) or not robot.friction.any():
        return 0.0
    if phase.path is not None:
        return 0.0
    if not _has_plain_motion(phase):
        return np.inf
    motion = _motion(phase)
    names = [variable.name for variable in phase.dae.controls]
    columns = [names.index(f"tau.{joint}") for joint in robot.actuated if f"tau.{joint}" in names]
    torques = motion.controls(PLACES)[:, columns]
    size = float(np.sqrt(WEIGHTS @ (torques**2).sum(axis=1)))
    return float(np.linalg.norm(robot.friction)) / size if size > 0.0 else np.inf
