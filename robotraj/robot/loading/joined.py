"""One planning model of several robots side by side: joints, frames and shapes of each under a prefix."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.values import dataclass
from robotraj.robot.coupling.coupled_model import coupled, uncoupled
from robotraj.robot.coupling.mimics import Mimic, mimics_of
from robotraj.robot.coupling.pickling import PickledModel
from robotraj.robot.loading.geometry import Geometry
from robotraj.robot.loading.planning_model import PER_VELOCITY


@dataclass(frozen=True)
class JoinedPart(PickledModel):
    """A robot of a joined one.

    Attributes
    ----------
    prefix : str
        Before the names of its joints, frames and shapes.
    model : pinocchio.Model
        Its own planning model, with a fixed root.
    geometry : Geometry
        Source of its shapes.
    position, quaternion : tuple of float
        Pose of its root in the world [m], (x, y, z, w).
    """

    prefix: str
    model: pin.Model
    geometry: Geometry
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]

    @property
    def pose(self) -> pin.SE3:
        """Pose of its root in the world."""
        return pin.SE3(pin.Quaternion(np.array(self.quaternion)).matrix(), np.array(self.position))


def joined_model(name: str, parts: Sequence[JoinedPart]) -> pin.Model:
    """Return a model with the joints of each part after those of the parts before it."""
    whole = pin.Model()
    whole.name = name
    whole.gravity = parts[0].model.gravity.copy()
    mimics: list[Mimic] = []
    for part in parts:
        model, joints, frames = uncoupled(part.model), whole.njoints - 1, whole.nframes - 1
        mimics += [
            replace(mimic, follower=part.prefix + mimic.follower, leader=part.prefix + mimic.leader)
            for mimic in mimics_of(part.model)
        ]
        first = whole.nv
        for i in range(1, model.njoints):
            joint = model.joints[i]
            v, q = slice(joint.idx_v, joint.idx_v + joint.nv), slice(joint.idx_q, joint.idx_q + joint.nq)
            parent = model.parents[i]
            whole.addJoint(
                parent + joints if parent else 0,
                joint,
                model.jointPlacements[i] if parent else part.pose * model.jointPlacements[i],
                part.prefix + model.names[i],
                model.upperEffortLimit[v],
                model.upperVelocityLimit[v],
                model.lowerPositionLimit[q],
                model.upperPositionLimit[q],
            )
            whole.appendBodyToJoint(i + joints, model.inertias[i], pin.SE3.Identity())
        for frame in list(model.frames)[1:]:
            moved = pin.Frame(frame)
            moved.name = part.prefix + frame.name
            moved.placement = frame.placement if frame.parentJoint else part.pose * frame.placement
            moved.parentJoint = frame.parentJoint + joints if frame.parentJoint else 0
            moved.parentFrame = frame.parentFrame + frames if frame.parentFrame else 0
            whole.addFrame(moved, False)
        own = slice(first, whole.nv)
        for quantity in (*PER_VELOCITY, "lowerEffortLimit"):
            getattr(whole, quantity)[own] = getattr(model, quantity)
    return coupled(whole, mimics)


@dataclass(frozen=True)
class JoinedGeometry:
    """The shapes of several robots, attached to their joined model.

    Attributes
    ----------
    parts : tuple of JoinedPart
    """

    parts: tuple[JoinedPart, ...]

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        """Return the shapes of all parts."""
        shapes, joints, frames = pin.GeometryModel(), 0, 0
        for part in self.parts:
            for shape in part.geometry.build(part.model, kind).geometryObjects:
                moved = shape.copy()
                moved.name = part.prefix + shape.name
                moved.placement = shape.placement if shape.parentJoint else part.pose * shape.placement
                moved.parentJoint = shape.parentJoint + joints if shape.parentJoint else 0
                moved.parentFrame = shape.parentFrame + frames if shape.parentFrame else 0
                shapes.addGeometryObject(moved)
            joints += part.model.njoints - 1
            frames += part.model.nframes - 1
        return shapes

    def stated(self, kind: pin.GeometryType) -> Counter[str]:
        """Return the number of shapes of the kind on each link of all parts."""
        counts: Counter[str] = Counter()
        for part in self.parts:
            counts.update({part.prefix + link: count for link, count in part.geometry.stated(kind).items()})
        return counts
