"""Bodies of MJCF with several joints, and ball joints, as chains of joints with one degree of freedom each."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element

import pinocchio as pin

from robotraj.robot.loading.chain_names import Chains
from robotraj.robot.loading.single_axes import single_axes

COMPOSITE = "Composite_"
"""Pinocchio's name of the joints of a body is this and the name of the first one."""


def with_single_axes(
    root: Element, model: pin.Model, shapes: tuple[pin.GeometryModel, pin.GeometryModel]
) -> tuple[pin.Model, Chains]:
    """Return the model with joints of one degree of freedom, and the names of balls' parts; move the shapes along.

    The joints of a body keep the names that the file gives them.
    """
    chained, chains = single_axes(model)
    if chained is model:
        return model, chains
    for group in shapes:
        for shape in group.geometryObjects:
            frame = model.frames[shape.parentFrame]
            shape.parentFrame = chained.getFrameId(frame.name, frame.type)
            shape.parentJoint = chained.frames[shape.parentFrame].parentJoint
    for old, new in _names(root):
        if chained.existJointName(old):
            frame = chained.frames[chained.getFrameId(old, pin.FrameType.JOINT)]
            frame.name = new
            chained.names[chained.getJointId(old)] = new
    return chained, {joint: parts for joint, parts in chains.items() if not joint.startswith(COMPOSITE)}


def _names(root: Element) -> Iterator[tuple[str, str]]:
    """Yield the names of the parts of each body's joints, and those of the file."""
    for body in root.iter("body"):
        names = [joint.get("name", "") for joint in body.findall("joint")]
        if len(names) > 1 and all(names):
            yield from ((f"{COMPOSITE}{names[0]}_{k}", name) for k, name in enumerate(names, 1))
