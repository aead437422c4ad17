"""Constraints: small frozen values, each written once and read by transcription, witness and printing."""

from .base import AtEnd, AtStart, BoundConstraint, Constraint, Row, Where, robot_of
from .bounds import Between, Bounds, NearTurn, as_bounds, between, turns
from .clearance import GroundClearance
from .clearance_geometry import CollisionShapes
from .collision_free import CollisionFree
from .differential_drive import DifferentialDrive
from .follow_path import FollowPath
from .frame_pose import FramePose, FramePosition
from .heights import RequiredHeight, SwingApex
from .integral import IntegralConstraint
from .joint_limits import JointAcceleration, JointEffort, JointPosition, JointVelocity
from .motors.drive import MotorPower, SpeedTorqueCurve
from .motors.own_limits import own_limits
from .motors.payloads import PayloadScenarios
from .motors.rates import JointJerk, JointTorqueRate
from .path import PathConstraint
from .task_space.axis import FrameAxis
from .task_space.candidates import OneOf
from .task_space.region import PoseRegion
from .task_space.tool_motion import FrameAcceleration, FrameSpeed
from .task_space.tool_path import CircularPath, LinearPath
from .variable_bounds import VariableBounds

__all__ = [
    "AtEnd",
    "AtStart",
    "Between",
    "BoundConstraint",
    "Bounds",
    "CircularPath",
    "CollisionFree",
    "CollisionShapes",
    "Constraint",
    "DifferentialDrive",
    "FollowPath",
    "FrameAcceleration",
    "FrameAxis",
    "FramePose",
    "FramePosition",
    "FrameSpeed",
    "GroundClearance",
    "IntegralConstraint",
    "JointAcceleration",
    "JointEffort",
    "JointJerk",
    "JointPosition",
    "JointTorqueRate",
    "JointVelocity",
    "LinearPath",
    "MotorPower",
    "NearTurn",
    "OneOf",
    "PathConstraint",
    "PayloadScenarios",
    "PoseRegion",
    "RequiredHeight",
    "Row",
    "SpeedTorqueCurve",
    "SwingApex",
    "VariableBounds",
    "Where",
    "as_bounds",
    "between",
    "own_limits",
    "robot_of",
    "turns",
]
