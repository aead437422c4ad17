"""The frames of the feet, and their contacts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.names.near_words import WORDS as WORDS_OF_NAMES
from robotraj.dynamics.contacts.base import Contact, copied
from robotraj.robot.collision.solids import Solid
from robotraj.robot.neutral import amid
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of
from robotraj.robot.sides.images import places_of

FootKind = Contact | Callable[[str], Contact]
"""The contact of every foot: ``rt.PointContact``, a function of the frame, or a contact to copy to other frames."""

WORDS = ("sole", "foot", "toe")
"""Parts of the names of feet; the first one that any frame has is used."""
LEVEL = 0.15
"""Height above the lowest end of a limb up to which others are feet too, relative to that of the robot."""

SHANK = 0.25
"""Depth of a link's shapes below its joint, relative to the distance of the joint from the hip, above which the link is
a part of a leg and no foot."""


def feet_of(robot: Robot, feet: Sequence[str] | None) -> tuple[str, ...]:
    """Return the given frames, or those whose name contains the word sole, foot or toe, or the lowest ends of limbs.

    Of several frames on one link, such as a foot and its sensor, those with the fewest words in their names are feet.
    Where no name has such a word, feet are the lowest frames of the limbs that reach the ground in the neutral
    configuration, if there are two or more.

    Raises
    ------
    InputError
        A frame does not exist or is named twice, there are no feet by name and place, or legs have no frames at their
        ends. The message lists the frames at the ends of the limbs.
    """
    if feet is not None:
        names = (feet,) if isinstance(feet, str) else tuple(feet)
        for name in names:
            robot.frame(name)
        if not names or len(set(names)) != len(names):
            raise InputError(f"feet= is {list(names)!r}; name the frame of each foot once.")
        return names
    ends = limb_ends(robot)
    for word in WORDS:
        found = tuple(name for name in ends if word in _words(name))
        if found:
            return tuple(name for name in found if len(_words(name)) == _fewest_words(robot, name, found))
    standing = standing_ends(robot)
    if len(standing) > 1:
        _check_ends(robot, standing)
        return standing
    raise InputError(
        f"No frame of {robot.name!r} is named like a foot; give feet=[...]. Frames at the ends of its limbs: "
        f"{', '.join(ends) or 'none'}."
    )


def _check_ends(robot: Robot, feet: Sequence[str]) -> None:
    """Check that the legs do not reach far beyond the frames of their feet.

    Raises
    ------
    InputError
        A foot is the frame of a long link at its last joint, such as a knee, and the end of this link has no frame.
    """
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.neutral)
    hips, found = len(root_of(robot.root).joints) + 1, []
    lowest = _lowest_points(robot, data)
    for foot in feet:
        frame = model.frames[robot.frame(foot)]
        joint, chain = frame.parentJoint, model.supports[frame.parentJoint]
        if len(chain) > hips and not frame.placement.translation.any():
            leg = data.oMi[joint].translation - data.oMi[chain[hips]].translation
            if data.oMi[joint].translation[2] - lowest.get(joint, np.inf) > SHANK * np.linalg.norm(leg):
                found.append(frame)
    if found:
        names = ", ".join(repr(str(frame.name)) for frame in found)
        raise InputError(
            f"The legs of {robot.name!r} have no frames at their ends: those of links {names} are at the joints before "
            "them. Add a frame at the end of each leg (a link on a fixed joint, or a site of MJCF), and name these "
            "in feet=[...]. If the origins of the links do touch the ground, name the links in feet=[...]."
        )


def _lowest_points(robot: Robot, data: pin.Data) -> dict[int, float]:
    """Return the height of the lowest corner of the boxes around the collision shapes of each joint [m]."""
    lowest: dict[int, float] = {}
    for shape in robot.collision_model.geometryObjects:
        place = data.oMi[shape.parentJoint] * shape.placement
        corners = product(*np.transpose(Solid(shape.geometry).box))
        heights = [float(place.act(np.array(corner))[2]) for corner in corners]
        lowest[shape.parentJoint] = min(*heights, lowest.get(shape.parentJoint, np.inf))
    return lowest


def standing_ends(robot: Robot) -> tuple[str, ...]:
    """Return the lowest frame of each limb that reaches the ground with the root upright, in the neutral configuration.

    Where all limbs end above the root, they are folded or level there, and are looked at amid their ranges. A limb
    reaches the ground if it ends within ``LEVEL`` of the height of the robot from the lowest one, below the root. The
    frame of a limb's last joint is no end of the limb where other frames move with it: it is the lowest one of a leg
    that is folded up.
    """
    if robot.root == "fixed":
        return ()
    return _lowest_ends(robot, robot.neutral) or _lowest_ends(robot, amid(robot.neutral, robot.limits))


def _lowest_ends(robot: Robot, q: NDArray[np.float64]) -> tuple[str, ...]:
    places, model = places_of(robot, q), robot.model
    lowest: dict[int, str] = {}
    at_joint: set[str] = set()
    for name in limb_ends(robot):
        frame = model.frames[robot.frame(name)]
        joint = int(frame.parentJoint)
        if not frame.placement.translation.any():
            at_joint.add(name)
        first = joint not in lowest or lowest[joint] in at_joint
        if first or (name not in at_joint and places[name][2] <= places[lowest[joint]][2]):
            lowest[joint] = name
    heights = np.array([places[name][2] for name in lowest.values()])
    root = places[next(frame.name for frame in model.frames if frame.parentJoint == 1)][2]
    if not heights.size or heights.min() >= root:
        return ()
    level = heights.min() + LEVEL * (max(place[2] for place in places.values()) - heights.min())
    return tuple(name for name, height in zip(lowest.values(), heights, strict=True) if height <= min(level, root))


def _words(name: str) -> list[str]:
    return [word.lower() for word in WORDS_OF_NAMES.findall(name) if word.isalpha()]


def _fewest_words(robot: Robot, name: str, names: Sequence[str]) -> int:
    """Return the least number of words of those names whose frames move with the frame ``name``."""
    joint = {each: robot.model.frames[robot.frame(each)].parentJoint for each in names}
    return min(len(_words(each)) for each in names if joint[each] == joint[name])


def limb_ends(robot: Robot) -> tuple[str, ...]:
    """Return the links, and the sites of MJCF, that are fixed to joints without child joints."""
    model = robot.model
    carrying = {model.parents[i] for i in range(1, model.njoints)}
    return tuple(
        frame.name
        for frame in model.frames
        if frame.type in (pin.FrameType.BODY, pin.FrameType.OP_FRAME)
        and frame.parentJoint
        and frame.parentJoint not in carrying
    )


def foot_contact(kind: FootKind, frame: str) -> Contact:
    """Return the contact of a foot.

    Raises
    ------
    InputError
        The function returns no contact.
    """
    if isinstance(kind, Contact):
        contact: object = copied(kind, frame=frame, name=None)
    else:
        try:
            contact = kind(frame)
        except TypeError as error:
            raise InputError(
                f"contact= cannot be called with foot {frame!r} alone: {error}. Bind its other arguments, as in "
                "functools.partial(rt.FlatFoot, length=0.2, width=0.1)."
            ) from error
    if not isinstance(contact, Contact):
        raise InputError(
            f"contact= returned {contact!r} for foot {frame!r}; give rt.PointContact, a contact to copy, or a function "
            "from a frame's name to a contact."
        )
    return contact
