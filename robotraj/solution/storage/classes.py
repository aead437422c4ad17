"""The classes that a file may hold, and which values their fields accept.

Nothing else is made from a file. A class belongs here if making it only stores and checks its fields. It must not open
a file, run a command or import code.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import MISSING, fields
from enum import Enum
from functools import cache
from pathlib import Path

import numpy as np

from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.dynamics.applied_forces.external_force import ExternalForce
from robotraj.dynamics.applied_forces.thruster import Thruster
from robotraj.dynamics.contacts.cones import Linearised, SecondOrder
from robotraj.dynamics.contacts.edges.arc_foot import ArcFoot
from robotraj.dynamics.contacts.edges.line_contact import LineContact
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.implicit import ImplicitContact
from robotraj.dynamics.contacts.loop_closure import LoopClosure
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.contacts.soles import FourCorners, PressureAndTorsion
from robotraj.dynamics.design.damping import JointDamping
from robotraj.dynamics.design.gear import GearRatio
from robotraj.dynamics.design.length import LinkLength
from robotraj.dynamics.design.mass import BodyMass
from robotraj.dynamics.design.payload import Payload
from robotraj.dynamics.kinematics import Kinematics
from robotraj.dynamics.obstacles.convex_mesh import ConvexMesh
from robotraj.dynamics.obstacles.shapes import Box, Capsule, Cylinder, HalfSpace, Sphere
from robotraj.dynamics.rigid_body_forms import ForwardDynamics, InverseDynamics
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.height_map import HeightMap
from robotraj.dynamics.terrain.lowest import Lowest
from robotraj.dynamics.terrain.plane import Plane
from robotraj.dynamics.terrain.slope import Slope
from robotraj.dynamics.terrain.steps import Steps
from robotraj.dynamics.variable import Variable
from robotraj.gait.bounds.own_sides import LateralDistance, OwnSides
from robotraj.gait.bounds.swing_clearance import SwingArc
from robotraj.gait.bounds.turning import Turning
from robotraj.gait.bounds.upright import RootHeight, Upright
from robotraj.gait.posture import FixedPosture, Haste, SquaredAccelerations
from robotraj.gait.repetition import DurationRatio
from robotraj.gait.stepping.foothold_arcs import FootholdArc, TimedArc
from robotraj.guess.paths.planner import PathPlanner
from robotraj.native.engines.base import VirtualMachine
from robotraj.native.engines.compiled import Compiled
from robotraj.native.engines.native import Native
from robotraj.problem.constraints.base import AtEnd, AtStart
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.clearance_geometry import ClearancePoint, CollisionShapes
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.constraints.differential_drive import DifferentialDrive
from robotraj.problem.constraints.follow_path import FollowPath
from robotraj.problem.constraints.frame_pose import FramePose, FramePosition
from robotraj.problem.constraints.heights import SwingApex
from robotraj.problem.constraints.integral import IntegralConstraint
from robotraj.problem.constraints.joint_limits import JointAcceleration, JointEffort, JointPosition, JointVelocity
from robotraj.problem.constraints.motors.drive import MotorPower, SpeedTorqueCurve
from robotraj.problem.constraints.motors.end_accelerations import EndAcceleration, HoldingTorque
from robotraj.problem.constraints.motors.payloads import PayloadScenarios
from robotraj.problem.constraints.motors.rates import JointJerk, JointTorqueRate
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.constraints.task_space.axis import FrameAxis
from robotraj.problem.constraints.task_space.candidates import OneOf
from robotraj.problem.constraints.task_space.region import PoseRegion
from robotraj.problem.constraints.task_space.tool_motion import FrameAcceleration, FrameSpeed
from robotraj.problem.constraints.task_space.tool_path import CircularPath, LinearPath
from robotraj.problem.constraints.variable_bounds import VariableBounds
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.links.continuity import Continuity, Jump
from robotraj.problem.links.linkage import EqualDuration, Linkage, SameParameter
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Liftoff, Touchdown
from robotraj.problem.objectives.base import Sum
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.objectives.expressions import Lagrange, Mayer
from robotraj.problem.objectives.force_rate import ForceRate
from robotraj.problem.objectives.momentum import CentroidalMomentum
from robotraj.problem.objectives.rates import Jerk, TorqueRate
from robotraj.problem.objectives.redundancy.centering import JointCentering
from robotraj.problem.objectives.redundancy.manipulability import Manipulability
from robotraj.problem.objectives.redundancy.variation import SpeedVariation
from robotraj.problem.objectives.smoothness import FrameSmoothness
from robotraj.problem.objectives.terminal_pose import TerminalPose
from robotraj.problem.objectives.tracking import Tracking
from robotraj.problem.objectives.transport import CostOfTransport
from robotraj.problem.objectives.work import AbsolutePower, MechanicalWork, SoftWork
from robotraj.problem.state import State
from robotraj.robot.carried_body import CarriedBody
from robotraj.robot.limits import Limits
from robotraj.robot.loading.geometry import NoGeometry, UrdfGeometry
from robotraj.robot.loading.joined import JoinedGeometry, JoinedPart
from robotraj.robot.robot import Robot
from robotraj.solution.conflict import Conflict
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solution.proof import Goals, Proof
from robotraj.solution.records import ContinuationRecord, MeshStep, Round
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.storage.missing_contact import MissingContact
from robotraj.solution.violation import Violation
from robotraj.solvers.base import Multipliers
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.ipopt import Ipopt
from robotraj.solvers.status import Status
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.methods import BernsteinBounds, ConstraintGeneration
from robotraj.transcription.interval_limits.row_places import AddedRow
from robotraj.transcription.refinement.equidistribution import Equidistribute
from robotraj.transcription.refinement.raise_order import RaiseOrder, SplitOrRaise
from robotraj.transcription.refinement.split_and_merge import SplitAndMerge
from robotraj.transcription.schemes.compressed import CompressedHermiteSimpson
from robotraj.transcription.schemes.control import ConstantControl, LinearControl, PolynomialControl
from robotraj.transcription.schemes.gauss import GaussLegendre
from robotraj.transcription.schemes.integrators import Adaptive, RungeKutta4
from robotraj.transcription.schemes.lobatto import FifthDegree, HermiteSimpson, LobattoIIIA, Trapezoidal
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.quadrature import OwnQuadrature, TrapezoidalQuadrature
from robotraj.transcription.schemes.radau import RadauIIA
from robotraj.transcription.schemes.shooting import MultipleShooting, SingleShooting

# fmt: off
OF_PROBLEMS: Mapping[str, type] = {
    kind.__name__: kind
    for kind in (
        # problems
        State, Between, Limits, AtEnd, AtStart, GroundClearance, CollisionShapes, FollowPath,
        FramePose, FramePosition, SwingApex, FrameAxis, MotorPower, SpeedTorqueCurve, PayloadScenarios, CarriedBody,
        OneOf, PoseRegion, FrameAcceleration, FrameSpeed, CircularPath, LinearPath, JointCentering, Manipulability,
        SpeedVariation,
        DifferentialDrive, IntegralConstraint, JointAcceleration, JointEffort, JointPosition, JointVelocity,
        PathConstraint, JointJerk, JointTorqueRate, VariableBounds, Continuity, Jump, EqualDuration, Linkage,
        SameParameter, Mirror, Periodic, Liftoff, Touchdown, Duration, Effort, Lagrange, Mayer, ForceRate,
        CentroidalMomentum, Jerk, TorqueRate, FrameSmoothness, TerminalPose, Tracking, CostOfTransport, AbsolutePower,
        MechanicalWork,
        # dynamics, contacts, terrain
        ForwardDynamics, InverseDynamics, Kinematics, ArcFoot, FlatFoot, ImplicitContact, LineContact, LoopClosure,
        PointContact, Spot, Linearised, SecondOrder, FourCorners, PressureAndTorsion, JointDamping, GearRatio,
        LinkLength, BodyMass, Payload, Flat, HeightMap, Lowest, Plane, Slope, Steps, ExternalForce,
        Thruster,
        # obstacles
        CollisionFree, Box, Capsule, ConvexMesh, Cylinder, HalfSpace, Sphere,
        # expressions of gaits that are plain data
        DurationRatio, SwingArc, FootholdArc, TimedArc, FixedPosture, Haste, SquaredAccelerations, RootHeight, Upright,
        Turning, OwnSides, LateralDistance,
        # settings
        Goals, Restarts, VirtualMachine, Compiled, Native, InteriorPoint, Ipopt, BernsteinBounds,
        ConstraintGeneration, Equidistribute, RaiseOrder, SplitOrRaise, SplitAndMerge, Mesh, MovingMesh,
        ConstantControl, LinearControl, PolynomialControl, OwnQuadrature, TrapezoidalQuadrature,
        CompressedHermiteSimpson, FifthDegree, GaussLegendre, HermiteSimpson, LobattoIIIA, RadauIIA, Trapezoidal,
        MultipleShooting, SingleShooting, Adaptive, RungeKutta4,
    )
}
"""What users give for a problem and its settings, by name; files of problems in TOML name the same classes."""

OF_PLANS: Mapping[str, type] = {
    kind.__name__: kind
    for kind in (
        # robots, and what binding a constraint adds
        Robot, NoGeometry, UrdfGeometry, JoinedGeometry, JoinedPart, ClearancePoint, Sum,
        # a work whose kinks are rounded
        SoftWork,
        # what phases add at their ends
        EndAcceleration, HoldingTorque,
        # solutions
        PiecewisePolynomial, PhaseTrajectory, Conflict, PhaseDuals, Proof, ContinuationRecord, MeshStep, Violation,
        Multipliers, AddedRow, Settings, MissingContact, Variable, Round,
    )
}
"""What loading and planning add, by name."""
# fmt: on

CLASSES: Mapping[str, type] = {**OF_PROBLEMS, **OF_PLANS}
"""Classes by name. No name is defined twice in the package."""

ENUMS: Mapping[str, type[Enum]] = {"Status": Status}

NOT_KEPT: Mapping[str, frozenset[str]] = {"Compiled": frozenset({"compiler", "cache"})}
"""Fields that a file neither holds nor sets: a command that would be run, a folder that would be written to."""

MOST = 10**9
"""Largest whole number of a field."""

GREATEST: Mapping[tuple[str, str], int] = {
    ("Mesh", "intervals"): 10**5,
    ("MovingMesh", "intervals"): 10**5,
    ("GaussLegendre", "points"): 64,
    ("LobattoIIIA", "points"): 64,
    ("RadauIIA", "points"): 64,
    ("RungeKutta4", "substeps"): 10**4,
    ("Linearised", "faces"): 10**4,
    ("Limits", "free"): 6,
}
"""Largest whole numbers of fields that decide how much is computed when a value is made."""

_PLAIN: Mapping[str, tuple[type, ...]] = {
    "None": (type(None),),
    "bool": (bool,),
    "int": (int,),
    "float": (float, int),
    "str": (str,),
    "Path": (Path,),
    "Array": (np.ndarray,),
    "Mapping": (Mapping,),
    "dict": (dict,),
    "Sequence": (list, tuple, np.ndarray),
    "tuple": (tuple,),
    "list": (list,),
}


@cache
def layout() -> str:
    """Return a hash of the classes and of their fields: files with the same one differ in no class."""
    lines = [f"{name} {[(each.name, str(each.type)) for each in fields(kind)]}" for name, kind in CLASSES.items()]
    lines += [f"{name} {list(kind.__members__)}" for name, kind in ENUMS.items()]
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()[:16]


def mismatch(kind: type, given: Mapping[str, object]) -> str | None:
    """Return why a dataclass cannot be made from these fields, or None where it can.

    Names and kinds of values are compared with the annotations. Ranges are checked by the class itself.
    """
    known = {field.name: field for field in fields(kind) if field.init}
    name = kind.__name__
    unknown = sorted(set(given) - (set(known) - NOT_KEPT.get(name, frozenset())))
    if unknown:
        return f"{name} has no field {unknown[0]!r} in files"
    for field in known.values():
        if field.name not in given:
            if field.default is MISSING and field.default_factory is MISSING:
                return f"{name} lacks its field {field.name!r}"
            continue
        value = given[field.name]
        if not fits(value, str(field.type)):
            return f"{field.name} of {name} is a {type(value).__name__}, not {field.type}"
        most = GREATEST.get((name, field.name), MOST)
        if isinstance(value, int) and abs(value) > most:
            return f"{field.name} of {name} is {value}, above {most}"
    if kind is Ipopt and not all(isinstance(value, int | float) for value in dict(given.get("options", {})).values()):  # type: ignore[call-overload]
        # A text may name a file that IPOPT writes, or a library that it loads.
        return "options of Ipopt are numbers in files"
    if kind is CollisionFree and isinstance(given.get("srdf"), str | Path):
        return "srdf of CollisionFree is a path, not the pairs that files hold"
    return None


def fits(value: object, annotation: str) -> bool:
    """Whether a value has one of the types of an annotation such as ``"float | tuple[str, ...] | None"``.

    Names that are neither plain types nor in ``BASES`` accept every value.
    """
    return any(_fits_one(value, part) for part in split(annotation, "|"))


def _fits_one(value: object, part: str) -> bool:
    name, _, inside = part.strip().removesuffix("]").partition("[")
    name = name.rsplit(".", 1)[-1]
    if name in _PLAIN:
        right = isinstance(value, _PLAIN[name]) and not (isinstance(value, bool) and name in ("int", "float"))
        if isinstance(value, np.ndarray) and name == "Array":
            return value.dtype.kind in "fiub"
        return right and (not inside or _entries_fit(value, split(inside, ",")))
    if name == "Callable":
        return callable(value)
    if name in BASES:
        return any(base.__name__ == name for base in type(value).__mro__)
    return True


def _entries_fit(value: object, kinds: list[str]) -> bool:
    if isinstance(value, Mapping):
        return all(isinstance(key, str) and fits(entry, kinds[-1]) for key, entry in value.items())
    if not isinstance(value, list | tuple):
        return True
    if len(kinds) == 1 or kinds[-1] == "...":
        return all(fits(entry, kinds[0]) for entry in value)
    return len(kinds) == len(value) and all(fits(entry, kind) for entry, kind in zip(value, kinds, strict=True))


def split(annotation: str, separator: str) -> list[str]:
    """Split an annotation at a separator outside brackets."""
    parts, depth = [""], 0
    for letter in annotation:
        depth += (letter == "[") - (letter == "]")
        if letter == separator and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


GUESSES: tuple[type, ...] = (InitialGuess, PathPlanner)
"""Bases of what a problem file may state and a saved solution does not hold."""
BASES = frozenset(base.__name__ for kind in (*CLASSES.values(), *ENUMS.values(), *GUESSES) for base in kind.__mro__)
"""Names of classes that values are compared with, where an annotation names them."""
