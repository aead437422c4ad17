"""The bodies of an MJCF file that are the robot, under one body of the world.

A file holds a scene: robots, things that they move, tables and targets, each a body of the world. Pinocchio reads the
first one alone, drops the others without a word, and drops the pose of a first one without joints.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

TOP = "worldbody"
"""Name of the body around those of the world."""
OF_A_SCENE = ("keyframe", "equality", "contact", "sensor")
"""Sections that refer to bodies of the whole file, and are not read."""


def with_one_tree(root: Element) -> tuple[str, ...]:
    """Put the robot's bodies under one body of the world, and return the names of bodies that are left out.

    The robot is what has motors, and where nothing has a motor, what has joints. A body that moves freely is a robot of
    its own: the first one is read where it comes first, none otherwise. Bodies without joints stand beside a robot that
    is fixed to the world.

    Parameters
    ----------
    root : Element
        The file with one section of each kind and without default classes, which is changed.
    """
    world = root.find("worldbody")
    if world is None:
        return ()
    bodies = world.findall("body")
    motors = {each.get("joint") for group in root.findall("actuator") for each in group}
    joints = {body: _joints(body) for body in bodies}
    moving = [body for body in bodies if joints[body]]
    robots = [body for body in moving if any(name in motors for name, _ in joints[body])] or moving
    free = {body for body in robots if any(kind == "free" for _, kind in joints[body])}
    if robots and robots[0] in free:
        kept = robots[:1]
    else:
        standing = [body for body in bodies if not joints[body] and body.get("mocap") != "true"]
        kept = [body for body in bodies if (body in robots and body not in free) or body in standing]
    left = [body for body in bodies if body not in kept]
    for body in bodies:
        world.remove(body)
    names = {body.get("name") for body in root.iter("body")}
    top = TOP
    while top in names:
        top += "_"
    moves_freely = len(kept) == 1 and kept[0] in free
    holder = world if moves_freely else SubElement(world, "body", name=top)
    holder.extend(kept)
    for section in [each for each in root if each.tag in OF_A_SCENE and left]:
        root.remove(section)
    return tuple(body.get("name", "a body without a name") for body in left)


def with_names(root: Element) -> None:
    """Name bodies and joints of the world that have no name: Pinocchio's reader drops those without any attribute."""
    every = [each for world in root.findall("worldbody") for each in world.iter() if each.tag in ("body", "joint")]
    known = {each.get("name") for each in every}
    for tag in ("body", "joint"):
        nameless = [each for each in every if each.tag == tag and not each.get("name") and each.get("type") != "free"]
        for number, each in enumerate(nameless, start=1):
            name = f"{tag}{number}"
            while name in known:
                name += "_"
            known.add(name)
            each.set("name", name)


def _joints(body: Element) -> list[tuple[str | None, str]]:
    """Return name and kind of every joint of a body and those on it."""
    joints = [(each.get("name"), each.get("type", "hinge")) for each in body.iter("joint")]
    return joints + [(each.get("name"), "free") for each in body.iter("freejoint")]
