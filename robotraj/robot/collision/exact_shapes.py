"""The exact collision shapes of a robot's links, and the pairs of links that touch by coal."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import coal
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.collision.link_pairs import candidate_pairs, sampled_configurations
from robotraj.robot.robot import Robot


class ExactShape(NamedTuple):
    """A shape that a joint carries.

    Attributes
    ----------
    label : str
        Its link.
    geometry : coal.CollisionGeometry
    joint : int
        Pinocchio's joint, 0 for the world.
    placement : pinocchio.SE3
        In the frame of the joint.
    """

    label: str
    geometry: coal.CollisionGeometry
    joint: int
    placement: pin.SE3


def link_shapes(
    robot: Robot, disabled: Collection[tuple[str, str]] = ()
) -> tuple[list[ExactShape], set[frozenset[str]]]:
    """Return the shapes of the robot, and the pairs of links that are neither joined nor disabled."""
    own = [
        ExactShape(robot.model.frames[s.parentFrame].name, s.geometry, int(s.parentJoint), s.placement)
        for s in robot.collision_model.geometryObjects
    ]
    links = list(dict.fromkeys(shape.label for shape in own))
    return own, {frozenset(pair) for pair in candidate_pairs(robot, links, disabled)}


def sometimes_apart(
    robot: Robot, shapes: Sequence[ExactShape], among: list[tuple[int, int]], margin: float = 0.0
) -> list[tuple[int, int]]:
    """Return the pairs of shapes whose links are not nearer than ``margin`` [m] in every sampled configuration."""
    touching = {frozenset((shapes[i].label, shapes[j].label)) for i, j in among}
    data = robot.model.createData()
    for q in sampled_configurations(robot):
        if not touching:
            break
        places = _places(robot, data, shapes, q)
        open_ = [(i, j) for i, j in among if frozenset((shapes[i].label, shapes[j].label)) in touching]
        touching &= {
            frozenset((shapes[i].label, shapes[j].label)) for i, j in open_ if _touch(shapes, places, i, j, margin)
        }
    return [(i, j) for i, j in among if frozenset((shapes[i].label, shapes[j].label)) not in touching]


def _places(robot: Robot, data: pin.Data, shapes: Sequence[ExactShape], q: Array) -> list[coal.Transform3s]:
    pin.forwardKinematics(robot.model, data, q)
    placed = (data.oMi[shape.joint] * shape.placement for shape in shapes)
    return [coal.Transform3s(place.rotation, place.translation) for place in placed]


def _touch(
    shapes: Sequence[ExactShape], places: Sequence[coal.Transform3s], i: int, j: int, margin: float = 0.0
) -> bool:
    found = coal.CollisionResult()
    request = coal.CollisionRequest()
    request.security_margin = margin
    return bool(coal.collide(shapes[i].geometry, places[i], shapes[j].geometry, places[j], request, found))
