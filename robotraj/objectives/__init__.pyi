"""Objectives: values that add up and scale."""

from robotraj.objectives.augmentation import Augmented, body_of
from robotraj.objectives.base import EndCost, Integral, Objective, Sum
from robotraj.objectives.duration import Duration
from robotraj.objectives.effort import Effort
from robotraj.objectives.force_rate import ForceRate
from robotraj.objectives.lagrange import Lagrange
from robotraj.objectives.mayer import Mayer
from robotraj.objectives.momentum import CentroidalMomentum
from robotraj.objectives.rates import Jerk, TorqueRate
from robotraj.objectives.smoothness import FrameSmoothness
from robotraj.objectives.terminal_pose import TerminalPose
from robotraj.objectives.tracking import Tracking
from robotraj.objectives.transport import CostOfTransport
from robotraj.objectives.work import AbsolutePower, MechanicalWork

__all__ = [
    "AbsolutePower",
    "Augmented",
    "CentroidalMomentum",
    "CostOfTransport",
    "Duration",
    "Effort",
    "EndCost",
    "ForceRate",
    "FrameSmoothness",
    "Integral",
    "Jerk",
    "Lagrange",
    "Mayer",
    "MechanicalWork",
    "Objective",
    "Sum",
    "TerminalPose",
    "TorqueRate",
    "Tracking",
    "body_of",
]
