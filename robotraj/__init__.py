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
from robotraj.links import Continuity
from robotraj.objectives import AbsolutePower, Duration, Effort, Jerk, Lagrange, Mayer, MechanicalWork, TorqueRate
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
from robotraj.transcription import Nlp, transcribe
from robotraj.witness import validate

__all__ = [
    "AtEnd",
    "AtStart",
    "ConstantControl",
    "Continuity",
    "Duration",
    "Effort",
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
    "Ipopt",
    "JointAcceleration",
    "JointEffort",
    "JointPosition",
    "JointVelocity",
    "Keyframes",
    "Lagrange",
    "Limits",
    "LinearControl",
    "LobattoIIIA",
    "Mayer",
    "Mesh",
    "MovingMesh",
    "Nlp",
    "NoSolutionFound",
    "OwnQuadrature",
    "PathConstraint",
    "Phase",
    "PolynomialControl",
    "Problem",
    "RadauIIA",
    "RaiseOrder",
    "Robot",
    "RobotrajError",
    "Slope",
    "Solution",
    "SplitAndMerge",
    "SplitOrRaise",
    "State",
    "Status",
    "StraightLine",
    "System",
    "Trapezoidal",
    "TrapezoidalQuadrature",
    "UnknownName",
    "ValidationFailed",
    "between",
    "catalogue",
    "load",
    "load_solution",
    "plan",
    "replay",
    "transcribe",
    "validate",
]
