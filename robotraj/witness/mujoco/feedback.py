"""Feedback that stabilises a robot on its plan: tau = tau_plan - K(t) e, with e the deviation of the state.

A new kind of feedback is one new class.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import scipy

from robotraj._util.arrays import Array
from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solution.feedback.riccati import backwards
from robotraj.witness.contacts.constrained import mass_and_bias
from robotraj.witness.mujoco.feet import landing_feet
from robotraj.witness.mujoco.linear import LinearPhase
from robotraj.witness.mujoco.reference_motion import ReferenceMotion
from robotraj.witness.planned import robot_sample

PIECE = 0.005
"""Longest time [s] for which gains are constant."""


class Feedback(OneLine, ABC):
    """Feedback on the deviation e = (difference(q_plan, q), v - v_plan), 2 nv entries."""

    @abstractmethod
    def gains(self, course: ReferenceMotion) -> tuple[Array, ...]:
        """Return gains (n, nu, 2 nv) of each phase on n pieces of equal duration, in the coordinates of the plan."""


@dataclass(frozen=True)
class NoFeedback(Feedback):
    """The planned torques alone."""

    def gains(self, course: ReferenceMotion) -> tuple[Array, ...]:
        """Return zeros."""
        shape = (1, course.nu, 2 * course.robot.model.nv)
        return tuple(np.zeros(shape) for _ in course.phases)

    def __str__(self) -> str:
        return "no feedback"


@dataclass(frozen=True)
class JointFeedback(Feedback):
    """Decoupled joint feedback: tau_j = tau_plan_j - M_jj (w^2 e_j + 2 z w edot_j), as motor drives do.

    M_jj is the inertia of the joint with all others locked, at the planned position.

    Parameters
    ----------
    frequency : float
        w / 2 pi [Hz].
    damping : float
        Damping ratio z.

    Raises
    ------
    InputError
        A value is not positive.
    """

    frequency: float = 5.0
    damping: float = 1.0

    def __post_init__(self) -> None:
        _positive(self, "frequency", "damping")

    def gains(self, course: ReferenceMotion) -> tuple[Array, ...]:
        """Return gains from the inertias along the plan."""
        model = course.robot.model
        data = model.createData()
        actuation = np.asarray(course.robot.actuation, dtype=float)
        rate = 2.0 * np.pi * self.frequency

        def gain(q: Array) -> Array:
            inertia = actuation.T * np.diag(mass_and_bias(model, data, q, np.zeros(model.nv))[0])
            return np.hstack([rate**2 * inertia, 2.0 * self.damping * rate * inertia])

        return tuple(np.array([gain(q) for q in course.reference(p, _middles(course, p)).q]) for p in _all(course))

    def __str__(self) -> str:
        return f"joint feedback, {self.frequency:g} Hz, damping ratio {self.damping:g}"


@dataclass(frozen=True)
class LinearQuadratic(Feedback):
    """The time-varying linear quadratic regulator along the plan with its contacts, periodic if the plan is.

    It minimises the integral of the sum of (e_q / position)^2, (e_v / velocity)^2 and (u / (effort tau_scale))^2. The
    scale of a motor is its largest planned torque, and at least a fifth of the largest of all.
    Source: Tedrake, Underactuated Robotics, chapter 8 (time-varying LQR).

    Parameters
    ----------
    position : float
        Deviation of a position [rad, m] with cost 1.
    velocity : float
        Deviation of a velocity [rad/s, m/s] with cost 1.
    effort : float
        Torque with cost 1, as a fraction of tau_scale.

    Raises
    ------
    InputError
        A value is not positive.
    """

    position: float = 0.05
    velocity: float = 2.0
    effort: float = 1.0

    def __post_init__(self) -> None:
        _positive(self, "position", "velocity", "effort")

    def gains(self, course: ReferenceMotion) -> tuple[Array, ...]:
        """Return the gains of Riccati's recursion, over as many periods as it takes to converge."""
        nv = course.robot.model.nv
        weight = np.repeat([1.0 / self.position, 1.0 / self.velocity], nv)
        price = np.diag(1.0 / (self.effort * _torque_scales(course)))
        phases = [_LinearPieces.of(course, phase) for phase in _all(course)]
        root, gains = np.diag(weight), [np.empty(0) for _ in phases]
        for _ in range(1 if course.closing is None else _MOST_SWEEPS):
            before = root.T @ root
            for i, phase in reversed(list(enumerate(phases))):
                root, gains[i] = phase.backwards(root, weight, price)
                root = root @ phase.entry
            cost = root.T @ root
            if np.max(np.abs(cost - before)) < 1e-6 * np.max(np.abs(cost)):
                break
        return tuple(gains)

    def __str__(self) -> str:
        return (
            f"time-varying LQR, {self.position:g} rad or m ~ {self.velocity:g} rad/s or m/s ~ {self.effort:g} of a "
            "motor's torque"
        )


IDLE = 0.2
"""Least scale of a motor's torque, as a share of the largest."""

_MOST_SWEEPS = 50
"""Largest number of periods of Riccati's recursion."""


@dataclass(frozen=True)
class _LinearPieces:
    """A linearised phase: the map from the end of the phase before to its start, and the pieces of the phase."""

    entry: Array
    pieces: list[tuple[Array, Array]]
    duration: float

    @classmethod
    def of(cls, course: ReferenceMotion, phase: int) -> _LinearPieces:
        planned = course.phases[phase]
        linear = LinearPhase(course.robot, planned.phase.bound_contacts)
        middles = _middles(course, phase)
        duration = course.durations[phase] / len(middles)
        pieces = [
            linear.step(q, v, tau, duration, pushing)
            for q, v, tau, pushing in zip(
                *course.reference(phase, middles), course.pushing(phase, middles), strict=True
            )
        ]
        return cls(_entry(course, phase, linear), pieces, duration)

    def backwards(self, root: Array, weight: Array, price: Array) -> tuple[Array, Array]:
        """Return the root of the cost to go at the start from that at the end, and the gains in between."""
        size = np.sqrt(self.duration)
        root, gains = backwards(root, self.pieces, [(size * weight, size * price)] * len(self.pieces))
        return root, np.array(gains)


def _entry(course: ReferenceMotion, phase: int, linear: LinearPhase) -> Array:
    """Return the matrix (2 nv, 2 nv) from a deviation at the end of the phase before to one at the start of a phase."""
    planned = course.phases[phase - 1]
    end = robot_sample(planned, planned.knots[-1:])
    rate = np.concatenate([end.v[0], end.a[0]])
    # At the start of a periodic plan the phase before is the last one, mirrored where the plan is half a gait.
    around = course.closing is not None and phase == 0
    mirrored = course.closing.velocities if around and course.closing else np.eye(course.robot.model.nv)
    seen = scipy.linalg.block_diag(mirrored, mirrored)
    feet = landing_feet(course, phase)
    return linear.touchdown(course.reference(phase, np.zeros(1)).q[0], seen @ rate, feet, course.root) @ seen


def _all(course: ReferenceMotion) -> range:
    return range(len(course.phases))


def _middles(course: ReferenceMotion, phase: int) -> Array:
    """Return the middles of the pieces of a phase, since its start [s]."""
    duration = course.durations[phase]
    count = max(1, int(np.ceil(duration / PIECE)))
    return duration * (np.arange(count) + 0.5) / count


def _torque_scales(course: ReferenceMotion) -> Array:
    """Return the scales (nu,) of the motors [N m, N]: the largest planned torque, or ``IDLE`` of the largest of all.

    Effort limits of URDFs are often placeholders, so they bound the scales only.
    """
    planned = np.max([np.abs(course.reference(p, _middles(course, p)).tau).max(axis=0) for p in _all(course)], axis=0)
    scales = np.maximum(planned, IDLE * planned.max(initial=0.0))
    bound = np.max([np.abs(course.efforts(p)).max(axis=0) for p in _all(course)], axis=0)
    scales = np.where(np.isfinite(bound), np.where(scales > 0, np.minimum(scales, bound), bound), scales)
    return np.where(scales > 0, scales, 1.0)


def _positive(value: Feedback, *names: str) -> None:
    for name in names:
        number = getattr(value, name)
        if not (is_finite(number) and number > 0):
            raise InputError(f"{name} = {number!r} of {type(value).__name__} must be a positive number.")
