"""The order of the feet along a plan, as in the neutral configuration: left of right ones, fore before hind ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.sides.foot_pairs import foot_pairs, root_joint
from robotraj.witness.contacts.ground import feet_of_plan
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.sampling import interval_samples

AHEAD = 0.3
"""Length of the horizontal part of that axis below which the root is turned over in its phase.

Of other roots only the horizontal parts of axis and distance count. A root that turns over has all three parts: halfway
through a side flip the axis is vertical."""


@dataclass(frozen=True)
class FootOrder(OneLine):
    """The least distance of a pair of feet in one phase.

    Attributes
    ----------
    first, second : str
        Frames of the feet.
    phase : str
    distance : float
        Least distance along the lateral axis of the root, or along its x axis [m]; negative where the legs cross.
    neutral : float
        Distance in the neutral configuration [m].
    time : float
        Time of the least distance [s].
    """

    first: str
    second: str
    phase: str
    distance: float
    neutral: float
    time: float


def foot_orders_of(
    solution: SolutionLike, samples: int, clock: Callable[[], None] = lambda: None
) -> tuple[FootOrder, ...]:
    """Measure every pair of feet in every phase."""
    frames = list(dict.fromkeys(spot.frame for spot in feet_of_plan(solution)))
    found: list[FootOrder] = []
    if len(frames) < 2:
        return ()
    for planned in solution.phases:
        if planned.phase.robot is None:
            continue
        robot = realised(planned)
        pairs = foot_pairs(robot, frames, robot.neutral)
        along: list[tuple[float, NDArray[np.float64], NDArray[np.float64]]] = []
        model, data = robot.model, robot.model.createData()
        for part in interval_samples(planned, samples) if pairs else ():
            clock()
            q = robot_sample(planned, part.times, part.interval).q
            for t, each in zip(part.times, q, strict=True):
                pin.framesForwardKinematics(model, data, each)
                places = [[data.oMf[robot.frame(foot)].translation for foot in pair[:2]] for pair in pairs]
                axes = [data.oMi[root_joint(robot)].rotation @ np.array(pair.across) for pair in pairs]
                along.append((float(t), np.array(axes), np.array([first - second for first, second in places])))
        least = [_least(along, k) for k in range(len(pairs))]
        found += [
            FootOrder(pair.first, pair.second, planned.phase.name, distance, pair.distance, time)
            for pair, (distance, time) in zip(pairs, least, strict=True)
            if np.isfinite(distance)
        ]
    return tuple(found)


def _least(along: Sequence[tuple[float, NDArray[np.float64], NDArray[np.float64]]], pair: int) -> tuple[float, float]:
    """Return the least distance of a pair of feet along its axis [m] and its time [s].

    ``along`` has times, and the axes and the distances of all pairs (pairs, 3) in the world.
    """
    if not along:
        return np.inf, 0.0
    axes, apart = np.array([(axis[pair], away[pair]) for _, axis, away in along]).swapaxes(0, 1)
    parts = 2 if np.linalg.norm(axes[:, :2], axis=1).min() > AHEAD else 3
    axes, apart = axes[:, :parts], apart[:, :parts]
    distances = np.sum(axes * apart, axis=1) / np.linalg.norm(axes, axis=1)
    k = int(np.argmin(distances))
    return float(distances[k]), along[k][0]
