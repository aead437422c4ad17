"""The frames of the feet, and their contacts."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import Contact, copied
from robotraj.robot.robot import Robot

FootKind = Contact | Callable[[str], Contact]
"""The contact of every foot: ``rt.PointContact``, a function of the frame, or a contact to copy to other frames."""

WORDS = ("sole", "foot", "toe")
"""Parts of the names of feet; the first one that any frame has is used."""


def feet_of(robot: Robot, feet: Sequence[str] | None) -> tuple[str, ...]:
    """Return the given frames, or those whose name contains the word sole, foot or toe.

    Of several frames on one link, such as a foot and its sensor, those with the fewest words in their names are feet.

    Raises
    ------
    InputError
        A frame does not exist or is named twice, or no name contains these words. The message lists the frames at the
        ends of the limbs.
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
    raise InputError(
        f"No frame of {robot.name!r} is named like a foot; give feet=[...]. Frames at the ends of its limbs: "
        f"{', '.join(ends) or 'none'}."
    )


def _words(name: str) -> list[str]:
    return re.findall("[a-z]+", name.lower())


def _fewest_words(robot: Robot, name: str, names: Sequence[str]) -> int:
    """Return the least number of words of those names whose frames move with the frame ``name``."""
    joint = {each: robot.model.frames[robot.frame(each)].parentJoint for each in names}
    return min(len(_words(each)) for each in names if joint[each] == joint[name])


def limb_ends(robot: Robot) -> tuple[str, ...]:
    """Return the links that are fixed to joints without child joints."""
    model = robot.model
    carrying = {model.parents[i] for i in range(1, model.njoints)}
    return tuple(
        frame.name
        for frame in model.frames
        if frame.type == pin.FrameType.BODY and frame.parentJoint and frame.parentJoint not in carrying
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
