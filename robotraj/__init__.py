"""robotraj: plan robot motions by direct collocation and prove them by simulation."""

from robotraj.constraints import (
    AtEnd,
    AtStart,
    Flat,
    FramePose,
    FramePosition,
    GroundClearance,
    HeightFunction,
    JointAcceleration,
    JointEffort,
    JointPosition,
    JointVelocity,
    PathConstraint,
    Slope,
    between,
)
from robotraj.dynamics import ForwardDynamics, InverseDynamics, System
from robotraj.errors import InputError, NoSolutionFound, RobotrajError, UnknownName, ValidationFailed
from robotraj.guess import FromSolution, Keyframes, StraightLine
from robotraj.guesses import InverseKinematics, MinimumJerk, Perturbed
from robotraj.indirect import PolishFailed, conditions, costates, polish
from robotraj.links import Continuity, EqualDuration, Jump, Linkage, Mirror, Periodic, SameParameter
from robotraj.multistart import Multistart, Optimum, multistart
from robotraj.objectives import (
    AbsolutePower,
    CostOfTransport,
    Duration,
    Effort,
    Jerk,
    Lagrange,
    Mayer,
    MechanicalWork,
    TerminalPose,
    TorqueRate,
    Tracking,
)
from robotraj.planning import plan
from robotraj.problem import Phase, Problem
from robotraj.refinement import RaiseOrder, SplitAndMerge, SplitOrRaise
from robotraj.replay import replay
from robotraj.robot import Limits, Robot, catalogue, load
from robotraj.schemes import (
    ConstantControl,
    FifthDegree,
    GaussLegendre,
    HermiteSimpson,
    LinearControl,
    LobattoIIIA,
    Mesh,
    MovingMesh,
    OwnQuadrature,
    PolynomialControl,
    RadauIIA,
    Trapezoidal,
    TrapezoidalQuadrature,
)
from robotraj.solution import Solution, load_solution
from robotraj.solvers import Ipopt
from robotraj.state import State
from robotraj.status import Status
from robotraj.sweep import sweep
from robotraj.transcription import Nlp, transcribe
from robotraj.witness import validate

__all__ = [
    "AbsolutePower",
    "AtEnd",
    "AtStart",
    "ConstantControl",
    "Continuity",
    "CostOfTransport",
    "Duration",
    "Effort",
    "EqualDuration",
    "FifthDegree",
    "Flat",
    "ForwardDynamics",
    "FramePose",
    "FramePosition",
    "FromSolution",
    "GaussLegendre",
    "GroundClearance",
    "HeightFunction",
    "HermiteSimpson",
    "InputError",
    "InverseDynamics",
    "InverseKinematics",
    "Ipopt",
    "Jerk",
    "JointAcceleration",
    "JointEffort",
    "JointPosition",
    "JointVelocity",
    "Jump",
    "Keyframes",
    "Lagrange",
    "Limits",
    "LinearControl",
    "Linkage",
    "LobattoIIIA",
    "Mayer",
    "MechanicalWork",
    "Mesh",
    "MinimumJerk",
    "Mirror",
    "MovingMesh",
    "Multistart",
    "Nlp",
    "NoSolutionFound",
    "Optimum",
    "OwnQuadrature",
    "PathConstraint",
    "Periodic",
    "Perturbed",
    "Phase",
    "PolishFailed",
    "PolynomialControl",
    "Problem",
    "RadauIIA",
    "RaiseOrder",
    "Robot",
    "RobotrajError",
    "SameParameter",
    "Slope",
    "Solution",
    "SplitAndMerge",
    "SplitOrRaise",
    "State",
    "Status",
    "StraightLine",
    "System",
    "TerminalPose",
    "TorqueRate",
    "Tracking",
    "Trapezoidal",
    "TrapezoidalQuadrature",
    "UnknownName",
    "ValidationFailed",
    "between",
    "catalogue",
    "conditions",
    "costates",
    "load",
    "load_solution",
    "multistart",
    "plan",
    "polish",
    "replay",
    "sweep",
    "transcribe",
    "validate",
]
