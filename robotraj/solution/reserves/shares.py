"""How much of friction cones, soles, torques and speeds a plan with contacts uses, and for how long.

A plan that uses all of them leaves nothing to a controller: seven proved gaits of this kind fell in a second simulator.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, cast

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.force_measure import GRAVITY
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.point import FramePoint
from robotraj.problem.phase import Phase
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.solution.sample import Sample

KINDS = ("cone", "sole", "torque", "speed")
PLACES = 9
"""Samples of an interval, its ends included."""
HIGH = 0.9
"""Share from which on the time counts."""
LOADED = 0.02
"""Normal force relative to the weight below which a contact's share is not counted: it is that of two small numbers."""


class LoadedPhase(Protocol):
    """The planned motion of one phase."""

    @property
    def phase(self) -> Phase:
        """The phase."""

    @property
    def knots(self) -> Array:
        """Ends of the intervals [s]."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values of the phase's parameters."""

    def at(self, t: Array, interval: NDArray[np.int_] | None = None) -> Sample[Any]:
        """Evaluate at times."""


@dataclass(frozen=True)
class Share(OneLine):
    """The largest share of one kind that a plan uses, over its phases, contacts and joints.

    Attributes
    ----------
    kind : str
        ``"cone"``: |f_t| / (mu f_n). ``"sole"``: way of the centre of pressure from the middle to the edge.
        ``"torque"`` and ``"speed"``: of the limits of the phase, or of the robot if it has none.
    name : str
        Contact or joint with the largest share.
    largest : float
        1 is all.
    time : float
        Time of the largest share [s].
    high : float
        Time during which the share of any contact or joint is above 0.9 [s].
    """

    kind: str
    name: str
    largest: float
    time: float
    high: float

    def __str__(self) -> str:
        long = f", above 90 % for {self.high:.2g} s" if self.high > 0.0 else ""
        return f"{100.0 * self.largest:.0f} % of {self.kind} ({self.name}{long})"


REMEDIES = {
    "cone": "more friction",
    "sole": "larger soles",
    "torque": "higher effort limits or a lighter load",
    "speed": "higher velocity limits or longer phases",
}
"""What eases a motion that uses all of one kind."""


def used_up(shares: Sequence[Share]) -> list[Share]:
    """Return the shares of what is used up nearly or wholly, the largest first."""
    return sorted((share for share in shares if share.largest >= HIGH), key=lambda share: -share.largest)


def shares_of(phases: Sequence[LoadedPhase]) -> tuple[Share, ...]:
    """Return the shares of a plan, in the order of ``KINDS``; none where no phase has a contact with friction."""
    if not any(np.isfinite(contact.contact.friction) for p in phases for contact in p.phase.bound_contacts):
        return ()
    found: dict[str, Share] = {}
    for planned in phases:
        if planned.phase.robot is None:
            continue
        times, which = _times(np.asarray(planned.knots, dtype=float))
        sample = planned.at(times, which)
        weights = np.gradient(times) if len(times) > 1 else np.zeros(1)
        values: dict[str, dict[str, Array]] = {kind: {} for kind in KINDS}
        for kind, name, share in (*_of_contacts(planned, sample, times), *_of_joints(planned, sample)):
            values[kind][name] = share
        for kind, by_name in values.items():
            if by_name:
                found[kind] = _merged(found.get(kind), kind, times, weights, by_name)
    return tuple(found[kind] for kind in KINDS if kind in found)


def _merged(known: Share | None, kind: str, times: Array, weights: Array, by_name: Mapping[str, Array]) -> Share:
    """Return the share of one kind over the phases so far."""
    name = max(by_name, key=lambda each: float(by_name[each].max()))
    i = int(by_name[name].argmax())
    largest = float(by_name[name][i])
    high = float(weights[np.max(list(by_name.values()), axis=0) > HIGH].sum()) + (known.high if known else 0.0)
    if known is not None and known.largest >= largest:
        return Share(kind, known.name, known.largest, known.time, high)
    return Share(kind, name, largest, float(times[i]), high)


def _times(knots: Array) -> tuple[Array, NDArray[np.int_]]:
    """Return sample times and their intervals, (m,) each."""
    sites = np.linspace(0.0, 1.0, PLACES)
    times = knots[:-1, None] + np.diff(knots)[:, None] * sites
    return np.clip(times.ravel(), knots[0], knots[-1]), np.repeat(np.arange(len(knots) - 1), PLACES)


def _of_contacts(planned: LoadedPhase, sample: Sample[Any], times: Array) -> Iterator[tuple[str, str, Array]]:
    """Yield the shares of cone and sole of every contact, (m,) each."""
    robot = realised(planned)
    weight = GRAVITY * robot.mass
    contacts = [each for each in planned.phase.bound_contacts if np.isfinite(each.contact.friction)]
    if not contacts:
        return
    data = robot.model.createData()
    found: dict[tuple[str, str], Array] = {}
    for i in range(len(times)):
        pin.framesForwardKinematics(robot.model, data, sample.q[i])
        point = _Placed(robot, data)
        for contact in contacts:
            forces = [float(np.asarray(sample.z[force.name])[i]) for force in contact.forces]
            if float(contact.vector(forces)[2]) < LOADED * weight:
                continue
            shares = contact.shares(cast("FramePoint", point), forces, planned.parameters)
            for kind, share in shares.items():
                found.setdefault((kind, contact.name), np.zeros(len(times)))[i] = share
    for (kind, name), values in found.items():
        yield kind, name, values


def _of_joints(planned: LoadedPhase, sample: Sample[Any]) -> Iterator[tuple[str, str, Array]]:
    """Yield the shares of torque and speed of every joint with such a limit, (m,) each."""
    robot = planned.phase.robot
    assert robot is not None
    joints = list(robot.velocity_names)
    limits = planned.phase.limits if isinstance(planned.phase.limits, Limits) else robot.limits
    for kind, quantity, values, names in (
        ("torque", "effort", sample.tau, list(robot.actuated)),
        ("speed", "velocity", sample.v, joints),
    ):
        lower, upper = limits.sides(quantity)
        for column, joint in enumerate(names):
            i = joints.index(joint)
            if np.isfinite([lower[i], upper[i]]).all() and lower[i] < 0.0 < upper[i]:
                yield kind, joint, np.maximum(values[:, column] / upper[i], values[:, column] / lower[i])


class _Pose(NamedTuple):
    """A frame at one instant."""

    position: Array
    rotation: Array


class _Placed:
    """The frames of a robot in one configuration."""

    def __init__(self, robot: Robot, data: pin.Data) -> None:
        self._robot, self._data = robot, data

    def frame(self, name: str) -> _Pose:
        """Return the pose of a frame."""
        place = self._data.oMf[self._robot.frame(name)]
        return _Pose(place.translation, place.rotation)
