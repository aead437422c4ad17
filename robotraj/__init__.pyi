"""robotraj: plan robot motions by direct collocation and prove them by simulation."""

from . import (
    applications,
    dynamics,
    gait,
    guess,
    indirect,
    planning,
    robot,
    solution,
    solvers,
    symbolic,
    transcription,
    witness,
)
from ._util.errors import InputError, RobotrajError, UnknownName, ValidationFailed
from .applications.many.multistart import multistart
from .applications.many.sweep import sweep
from .applications.paths.on_path import override, stop_on_path
from .applications.paths.retime import retime
from .applications.paths.shared_cell import share_cell
from .applications.paths.waypoints import Waypoints
from .applications.problem_files.load import load_problem
from .applications.programs.moves import MoveC, MoveJ, MoveL
from .applications.programs.program import Program
from .applications.replanning.replanner import Replanner
from .applications.studies.study import Study
from .dynamics import contacts, design, obstacles, terrain
from .dynamics.applied_forces.external_force import ExternalForce
from .dynamics.applied_forces.thruster import Thruster
from .dynamics.contacts.flat_foot import FlatFoot
from .dynamics.contacts.point_contact import PointContact
from .dynamics.system import System
from .guess.guess import Guess
from .native import engines
from .planning.plan import plan
from .problem import constraints, links, objectives
from .problem.constraints.base import AtEnd, AtStart
from .problem.constraints.bounds import between, turns
from .problem.constraints.clearance import GroundClearance
from .problem.constraints.collision_free import CollisionFree
from .problem.constraints.frame_pose import FramePose, FramePosition
from .problem.constraints.path import PathConstraint
from .problem.links.continuity import Continuity
from .problem.links.periodic import Mirror, Periodic
from .problem.links.touchdown import Touchdown
from .problem.objectives.duration import Duration
from .problem.objectives.effort import Effort
from .problem.objectives.expressions import Lagrange, Mayer
from .problem.phase import Phase
from .problem.problem import Problem
from .problem.state import State
from .replay_page.write import replay
from .robot.load import load
from .robot.robot import Robot
from .solution.errors import NoSolutionFound
from .solution.solution import Solution
from .solution.storage.load import load_solution
from .solvers.interior_point import InteriorPoint
from .solvers.ipopt import Ipopt
from .transcription import interval_limits, refinement, schemes
from .transcription.schemes.lobatto import HermiteSimpson
from .transcription.schemes.mesh import Mesh
from .witness.validation import validate

__version__: str

__all__ = [
    "AtEnd",
    "AtStart",
    "CollisionFree",
    "Continuity",
    "Duration",
    "Effort",
    "ExternalForce",
    "FlatFoot",
    "FramePose",
    "FramePosition",
    "GroundClearance",
    "Guess",
    "HermiteSimpson",
    "InputError",
    "InteriorPoint",
    "Ipopt",
    "Lagrange",
    "Mayer",
    "Mesh",
    "Mirror",
    "MoveC",
    "MoveJ",
    "MoveL",
    "NoSolutionFound",
    "PathConstraint",
    "Periodic",
    "Phase",
    "PointContact",
    "Problem",
    "Program",
    "Replanner",
    "Robot",
    "RobotrajError",
    "Solution",
    "State",
    "Study",
    "System",
    "Thruster",
    "Touchdown",
    "UnknownName",
    "ValidationFailed",
    "Waypoints",
    "applications",
    "between",
    "constraints",
    "contacts",
    "design",
    "dynamics",
    "engines",
    "gait",
    "guess",
    "indirect",
    "interval_limits",
    "links",
    "load",
    "load_problem",
    "load_solution",
    "multistart",
    "objectives",
    "obstacles",
    "override",
    "plan",
    "planning",
    "refinement",
    "replay",
    "retime",
    "robot",
    "schemes",
    "share_cell",
    "solution",
    "solvers",
    "stop_on_path",
    "sweep",
    "symbolic",
    "terrain",
    "transcription",
    "turns",
    "validate",
    "witness",
]
