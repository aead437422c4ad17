"""Links without a shape to judge: an absent shape is not air, so that no distance of such a link is claimed."""

from __future__ import annotations

from collections import Counter

import pinocchio as pin

from robotraj.robot.robot import Robot

UNREAD, SEEN_ONLY = "its <collision> shape was not read", "it has <visual> shapes only"


def unguarded_links(robot: Robot) -> tuple[tuple[str, str], ...]:
    """Return the links without shapes in a robot that has shapes, each with the reason.

    They are those whose shapes were not read, and those with others to look at.
    """
    stated = robot.geometry.stated(pin.GeometryType.COLLISION)
    if not stated.total():
        return ()
    model = robot.model
    read = Counter(model.frames[shape.parentFrame].name for shape in robot.collision_model.geometryObjects)
    unread = [(link, UNREAD) for link, count in stated.items() if count > read[link]]
    seen = robot.geometry.stated(pin.GeometryType.VISUAL)
    return (*unread, *((link, SEEN_ONLY) for link, count in seen.items() if count and not stated[link]))


def not_every_link(names: tuple[str, ...]) -> str:
    """Return the sentence on links without a shape, each named with the reason."""
    return f"Not every link has a shape that was read: {', '.join(names[:4])}{' ...' if len(names) > 4 else ''}."


def no_shapes(robot: Robot) -> str:
    """Return the sentence on a robot without a shape that was read, and what to do."""
    unread = [link for link, count in robot.geometry.stated(pin.GeometryType.COLLISION).items() if count]
    if not unread:
        return f"{robot.name} has no collision shapes in its URDF; add <collision> to its links."
    names = ", ".join(unread[:4]) + (" ..." if len(unread) > 4 else "")
    return (
        f"None of the <collision> shapes of {robot.name} was read, those of {names}. Name the folders of their meshes "
        "with rt.load(..., package_dirs=...); print(robot) names the files."
    )
