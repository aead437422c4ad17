"""A contact whose touchdowns and liftoffs are found by the optimisation; no contact sequence is given."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import (
    BoundContact,
    Contact,
    Wrench,
    checked_name,
    friction_coefficient,
    label_of,
    positive,
)
from robotraj.dynamics.contacts.footing import Footing
from robotraj.dynamics.contacts.mobility import mobility, require_plane
from robotraj.dynamics.contacts.point_contact import require_normal
from robotraj.dynamics.contacts.point_on_frame import Spot, Triple, offset_of
from robotraj.dynamics.contacts.vectors import dot
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Scalar, Variable
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class ImplicitContact(Contact):
    """A point that may touch the ground at any time, by relaxed complementarity.

    phi(q) >= 0 is the gap above the ground, n >= 0 the normal force and s >= 0 the slipping speed. b_k >= 0 are
    friction forces along directions d_k in the ground, two in a plane and four in space. The rows are

        phi n <= e,    mu n - sum b_k >= 0,    (mu n - sum b_k) s <= e,
        s + d_k' v >= 0,    (s + d_k' v) b_k <= e,

    ``rt.planning.tightening`` reduces the relaxation e towards zero in stages. The foot then has a force
    only where it touches. It sticks inside the friction cone, and friction dissipates the most where it slips. An
    impact is a force that lasts one interval. Plan short motions, with one collocation point at the end of each
    interval: ``rt.schemes.RadauIIA(1)`` (implicit Euler).
    Source: Posa, Cantu and Tedrake, A direct method for trajectory optimization of rigid bodies through contact, Int.
    J. Robotics Research 33 (2014), section 3.

    Parameters
    ----------
    frame : str
    friction : float
        Coefficient mu.
    relaxation : float
        e, in [N m] for the gap and in [W] for friction.
    ground : Ground
        A plane: ``rt.terrain.Flat()``, ``rt.terrain.Slope(...)`` or ``rt.terrain.Plane(...)``.
    name : str, optional
        The frame's name where none is given.
    offset : sequence of 3 float
        The point in the frame's axes [m].

    Raises
    ------
    InputError
        The friction or relaxation is not positive, or the ground is not a plane.
    """

    frame: str
    friction: float = 0.7
    relaxation: float = 1e-3
    ground: Ground | Callable[[ca.SX, ca.SX], Scalar] = field(default_factory=Flat)
    name: str | None = None
    offset: Triple = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        what = f"ImplicitContact {self.label!r}"
        checked_name(self.name, what)
        friction_coefficient(self.friction, what)
        positive(self.relaxation, f"relaxation of {what}", "N m")
        object.__setattr__(self, "offset", offset_of(self.offset, what))
        if not as_ground(self.ground).even:
            raise InputError(
                f"{what} needs a plane as its ground; the ground is {self.ground!r}. "
                f"Give rt.terrain.Flat(), rt.terrain.Slope(...) or rt.terrain.Plane(...), "
                "or write the contact sequence as phases with rt.PointContact."
            )

    @property
    def label(self) -> str:
        """Name of the contact."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundImplicitContact:
        """Find the axes in which the point can move, and return its forces and rows."""
        robot.frame(self.frame)
        spot = Spot(self.frame, self.offset)
        axes, _ = mobility(robot, lambda q: spot.jacobian(robot, q))
        require_plane(robot, self.frame, axes)
        ground = as_ground(self.ground)
        require_normal(robot, self.frame, axes, ground)
        still, _ = spot.placed(robot, robot.neutral)
        footing = Footing(self.label, ground, axes, (float(still[0]), float(still[1]), float(still[2])))
        anywhere = {anchor.name: 0.0 for anchor in footing.anchors}
        tangents, normal = footing.tangents(anywhere)
        directions = tuple(
            tuple(sign * float(part) for part in tangent) for tangent in tangents for sign in (1.0, -1.0)
        )
        name = self.label
        forces = (
            Variable(f"force.{name}.normal", "N", "contact force", name),
            *(Variable(f"force.{name}.friction{k}", "N", "contact force", name) for k in range(len(directions))),
            Variable(f"force.{name}.slip", "m/s", "slipping speed", name),
        )
        rows = [Row("gap", "m", 0.0, np.inf, name)]
        rows += [Row("gap complementarity", "N m", -np.inf, self.relaxation, name)]
        rows += [Row(v.name.rsplit(".", 1)[-1], v.unit, 0.0, np.inf, name, v.name) for v in forces]
        rows += [Row("friction cone", "N", 0.0, np.inf, name)]
        rows += [Row("slip complementarity", "W", -np.inf, self.relaxation, name)]
        rows += [Row("slipping speed", "m/s", 0.0, np.inf, name) for _ in directions]
        rows += [Row("friction complementarity", "W", -np.inf, self.relaxation, name) for _ in directions]
        up = tuple(float(part) for part in normal)
        friction = float(self.friction)
        return BoundImplicitContact(
            self, name, self.frame, forces, (), (), tuple(rows), (), friction, spot, ground, up, directions
        )


@dataclass(frozen=True, eq=False)
class BoundImplicitContact(BoundContact):
    """A point that is not held: forces, and the complementarity rows that they satisfy.

    Attributes
    ----------
    friction : float
    spot : Spot
    ground : Ground
    normal : tuple of 3 float
        Normal of the plane.
    directions : tuple of tuples of 3 float
        Directions of the friction forces.
    """

    friction: float
    spot: Spot
    ground: Ground
    normal: tuple[float, ...]
    directions: tuple[tuple[float, ...], ...]

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Nothing is held."""
        return []

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Nothing is held."""
        return []

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Nothing is held."""
        return []

    @property
    def touching(self) -> Spot:
        """The spot."""
        return self.spot

    def normal_at(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Return the normal of the plane."""
        return list(self.normal)

    def gap(self, point: FramePoint) -> Scalar:
        """Height above the plane along its normal [m]."""
        return self.ground.gap(self.spot.position(point)) * abs(self.normal[self.ground.axis])

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Force at the spot, as a wrench at the frame's origin."""
        return [(self.frame, self.spot.wrench(point, self.vector(forces), [0.0, 0.0, 0.0]))]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force n normal + sum b_k d_k (3) [N]."""
        parts = list(zip((self.normal, *self.directions), forces[:-1], strict=True))
        return [sum((axis[i] * value for axis, value in parts if axis[i]), 0.0) for i in range(3)]

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate the gap, the forces, the friction cone and the complementarity rows."""
        normal, *friction, slip = forces
        gap, motion = self.gap(point), self.spot.velocity(point)
        inside = self.friction * normal - sum(friction)
        against = [slip + dot(direction, motion) for direction in self.directions]
        dissipated = [speed * part for speed, part in zip(against, friction, strict=True)]
        return [gap, gap * normal, *forces, inside, inside * slip, *against, *dissipated]
