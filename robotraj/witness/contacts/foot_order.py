"""The lateral order of the feet along a plan: left feet left of right ones, as in the neutral configuration."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.sides.foot_pairs import foot_pairs
from robotraj.witness.contacts.ground import feet_of_plan
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.sampling import interval_samples

AHEAD = 0.3
"""Length of the horizontal part of the root's lateral axis below which its feet have no lateral order."""


@dataclass(frozen=True)
class FootOrder(OneLine):
    """The least lateral distance of a pair of feet in one phase.

    Attributes
    ----------
    first, second : str
        Frames of the feet.
    phase : str
    distance : float
        Least distance along the root's lateral axis [m]; negative where the legs cross.
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
    """Measure every pair of feet in every phase of a robot with a floating root."""
    frames = list(dict.fromkeys(spot.frame for spot in feet_of_plan(solution)))
    found: list[FootOrder] = []
    if len(frames) < 2:
        return ()
    for planned in solution.phases:
        if planned.phase.robot is None:
            continue
        robot = realised(planned)
        pairs = foot_pairs(robot, frames, robot.neutral)
        least = [(np.inf, 0.0)] * len(pairs)
        model, data = robot.model, robot.model.createData()
        for part in interval_samples(planned, samples) if pairs else ():
            clock()
            q = robot_sample(planned, part.times, part.interval).q
            for t, each in zip(part.times, q, strict=True):
                pin.framesForwardKinematics(model, data, each)
                for k, pair in enumerate(pairs):
                    axis = (data.oMi[1].rotation @ np.array(pair.across))[:2]
                    first, second = (data.oMf[robot.frame(foot)].translation[:2] for foot in pair[:2])
                    size = float(np.linalg.norm(axis))
                    if size > AHEAD:
                        least[k] = min(least[k], (float(axis @ (first - second)) / size, float(t)))
        found += [
            FootOrder(pair.first, pair.second, planned.phase.name, distance, pair.distance, time)
            for pair, (distance, time) in zip(pairs, least, strict=True)
            if np.isfinite(distance)
        ]
    return tuple(found)
