"""A plan without dynamics, as a guess for the whole problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.dynamics.kinematics import Kinematics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.fixed_mesh.solve import solve
from robotraj.guess.ends import ends_of, guessed_duration
from robotraj.guess.joint_motion import joint_motion
from robotraj.guess.straight_line import StraightLine
from robotraj.planning.settings import resolve
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint, symbols_of
from robotraj.problem.constraints.joint_limits import JointEffort
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.expressions import Lagrange
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.rows import evaluated
from robotraj.robot.chart import coordinate_difference
from robotraj.robot.limits import Limits
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solvers.base import Solver
from robotraj.solvers.ipopt import Ipopt
from robotraj.transcription.schemes.mesh import Mesh


@dataclass(frozen=True)
class Kinematic(InitialGuess):
    """Plan the same problem without dynamics first, and start from that motion.

    Accelerations are the controls. Ends, links, limits of position, velocity and acceleration, and all constraints that
    do not depend on torques hold. The objective is the integral of the squared accelerations. A free duration is added
    with a weight at which a rest-to-rest motion takes the guessed duration. Torques of the guess are those of inverse
    dynamics along the motion.

    Parameters
    ----------
    mesh : Mesh
        Mesh of every phase of the kinematic plan.
    guess : InitialGuess, optional
        Guess of the kinematic plan; a straight line by default.
    solver : Solver
        Solver of the kinematic plan.
    duration : float, optional
        Guessed duration [s] of each phase where it is free.
    """

    mesh: Mesh = field(default_factory=lambda: Mesh(20))
    guess: InitialGuess = field(default_factory=StraightLine)
    solver: Solver = field(default_factory=Ipopt)
    duration: float | None = None

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Plan one phase alone."""
        return self.prepared(Problem([phase])).of(phase, 0)

    def prepared(self, problem: Problem) -> InitialGuess:
        """Plan all phases and their links without dynamics.

        Where the kinematic plan fails, a warning is issued and its last iterate is the guess.

        Raises
        ------
        InputError
            A phase moves a System.
        """
        phases = [kinematic_phase(phase, self.duration) for phase in problem.phases]
        posed = Problem(phases, problem.links)
        solution = solve(posed, self.guess, resolve(posed, {"mesh": self.mesh, "solver": self.solver}))
        if not solution.success:
            worst = "; ".join(str(violation) for violation in solution.violations(1))
            warn(f"The kinematic plan failed ({solution.status.value}; {worst}); its last iterate is the guess.")
        return _Planned(solution.phases)


@dataclass(frozen=True)
class _Planned(InitialGuess):
    """Motions of the joints, one for each phase."""

    phases: Sequence[PhaseSolution]

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the motion; torques follow by inverse dynamics."""
        part = self.phases[index]

        def motion(s: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
            sample = part.at(part.t0 + np.clip(s, 0.0, 1.0) * part.duration)
            return np.asarray(sample.q), np.asarray(sample.v), np.asarray(sample.a)

        return joint_motion(phase, part.duration, motion, part.parameters)


def kinematic_phase(phase: Phase, duration: float | None = None) -> Phase:
    """Return a phase without dynamics and without constraints that depend on torques.

    Raises
    ------
    InputError
        The phase moves a System.
    """
    robot, limits = phase.robot, phase.limits
    if robot is None:
        raise InputError(f"Kinematic() needs robots, but phase {phase.name!r} moves a System.")
    if isinstance(limits, Limits):
        limits = limits.with_(effort=np.inf, jerk=np.inf)
    kept = [constraint for constraint in phase.constraints if not _reads_torques(constraint, phase)]
    return replace(
        phase,
        objective=_smooth(phase, duration),
        constraints=kept,
        limits=limits,
        controls={},
        algebraic={},
        dynamics=Kinematics(),
    )


def _smooth(phase: Phase, duration: float | None) -> Objective:
    """Return the integral of squared accelerations, plus the duration where it is free.

    From rest to rest over a distance d in T, the least integral of a^2 is 12 d^2 / T^3. The minimum of
    T + w 12 d^2 / T^3 is at T^4 = 36 w d^2.
    """
    low, high = phase.duration_bounds
    smooth = Lagrange(_squared_accelerations)
    if low == high:
        return smooth
    assert phase.robot is not None
    first, last = ends_of(phase)
    nq = phase.robot.nq
    distance = float(np.linalg.norm(coordinate_difference(phase.robot.model, first[:nq], last[:nq])))
    time = guessed_duration(phase, duration)
    weight = time**4 / (36.0 * distance**2) if distance > 0 and time > 0 else 1.0
    return Duration() + weight * smooth


def _squared_accelerations(point: RobotPoint) -> ca.SX:
    return ca.sumsqr(point.a)


def _reads_torques(constraint: Constraint, phase: Phase) -> bool:
    """Whether an expression depends on torques, tested by inverse dynamics, where torques are symbols."""
    inner = constraint.constraint if isinstance(constraint, AtStart | AtEnd) else constraint
    if isinstance(inner, JointEffort):
        return True
    assert phase.robot is not None
    dynamics = InverseDynamics().of(phase.robot)
    point = symbols_of(dynamics, phase.parameter_names)
    values = evaluated(constraint.bind(dynamics, phase.parameter_names), point)
    torques = ca.vertcat(*point.u.values())
    return bool(torques.numel() and ca.depends_on(ca.vertcat(*values), torques))
