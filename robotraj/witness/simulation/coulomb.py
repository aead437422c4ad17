"""Simulation of a plan by Coulomb's law with sticking: a machine with dry friction under the planned torques.

Dry friction is set-valued. A joint that slides has the force -F sign(v), and one at rest any force between -F and F.
A step of the length h from v to v+ solves, at its middle,

    M (v+ - v) = h (B tau - bias - springs - D v+) + J' mu + lambda,    J v+ = 0,
    lambda_i = -h F_i sign(v+_i),  or  |lambda_i| <= h F_i where v+_i = 0.

tau are the planned torques and those of ``solution.gains``, no more than the limits of effort. Damping acts at the end
of the step, where it is stable for light joints. Nothing is smoothed, so that the plan's own law of friction does not
enter. Which joints stick follows by pivoting from the step before.
Source: Stewart and Trinkle, An implicit time-stepping scheme for rigid body dynamics with inelastic collisions and
Coulomb friction, Int. J. Numer. Meth. Eng. 39 (1996); Murty, Linear Complementarity (1988), section 4.1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.design.binding import realised
from robotraj.robot.coupling.dynamics import mass_matrix
from robotraj.robot.tangent import difference, floats
from robotraj.solution.feedback.gains import PhaseGains
from robotraj.witness.contacts.constrained import RANK_TOLERANCE, Held
from robotraj.witness.contacts.stance import Stance
from robotraj.witness.planned import limits_of, robot_sample
from robotraj.witness.plants.robot_plant import RobotPlant
from robotraj.witness.plants.sizes import sizes_of
from robotraj.witness.protocols import PhaseSolutionLike, SolutionLike
from robotraj.witness.simulation.drift import Drift, DriftRow, drift_of, merge
from robotraj.witness.simulation.spans import Motion

STEPS = 2000
"""Steps of the whole motion; the deviation changes by less than a tenth with twice as many."""
LONGEST = 5e-3
"""Longest step [s]: a hundredth of the period of the feedback."""
WITHIN = 1e-9
"""Excess over a bound of torque or friction, relative to it, that is rounding."""
PIVOTS = 4
"""Pivots of all wrong joints at once; then the last one alone moves, which ends after a finite number."""


def has_dry_friction(planned: PhaseSolutionLike) -> bool:
    """Whether a joint of a phase has dry friction."""
    robot = planned.phase.robot
    return robot is not None and bool(np.any(np.asarray(robot.friction) > 0.0))


def keeps_smooth_law(planned: PhaseSolutionLike) -> bool:
    """Whether the plan of a phase is made by the smooth law alone: robots with a free root (``SharpFriction``)."""
    robot = planned.phase.robot
    return robot is not None and has_dry_friction(planned) and floats(robot.model)


def coulomb_drift(solution: SolutionLike, clock: Callable[[], None] = lambda: None) -> Drift | str | None:
    """Return the deviations of the simulated machine's positions from the plan, each phase from its planned state.

    Returns
    -------
    Drift, str or None
        The reason where there is no simulation; None without dry friction.
    """
    rough = [has_dry_friction(planned) for planned in solution.phases]
    if not any(rough):
        return None
    if any(not contact.holds for planned in solution.phases for contact in planned.phase.bound_contacts):
        return "contacts are implicit, and their forces on a deviating robot are not known"
    try:
        gains = solution.gains.phases
    except InputError as error:
        return str(error)
    sizes = sizes_of(solution)
    whole = sum(float(planned.knots[-1] - planned.knots[0]) for planned in solution.phases)
    rows: list[tuple[DriftRow, ...]] = []
    for planned, feedback, own, is_rough in zip(solution.phases, gains, sizes, rough, strict=True):
        if is_rough and planned.knots[-1] > planned.knots[0]:
            motion = _simulated(planned, feedback, whole, clock)
            drift = drift_of(RobotPlant(planned), motion, str(planned.phase.name), own)
            # A joint that breaks away jumps in speed, hardly in position.
            rows.append(tuple(row for row in drift if row.name.startswith("q.")))
    return merge(rows) if rows else None


def _simulated(planned: PhaseSolutionLike, feedback: PhaseGains, whole: float, clock: Callable[[], None]) -> Motion:
    knots = np.asarray(planned.knots, dtype=float)
    first, last = float(knots[0]), float(knots[-1])
    count = int(np.ceil((last - first) / min(LONGEST, whole / STEPS) * (1.0 - 1e-9)))
    times = np.linspace(first, last, count + 1)
    middles = 0.5 * (times[1:] + times[:-1])
    sample, gains = robot_sample(planned, middles), feedback.at(middles)
    step = _Step(planned, (last - first) / count)
    begin = robot_sample(planned, times[:1], 0)
    q, v, change = begin.q[0], begin.v[0], np.zeros(begin.v.shape[1])
    states = [np.concatenate([q, v])]
    for k in range(count):
        clock()
        q, v, change = step(q, v, change, _PlannedMiddle(sample.tau[k], sample.q[k], sample.v[k], gains[k]))
        states.append(np.concatenate([q, v]))
        if not np.isfinite(states[-1]).all():
            break
    reached = times[: len(states)]
    inside = np.clip(np.searchsorted(knots, reached, side="right") - 1, 0, len(knots) - 2)
    failure = None if len(states) == count + 1 else "the motion diverges"
    return Motion(reached, np.array(states), inside, failure, float(reached[-1]))


class _PlannedMiddle(NamedTuple):
    """The plan at the middle of a step: torques, state, and gains."""

    torques: Array
    q: Array
    v: Array
    gains: Array


class _Step:
    """Steps of one length [s] of a phase."""

    def __init__(self, planned: PhaseSolutionLike, length: float) -> None:
        robot = realised(planned)
        self._robot, self._model, self._data, self._length = robot, robot.model, robot.model.createData(), length
        self._actuation = np.asarray(robot.actuation, dtype=float)
        self._damping = np.diag(np.broadcast_to(np.asarray(robot.damping, dtype=float), robot.model.nv))
        friction = np.asarray(robot.friction, dtype=float)
        self._rough = np.flatnonzero(friction > 0.0)
        self._most = np.asarray(length * friction[self._rough], dtype=float)
        self._sliding = np.zeros(len(self._rough))
        limits = limits_of(planned)
        motors = [list(robot.velocity_names).index(joint) for joint in robot.actuated]
        free = np.full(len(motors), np.inf)
        sides = (-free, free) if limits is None else tuple(side[motors] for side in limits.sides("effort"))
        self._low, self._high = np.asarray(sides, dtype=float)
        contacts = planned.phase.bound_contacts
        self._stance = Stance(robot, contacts, planned.parameters) if contacts else None

    def __call__(self, q: Array, v: Array, change: Array, given: _PlannedMiddle) -> tuple[Array, Array, Array]:
        """Return q, v and the acceleration after a step; ``change`` is the acceleration of the step before."""
        model, h, nv = self._model, self._length, self._model.nv
        half = v + 0.5 * h * change
        middle = pin.integrate(model, q, 0.5 * h * (v + 0.25 * h * change))
        mass = mass_matrix(model, self._data, middle)
        still = np.zeros(nv)
        loads = pin.nonLinearEffects(model, self._data, middle, half) + self._robot.resistance(middle, still)
        rows = None if self._stance is None else self._stance.rows(middle, half)
        stiff, drag = given.gains[:, :nv], given.gains[:, nv:] + 0.5 * h * given.gains[:, :nv]
        away = difference(model, given.q, q) if floats(model) else q - given.q
        planned = given.torques - stiff @ away + given.gains[:, nv:] @ given.v
        held = np.zeros(len(planned), dtype=bool)
        while True:
            # Feedback acts on the mean of v and v+; motors at their limits have none.
            feedback = 0.5 * h * (self._actuation * ~held) @ drag
            right = mass @ v + h * (self._actuation @ planned - loads) - feedback @ v
            after = self._after(mass + h * self._damping + feedback, right, rows)
            torques = np.where(held, planned, planned - drag @ (0.5 * (v + after)))
            bounded = np.clip(torques, self._low, self._high)
            over = ~held & (np.abs(bounded - torques) > WITHIN * np.abs(bounded))
            if not over.any():
                break
            held |= over
            planned = np.where(over, bounded, planned)
        return np.asarray(pin.integrate(model, q, 0.5 * h * (v + after))), after, (after - v) / h

    def _after(self, matrix: Array, right: Array, rows: Held | None) -> Array:
        """Return v+ with the impulses of friction, and of contacts that hold."""
        try:
            inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
        except np.linalg.LinAlgError:
            return np.full(len(right), np.nan)
        if rows is not None:
            jacobian = rows.jacobian
            response = inverse @ jacobian.T
            inverse = inverse - response @ np.linalg.pinv(jacobian @ response, rcond=RANK_TOLERANCE**2) @ (
                jacobian @ inverse
            )
        free, joints = np.asarray(inverse @ right, dtype=float), self._rough
        impulses, self._sliding = dry_impulses(inverse[np.ix_(joints, joints)], free[joints], self._most, self._sliding)
        return np.asarray(free + inverse[:, joints] @ impulses)


def dry_impulses(response: Array, free: Array, most: Array, sliding: Array) -> tuple[Array, Array]:
    """Return the impulses of Coulomb's friction, and the signs of the velocities after them, 0 where joints stick.

    Parameters
    ----------
    response : ndarray (n, n)
        P: impulses p change the velocities by P p.
    free : ndarray (n,)
        Velocities without friction.
    most : ndarray (n,)
        Largest impulses h F, above 0.
    sliding : ndarray (n,)
        Signs of the velocities to begin with.
    """
    sliding, count = sliding.copy(), len(most)
    impulses = np.zeros(count)
    for pivot in range(PIVOTS * count + 2 ** min(count, 10)):
        stuck = sliding == 0.0
        impulses = -sliding * most
        if stuck.any():
            wanted = -(free + response @ impulses)[stuck]
            impulses[stuck] = np.linalg.lstsq(response[np.ix_(stuck, stuck)], wanted, rcond=None)[0]
        velocities = free + response @ impulses
        slips = stuck & (np.abs(impulses) > (1.0 + WITHIN) * most)
        turns = ~stuck & (sliding * velocities < 0.0)
        wrong = np.flatnonzero(slips | turns)
        if not len(wrong) or not np.isfinite(velocities).all():
            break
        for i in wrong if pivot < PIVOTS else wrong[-1:]:
            sliding[i] = -np.sign(impulses[i]) if slips[i] else 0.0
    return impulses, sliding
