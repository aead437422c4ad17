"""Feet keep to their own sides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Scalar
from robotraj.gait.bounds.upright import root_link
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.path import PathConstraint
from robotraj.robot.robot import Robot
from robotraj.robot.sides.foot_pairs import foot_pairs


@dataclass(frozen=True)
class OwnSides(OneLine):
    """The left foot stays on the left of the right one, seen from the root, in every phase of a gait.

    For a left foot l and a right foot r the row is  e . (p_l - p_r) >= w  with the root's axis e from right to left,
    of which only the horizontal part counts. w is the width of the soles and a share of the gap between them in the
    standing configuration. Without the row an optimal biped crosses its legs, which are bodies, to put its feet below
    its centre of mass. A fore foot stays in front of the hind one in the same way where no joint moves their legs out
    of their plane. ``sides=None`` of the gait functions omits the rows.

    Parameters
    ----------
    share : float
        Share of the gap between both soles that remains, from 0 to 1.
    """

    share: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 <= self.share <= 1.0:
            raise InputError(f"{self!r} is invalid: share is a part of the gap between the feet, from 0 to 1.")

    def constraints(
        self,
        robot: Robot,
        contacts: Mapping[str, BoundContact],
        standing: Array,
        held: Sequence[str],
        most: float = np.inf,
        level: bool = True,
    ) -> list[Constraint]:
        """Return one row for each pair of feet of which not both are held, for ``rt.Phase(constraints=...)``.

        Parameters
        ----------
        robot : Robot
        contacts : mapping of str to BoundContact
            Contacts of all feet, by frame.
        standing : ndarray (nq,)
            Standing configuration.
        held : sequence of str
            Frames that the phase holds.
        most : float
            Greatest distance that the footholds of the phase allow [m].
        level : bool
            Whether the root stays upright. Of a root that turns over, all three parts of the axis count: halfway
            through a side flip it is vertical.
        """
        rows: list[Constraint] = []
        root = root_link(robot)
        # A base that is turned in its root, rt.load(base=), has a link with other axes than the root's.
        turned = robot.model.frames[robot.frame(root)].placement.rotation.T
        for pair in foot_pairs(robot, list(contacts), standing):
            if pair.first in held and pair.second in held:
                continue
            soles = min(sum(contacts[foot].half_width for foot in pair[:2]), pair.distance)
            width = min(soles + self.share * (pair.distance - soles), most)
            if width > 0.0:
                x, y, z = (float(part) for part in turned @ pair.across)
                distance = LateralDistance(pair.first, pair.second, root, (x, y, z), 2 if level else 3)
                rows.append(PathConstraint(distance, lower=width, name="own sides", unit="m"))
        return rows


@dataclass(frozen=True)
class LateralDistance:
    """Distance [m] of a foot from another one along an axis of the root, as an expression of a point.

    Attributes
    ----------
    first, second : str
        Frames of the feet.
    root : str
        Frame of the root link.
    across : tuple of 3 float
        The axis from the second foot to the first one, in the axes of the root link.
    parts : int
        2 if only its horizontal parts in the world count, else 3.
    """

    first: str
    second: str
    root: str
    across: tuple[float, float, float]
    parts: int = 2

    def __call__(self, point: RobotPoint) -> Scalar:
        """Evaluate (R e) . (p_first - p_second)."""
        turn = point.frame(self.root).rotation
        first, second = (point.frame(name).position for name in (self.first, self.second))
        axis = [sum(turn[i, k] * part for k, part in enumerate(self.across) if part) for i in range(self.parts)]
        return sum(axis[i] * (first[i] - second[i]) for i in range(self.parts))
