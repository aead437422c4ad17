"""Constraints: small frozen values, each written once and read by transcription, witness and printing."""

from robotraj.constraints.base import AtEnd, AtStart, BoundConstraint, Constraint, Row, Where
from robotraj.constraints.between import Between, Bounds, as_bounds, between
from robotraj.constraints.clearance import GroundClearance
from robotraj.constraints.frame_pose import FramePose, FramePosition
from robotraj.constraints.heights import RequiredHeight, SwingApex
from robotraj.constraints.integral import IntegralConstraint
from robotraj.constraints.joint_limits import JointAcceleration, JointEffort, JointPosition, JointVelocity, own_limits
from robotraj.constraints.path import PathConstraint
from robotraj.constraints.spots import CollisionShapes
from robotraj.constraints.variable_bounds import VariableBounds

__all__ = [
    "AtEnd",
    "AtStart",
    "Between",
    "BoundConstraint",
    "Bounds",
    "CollisionShapes",
    "Constraint",
    "FramePose",
    "FramePosition",
    "GroundClearance",
    "IntegralConstraint",
    "JointAcceleration",
    "JointEffort",
    "JointPosition",
    "JointVelocity",
    "PathConstraint",
    "RequiredHeight",
    "Row",
    "SwingApex",
    "VariableBounds",
    "Where",
    "as_bounds",
    "between",
    "own_limits",
]
