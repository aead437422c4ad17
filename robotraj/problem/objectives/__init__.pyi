"""Objectives: values that add up and scale."""

from .base import EndCost, Integral, Objective, Sum
from .duration import Duration
from .effort import Effort
from .expressions import Lagrange, Mayer
from .force_rate import ForceRate
from .momentum import CentroidalMomentum
from .rates import Jerk, TorqueRate
from .redundancy.centering import JointCentering
from .redundancy.manipulability import Manipulability
from .redundancy.variation import SpeedVariation
from .smoothness import FrameSmoothness
from .terminal_pose import TerminalPose
from .tracking import Tracking
from .transport import CostOfTransport
from .work import AbsolutePower, MechanicalWork

__all__ = [
    "AbsolutePower",
    "CentroidalMomentum",
    "CostOfTransport",
    "Duration",
    "Effort",
    "EndCost",
    "ForceRate",
    "FrameSmoothness",
    "Integral",
    "Jerk",
    "JointCentering",
    "Lagrange",
    "Manipulability",
    "Mayer",
    "MechanicalWork",
    "Objective",
    "SpeedVariation",
    "Sum",
    "TerminalPose",
    "TorqueRate",
    "Tracking",
]
