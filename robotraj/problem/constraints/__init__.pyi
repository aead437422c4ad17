"""Constraints: small frozen values, each written once and read by transcription, witness and printing."""

from .base import AtEnd, AtStart, BoundConstraint, Constraint, Row, Where
from .bounds import Between, Bounds, as_bounds, between
from .clearance import GroundClearance
from .clearance_geometry import CollisionShapes
from .collision_free import CollisionFree
from .differential_drive import DifferentialDrive
from .follow_path import FollowPath
from .frame_pose import FramePose, FramePosition
from .heights import RequiredHeight, SwingApex
from .integral import IntegralConstraint
from .joint_limits import JointAcceleration, JointEffort, JointPosition, JointVelocity, own_limits
from .motors.rates import JointJerk, JointTorqueRate
from .path import PathConstraint
from .variable_bounds import VariableBounds

__all__ = [
    "AtEnd",
    "AtStart",
    "Between",
    "BoundConstraint",
    "Bounds",
    "CollisionFree",
    "CollisionShapes",
    "Constraint",
    "DifferentialDrive",
    "FollowPath",
    "FramePose",
    "FramePosition",
    "GroundClearance",
    "IntegralConstraint",
    "JointAcceleration",
    "JointEffort",
    "JointJerk",
    "JointPosition",
    "JointTorqueRate",
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
