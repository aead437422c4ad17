"""Planned torques and contact forces against those that the planned motion needs.

Pinocchio's inverse dynamics give what the planned motion needs, r = RNEA(q, v, dv/dt) + d(v) - B tau - J' f. Between
the collocation points r alternates, and collocation integrates it to nearly zero. The impulse that is missing over a
window therefore measures a wrong torque, force, mass or gravity, whatever the mesh:

    error = max_i max_w |integral_w r_i dt| / (s_i |w|)

s_i is the joint's own load: the largest of motor torque, gravity, inertia and contact forces in the motion, and of the
force that gives the joint its momentum (M v)_i within the time of the phase. It is at least ``SHARE`` of the largest
among joints of the same unit. A machine that is slow or light has small loads, and its force
is judged by these.

What a plan stores at its collocation points is compared with its motion (``stored_inputs``), relative to s_i too.

Positions are compared with velocities by the same measure, and inside each window too, since a position that is wrong
between two ends of windows is seen there alone:

    error = max_i max_w max_(t in w) |integral_(begin of w)^t (dq/dt - v)_i dt| / (s_i |w|)

Here s_i is the size of the velocity in the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache

import numpy as np
import pinocchio as pin
from numpy.polynomial import chebyshev

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.size.state_sizes import error_window
from robotraj.robot.tangent import velocities
from robotraj.witness.checks.residual import TORQUE_UNITS
from robotraj.witness.checks.stored_inputs import stored_off
from robotraj.witness.contacts.stance import Stance, forces_in
from robotraj.witness.planned import robot_sample
from robotraj.witness.plants.plant import RATE_UNITS
from robotraj.witness.protocols import PhaseSolutionLike
from robotraj.witness.sampling import interval_samples, time_derivative

SAMPLES = 17
"""Chebyshev points of an interval, exact for polynomials of degree 16."""
SHARE = 1e-2
"""Least load of a joint relative to the largest among joints of its unit."""
ROUNDING = 1e-6
"""Least load relative to the largest of all, in SI units: rounding errors of joints without a load are no errors."""


@dataclass(frozen=True)
class JointError(OneLine):
    """An error of one joint in a phase.

    Attributes
    ----------
    joint, phase, unit : str
    amount, size : float
        The error, and what it is relative to [unit].
    """

    joint: str
    phase: str
    unit: str
    amount: float
    size: float

    @property
    def relative(self) -> float:
        """``amount`` / ``size``."""
        return self.amount / self.size


@dataclass(frozen=True)
class TorqueError(JointError):
    """The largest mean error of a generalised force over a window.

    ``amount`` is what the motion needs and the plan does not give, ``size`` the joint's load in the motion.

    Attributes
    ----------
    time : float
        Middle of the window [s].
    """

    time: float

    def __str__(self) -> str:
        return (
            f"{self.joint}, t = {self.time:.4g} s: {self.amount:.3g} {self.unit} missing, "
            f"{100 * self.relative:.2g} percent of {self.size:.3g} {self.unit}"
        )


@dataclass(frozen=True)
class RateError(JointError):
    """The largest mean difference over a window of a planned velocity from the derivative of the planned position.

    ``amount`` is the mean of dq/dt - v, ``size`` that of the velocity in the motion.

    Attributes
    ----------
    time : float
        End of the mean [s].
    """

    time: float


@dataclass(frozen=True)
class _Missing(OneLine):
    """Missing impulses of the intervals (K, nv) with their ends (K,), and the largest loads (nv,) of one phase.

    ``stored`` (nv,) is how far what the phase stores is off its motion (``stored_inputs``).
    """

    planned: PhaseSolutionLike
    begins: Array
    ends: Array
    impulses: Array
    loads: Array
    stored: Array


def rate_error(phases: Sequence[PhaseSolutionLike], sizes: Sequence[Array]) -> RateError | None:
    """Return the largest error of a velocity over all robots' phases; None without a robot.

    Parameters
    ----------
    phases : sequence of PhaseSolution
    sizes : sequence of ndarray (2 nv,)
        Sizes of the differences of states of every phase.
    """
    pairs = zip(phases, sizes, strict=True)
    found = [_rate_error(planned, own) for planned, own in pairs if planned.phase.robot is not None]
    return max((row for row in found if row is not None), key=lambda row: row.relative, default=None)


def _rate_error(planned: PhaseSolutionLike, sizes: Array) -> RateError | None:
    robot = realised(planned)
    own = sizes[robot.model.nv :]
    times, begins, ends, gained = [], [], [], []
    for part in interval_samples(planned, SAMPLES):
        sample = robot_sample(planned, part.times, part.interval)
        gaps = velocities(robot.model, sample.q, time_derivative(sample.q, part)) - sample.v
        by_interval = np.nan_to_num(gaps, nan=np.inf).reshape(len(part.intervals), SAMPLES, -1)
        halves = 0.5 * (part.ends - part.begins)
        gained.append(halves[:, None, None] * np.einsum("ts,ksj->ktj", _integration(SAMPLES), by_interval))
        times.append(part.times.reshape(len(part.intervals), SAMPLES))
        begins.append(part.begins)
        ends.append(part.ends)
    if not times:
        return None
    gains, places = np.concatenate(gained), np.concatenate(times)
    worst: RateError | None = None
    for first, last, length in _windows(np.concatenate(begins), np.concatenate(ends), error_window(robot)):
        within = gains[first : last + 1]
        with np.errstate(invalid="ignore"):
            before = np.cumsum(np.vstack([np.zeros((1, len(own))), within[:-1, -1]]), axis=0)
            mean = np.nan_to_num(np.abs(before[:, None] + within) / length, nan=np.inf)
        k, i, j = np.unravel_index(int(np.argmax(mean / own)), mean.shape)
        found = RateError(
            robot.velocity_names[j],
            str(planned.phase.name),
            RATE_UNITS[robot.units[j]],
            float(mean[k, i, j]),
            float(own[j]),
            float(places[first + k, i]),
        )
        worst = found if worst is None or found.relative > worst.relative else worst
    return worst


def _windows(begins: Array, ends: Array, window: float) -> Iterator[tuple[int, int, float]]:
    """Yield the first and last intervals of windows with their lengths [s]: whole intervals, at least ``window``."""
    first = 0
    while first < len(ends):
        reached = int(np.searchsorted(ends, begins[first] + window * (1.0 - 1e-9)))
        last = min(reached, len(ends) - 1)
        yield first, last, float(ends[last] - begins[first])
        first = last + 1


def torque_error(
    phases: Sequence[PhaseSolutionLike], clock: Callable[[], None] = lambda: None, stored: bool = False
) -> TorqueError | None:
    """Return the worst error of torques and contact forces over all robots' phases; None without a robot.

    Phases with the same joints share their loads. What they have ``stored`` is compared, too, where it is that of a
    proved plan: on a coarse mesh of one's own it differs from the motion between its points.
    """
    parts = [_missing(planned, clock, stored) for planned in phases if planned.phase.robot is not None]
    found = [row for part in parts for row in _errors(part, parts)]
    return max(found, key=lambda row: row.relative, default=None)


def _errors(part: _Missing, parts: Sequence[_Missing]) -> list[TorqueError]:
    """Return the worst window of every joint of a phase."""
    robot = realised(part.planned)
    names, units = list(robot.velocity_names), np.array(robot.units)
    alike = [p.loads for p in parts if list(realised(p.planned).velocity_names) == names]
    own = np.max(alike, axis=0)
    least = ROUNDING * own.max(initial=0.0)
    sizes = np.array([max(own[i], SHARE * own[units == unit].max(), least) for i, unit in enumerate(units)])
    sizes = np.where(sizes > 0.0, sizes, 1.0)
    sums = np.vstack([np.zeros(len(names)), np.cumsum(part.impulses, axis=0)])
    worst = part.stored
    times = np.full(len(names), part.begins[0] if len(part.begins) else 0.0)
    for first, last, length in _windows(part.begins, part.ends, error_window(robot)):
        with np.errstate(invalid="ignore"):
            # A torque that is not a number makes the sums so, and is the worst.
            mean = np.nan_to_num(np.abs(sums[last + 1] - sums[first]) / length, nan=np.inf)
        better = mean > worst
        worst, times = np.where(better, mean, worst), np.where(better, part.begins[first] + 0.5 * length, times)
    phase = str(part.planned.phase.name)
    return [
        TorqueError(name, phase, TORQUE_UNITS[units[i]], float(worst[i]), float(sizes[i]), float(times[i]))
        for i, name in enumerate(names)
    ]


def _missing(planned: PhaseSolutionLike, clock: Callable[[], None], stored: bool) -> _Missing:
    """Integrate the missing forces of every interval by Clenshaw and Curtis's rule."""
    robot = realised(planned)
    model, data = robot.model, robot.model.createData()
    actuation = np.asarray(robot.actuation, dtype=float)
    contacts = planned.phase.bound_contacts
    stance = Stance(robot, contacts, planned.parameters)
    weights = _weights(SAMPLES)
    begins: list[Array] = []
    ends: list[Array] = []
    impulses: list[Array] = []
    loads = np.zeros(model.nv)
    still = np.zeros(model.nv)
    duration = float(planned.knots[-1] - planned.knots[0])
    for part in interval_samples(planned, SAMPLES):
        clock()
        sample = robot_sample(planned, part.times, part.interval)
        acceleration = time_derivative(sample.v, part)
        missing = np.zeros((len(part.times), model.nv))
        for i, (q, v, a, tau) in enumerate(zip(sample.q, sample.v, acceleration, sample.tau, strict=True)):
            motors = actuation @ tau
            pushed = stance.torques(q, forces_in(sample, contacts, i)) if contacts else still
            missing[i] = pin.rnea(model, data, q, v, a) + robot.resistance(q, v) - motors - pushed
            if i % SAMPLES == SAMPLES // 2:
                weight = pin.rnea(model, data, q, still, still).copy()
                inertia = pin.rnea(model, data, q, still, a) - weight
                momentum = pin.rnea(model, data, q, still, sample.v[i]) - weight
                forces = motors, pushed, weight, inertia, momentum / duration
                loads = np.max([loads, *map(np.abs, forces)], axis=0)
        lengths = part.ends - part.begins
        by_interval = missing.reshape(len(part.intervals), SAMPLES, -1)
        impulses.append(lengths[:, None] * np.einsum("s,ksj->kj", weights, np.nan_to_num(by_interval, nan=np.inf)))
        begins.append(part.begins)
        ends.append(part.ends)
    if not begins:
        return _Missing(planned, np.zeros(0), np.zeros(0), np.zeros((0, model.nv)), loads, still)
    return _Missing(
        planned,
        np.concatenate(begins),
        np.concatenate(ends),
        np.vstack(impulses),
        loads,
        stored_off(planned) if stored else still,
    )


def _weights(count: int) -> Array:
    """Return the weights of Clenshaw and Curtis's rule on [0, 1] at Chebyshev-Lobatto points, (count,)."""
    sites = chebyshev.chebpts2(count)
    moments = np.array([0.0 if k % 2 else 1.0 / (1.0 - k * k) for k in range(count)])
    return np.asarray(np.linalg.solve(chebyshev.chebvander(sites, count - 1).T, moments))


@lru_cache(maxsize=1)
def _integration(count: int) -> Array:
    """Return the matrix from values at Chebyshev-Lobatto points of [-1, 1] to integrals from -1 to each."""
    sites = chebyshev.chebpts2(count)
    sums = [chebyshev.chebval(sites, chebyshev.chebint(unit, lbnd=-1.0)) for unit in np.eye(count)]
    return np.asarray(np.column_stack(sums) @ np.linalg.inv(chebyshev.chebvander(sites, count - 1)))
