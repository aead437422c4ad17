"""Feet and ground for MuJoCo: shapes, places and stiffness.

A point foot is a small sphere about its contact point, a flat one a thin box, a line a capsule. All have the same
radius r, by which the radius of an arc grows. The ground is lower by r along its normal, so that each foot touches it
at its planned place. A foot that turns rolls by at most r times its angle more than planned. Each foot collides only
with the ground of its contact.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import TYPE_CHECKING, cast

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.edges.arc_foot import Rolling
from robotraj.dynamics.contacts.edges.line_contact import BoundLineContact
from robotraj.dynamics.contacts.flat_foot import BoundFlatFoot
from robotraj.dynamics.contacts.implicit import BoundImplicitContact
from robotraj.dynamics.contacts.point_contact import BoundPointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground
from robotraj.witness.mujoco.model import wxyz
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.mujoco.reference_motion import ReferenceMotion

if TYPE_CHECKING:
    import mujoco

    from robotraj.dynamics.contacts.base import BoundContact
    from robotraj.dynamics.contacts.flat_foot import FlatFoot
    from robotraj.dynamics.contacts.implicit import ImplicitContact
    from robotraj.dynamics.contacts.point_contact import FrictionContact

MARGIN = 0.5
"""Margin of a height field around the places of the feet [m]."""

CELL = 0.01
"""Size of the cells of a height field [m], larger where a side had more than ``MOST_CELLS``."""

MOST_CELLS = 600

PLANAR_WIDTH = 0.04
"""Width [m] of a flat foot of a planar robot, whose plan has no width."""

PLANE_TOLERANCE = 1e-9
"""Largest deviation of a ground from a plane [m] with which it becomes a plane of MuJoCo."""

SAMPLES = 50
"""Times of each phase and period at which the places of feet are computed."""


@dataclass(frozen=True)
class SoftGround(OneLine):
    """Stiffness and friction of the ground in MuJoCo.

    Parameters
    ----------
    time : float
        Time constant of the critically damped contact [s], MuJoCo's ``solref``, whose default there is 0.02. A smaller
        one is harder; the least is two simulation steps.
    radius : float
        Radius r of the feet [m].
    grip : float
        Ratio of the friction in MuJoCo and in the plan. Soft contacts slide at the edge of the friction cone, which
        plans use fully: plan with less friction than there is.

    Raises
    ------
    InputError
        A value is not positive.
    """

    time: float = 0.005
    radius: float = 0.005
    grip: float = 1.0

    def __post_init__(self) -> None:
        for name in ("time", "radius", "grip"):
            value = getattr(self, name)
            if not (is_finite(value) and value > 0):
                raise InputError(f"{name} = {value!r} of SoftGround must be a positive number.")


@dataclass(frozen=True)
class Foot:
    """The shape of a contact in MuJoCo.

    Attributes
    ----------
    name : str
        Name of the contact.
    frame : int
        Pinocchio's index of its frame.
    pose : pinocchio.SE3
        Pose of the shape in that frame; its origin is the contact point, or the middle of the sole.
    shape : str
        ``"SPHERE"``, ``"CAPSULE"`` along z or ``"BOX"``, whose z is up.
    half : tuple of float
        Half the length of a capsule, half the length and half the width of a box [m].
    friction : float
    grounds : tuple of Ground
        The ground, and the walls that the contact touches in other phases.
    arc : float
        Radius of an arc [m], 0 for other feet.
    """

    name: str
    frame: int
    pose: pin.SE3
    shape: str
    half: tuple[float, ...]
    friction: float
    grounds: tuple[Ground, ...]
    arc: float = 0.0

    def touched(self, at: Array) -> Ground:
        """Return the ground that is nearest to a place (3,) [m]."""
        return min(self.grounds, key=lambda ground: abs(float(ground.gap(at.tolist()))))

    def size(self, radius: float) -> list[float]:
        """Return the sizes (3,) of MuJoCo's shape; half the height of a box is the radius."""
        sizes = [*self.half, radius] if self.shape == "BOX" else [radius + self.arc, *self.half]
        return sizes + [0.0] * (3 - len(sizes))


def feet_of(course: ReferenceMotion) -> tuple[Foot, ...]:
    """Return all feet of a plan, and their partners in mirrored periods.

    Raises
    ------
    InputError
        A contact of another kind, or a mirror without the partner of a foot.
    """
    held = _held(course, range(len(course.phases)))
    shapes = [(-len(bound.holds), 0, _foot(course, bound)) for bound in held]
    if course.mirrored(1):
        shapes += [(size, 1, _across(course, foot)) for size, _, foot in shapes]
    found: dict[str, Foot] = {}
    # A sole that rolls over its heel and toe, or whose mirror image does, has the shape of the sole in all phases.
    for _, _, foot in sorted(shapes, key=lambda each: each[:2]):
        known = found.setdefault(foot.name, foot)
        grounds = tuple(dict.fromkeys((*known.grounds, *foot.grounds)))
        found[foot.name] = replace(known, grounds=grounds)
    return tuple(found.values())


def landing_feet(course: ReferenceMotion, phase: int, period: int = 0) -> tuple[Foot, ...]:
    """Return the feet that touch down at the start of a phase, as the shapes that reach the ground then.

    A foot that lands on its heel is there at the edge of its sole, not in the middle.
    """
    lands = course.lands(phase)
    feet = tuple(_foot(course, bound) for bound in _held(course, (phase,)) if bound.name in lands)
    return tuple(_across(course, foot) for foot in feet) if course.mirrored(period) else feet


def place(foot: Foot, poses: Sequence[pin.SE3]) -> Array:
    """Return the contact point of a foot (3,) [m] for the poses of all frames."""
    return np.array((poses[foot.frame] * foot.pose).translation)


def furnish(
    course: ReferenceMotion,
    feet: Sequence[Foot],
    soft: SoftGround,
    spec: mujoco.MjSpec,
    bodies: Mapping[int, mujoco.MjsBody],
) -> None:
    """Add feet and their grounds to a specification of MuJoCo."""
    mujoco = load_mujoco()
    grounds: list[Ground] = []
    for foot in feet:
        grounds += [ground for ground in foot.grounds if ground not in grounds]
        bits = sum(1 << grounds.index(ground) for ground in foot.grounds)
        frame = course.robot.model.frames[foot.frame]
        pose = frame.placement * foot.pose
        geom = bodies[frame.parentJoint].add_geom(
            name=foot.name, pos=pose.translation, quat=wxyz(pose.rotation), contype=bits, conaffinity=0, condim=3
        )
        geom.type, geom.size = getattr(mujoco.mjtGeom, f"mjGEOM_{foot.shape}"), foot.size(soft.radius)
        geom.friction = [soft.grip * foot.friction, 0.0, 0.0]
        geom.solref = [soft.time, 1.0]
        geom.priority = 1
    low, high = _reach(course, feet)
    for i, ground in enumerate(grounds):
        _add_ground(mujoco, spec, ground, low, high, soft.radius, i)


def _foot(course: ReferenceMotion, bound: BoundContact) -> Foot:
    """Return the shape of a contact, in the axes of the contact."""
    half: tuple[float, ...] = ()
    if isinstance(bound, BoundFlatFoot):
        rotation = np.column_stack([bound.feet.forward, bound.feet.left, bound.feet.up])
        sole = cast("FlatFoot", bound.contact)
        given = sole.length
        back, front = given if isinstance(given, Sequence) else (0.5 * given, 0.5 * given)
        middle = np.array(bound.spot.offset) + 0.5 * (front - back) * rotation[:, 0]
        wide = sole.width or PLANAR_WIDTH
        pose, shape, half = pin.SE3(rotation, middle), "BOX", (0.5 * (back + front), 0.5 * wide)
    elif isinstance(bound, BoundLineContact):
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), np.array(bound.along)).toRotationMatrix()
        pose, shape, half = pin.SE3(turn, np.array(bound.spot.offset)), "CAPSULE", (0.5 * bound.width,)
    elif isinstance(bound, BoundPointContact | BoundImplicitContact):
        pose, shape = pin.SE3(np.eye(3), np.array(bound.spot.offset)), "SPHERE"
    else:
        raise InputError(
            f"{type(bound.contact).__name__} {bound.name!r} cannot be simulated in MuJoCo; second_opinion() accepts "
            f"points, lines and flat feet on the ground, and loops. Use rt.validate."
        )
    contact = cast("FrictionContact | FlatFoot | ImplicitContact", bound.contact)
    frame, ground = course.robot.frame(bound.frame), as_ground(contact.ground)
    arc = bound.spot.radius if isinstance(bound, Rolling) else 0.0
    return Foot(bound.name, frame, pose, shape, half, float(contact.friction), (ground,), arc)


def _held(course: ReferenceMotion, phases: Iterable[int]) -> list[BoundContact]:
    """Return the contacts of phases that stand on a ground."""
    held = [bound for i in phases for bound in getattr(course.phases[i].phase, "bound_contacts", ())]
    return [bound for bound in held if bound.contact.ground is not None]


def _across(course: ReferenceMotion, foot: Foot) -> Foot:
    """Return the foot in the place of another one in mirrored periods.

    Its frame is that of a contact of its name, else the partner of the other foot's frame, else the frame of its name.
    """
    partners = course.closing.partners if course.closing is not None else {}
    model = course.robot.model
    frame = model.frames[foot.frame].name
    name = partners.get(foot.name, partners.get(frame, foot.name))
    named = {bound.name: bound.frame for bound in _held(course, range(len(course.phases)))}
    other = named.get(name, partners.get(frame, name))
    if not model.existFrame(other):
        raise InputError(
            f"The mirror names no partner of frame {frame!r}, in whose place contact {name!r} stands; add {frame!r} to "
            f"its partners."
        )
    return replace(foot, name=name, frame=course.robot.frame(other))


def _reach(course: ReferenceMotion, feet: Sequence[Foot]) -> tuple[Array, Array]:
    """Return the corners (2,) [m] of the rectangle over which the feet move."""
    model = course.robot.model
    data = model.createData()
    places = []
    for passage in course.passages:
        times = np.linspace(0.0, course.durations[passage.phase], SAMPLES)
        planned = course.reference(passage.phase, times)
        for q in course.onwards(planned.q, planned.v, passage.period)[0]:
            pin.framesForwardKinematics(model, data, q)
            places += [place(foot, data.oMf)[:2] for foot in feet]
    return np.min(places, axis=0) - MARGIN, np.max(places, axis=0) + MARGIN


def _add_ground(
    mujoco: ModuleType, spec: mujoco.MjSpec, ground: Ground, low: Array, high: Array, radius: float, index: int
) -> None:
    """Add a plane, or a height field where the ground is not plane."""
    own = {"name": f"ground {index}", "contype": 0, "conaffinity": 1 << index, "friction": [0.0, 0.0, 0.0]}
    middle = 0.5 * (low + high)
    # A wall has no height over x and y.
    at = middle if ground.below else np.zeros(2)
    normal, centre = np.array(ground.normal(*at), dtype=float), np.array(ground.at(*at), dtype=float)

    def add_plane() -> None:
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), normal).toRotationMatrix()
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], pos=centre - radius * normal, quat=wxyz(turn), **own
        )

    if ground.even:
        add_plane()
        return
    columns, rows = (int(min(MOST_CELLS, np.ceil(size / CELL))) + 1 for size in high - low)
    x, y = np.linspace(low[0], high[0], columns), np.linspace(low[1], high[1], rows)
    heights = np.asarray(ground.height(x[None, :], y[:, None]), dtype=float)
    flat = centre[2] - (normal[0] * (x[None, :] - centre[0]) + normal[1] * (y[:, None] - centre[1])) / normal[2]
    if np.max(np.abs(heights - flat)) < PLANE_TOLERANCE:
        add_plane()
        return
    # A shift along the normal by r is one along z by r / n_z.
    up = np.array([np.broadcast_to(part, heights.shape) for part in ground.normal(x[None, :], y[:, None])])[2]
    heights = heights - radius / up
    bottom, top = heights.min(), heights.max()
    spec.add_hfield(
        name=f"heights {index}",
        nrow=rows,
        ncol=columns,
        size=[*(0.5 * (high - low)), top - bottom, MARGIN],
        userdata=((heights - bottom) / (top - bottom)).ravel(),
    )
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname=f"heights {index}", pos=[*middle, bottom], **own
    )
