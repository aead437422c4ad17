"""The default guess, and the values that ``rt.plan(guess=...)`` accepts."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj.dynamics.expression_values import as_rows
from robotraj.guess.along_path import AlongPath
from robotraj.guess.from_solution import FromSolution, is_solution
from robotraj.guess.perturbed import Perturbed
from robotraj.guess.simulated import Simulated
from robotraj.guess.straight_line import StraightLine
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem


def default_guess(problem: Problem, branch: int = 0) -> InitialGuess:
    """Return the default guess of a problem.

    It is an inverted pendulum for one robot with a free root on contacts. A System that moves from a known state to a
    free end is simulated, unless the objective weighs its states along the way. A phase with ``FollowPath`` gets its
    path, others a straight line. Among obstacles, a path around them replaces a straight line that is not free.

    Parameters
    ----------
    problem : Problem
    branch : int
        Rank of the branches of inverse kinematics at ends that constraints determine, and of the paths around
        obstacles. See ``rt.guess.StraightLine`` and ``rt.guess.GeometricPath``.
    """
    robots = {id(phase.robot) for phase in problem.phases}
    robot = problem.phases[0].robot
    if len(robots) == 1 and robot is not None and robot.root != "fixed" and problem.has_footholds:
        from robotraj.guess.legs.inverted_pendulum import InvertedPendulum

        return InvertedPendulum()
    if moves_freely(problem) and not _weighs_states(problem.phases[0]):
        return Simulated()
    line = StraightLine(branch=branch)
    free: InitialGuess = line
    if _avoids_collisions(problem):
        from robotraj.guess.paths.geometric_path import GeometricPath

        free = GeometricPath(line, rank=branch)
    if any(phase.path is not None for phase in problem.phases):
        from robotraj.guess.guess import EachPhase

        return EachPhase([free if phase.path is None else AlongPath() for phase in problem.phases])
    return free


def moves_freely(problem: Problem) -> bool:
    """Whether one System without algebraic variables moves from a known state, to an end of which little is given.

    A straight line is far from the motions of such systems, and satisfies no equation of theirs.
    """
    phase = problem.phases[0]
    if len(problem.phases) > 1 or phase.robot is not None or phase.dae.algebraic:
        return False
    start, end = phase.start_bounds, phase.end_bounds
    return bool(np.all(start.lower == start.upper) and np.mean(end.lower == end.upper) < 0.5)


def _weighs_states(phase: Phase) -> bool:
    """Whether an integral of the objective depends on the states.

    It mostly keeps them near some values, such as an unstable equilibrium, from which the simulated motion departs.
    """
    point = phase.rows.point
    rates = [as_rows(term.rate(point), "integrand")[0] for _, term in phase.integrals]
    return ca.depends_on(ca.vertcat(ca.SX(0, 1), *rates), ca.vertcat(*point.x.values()))


def other_guess(
    problem: Problem, rank: int, seed: tuple[int, ...], spread: float = 1.0, given: InitialGuess | None = None
) -> InitialGuess:
    """Return another start: among obstacles the path of a rank, else a seeded variation of a guess.

    Parameters
    ----------
    problem : Problem
    rank : int
        Above 0.
    seed, spread
        As for ``rt.guess.Perturbed``.
    given : InitialGuess, optional
        The guess that is varied; by default the default guess of this rank.
    """
    guess = given or default_guess(problem, rank)
    return guess if given is None and _avoids_collisions(problem) else Perturbed(guess, seed, spread)


def _avoids_collisions(problem: Problem) -> bool:
    return any(each.avoids_collisions for phase in problem.phases for each in phase.constraints)


def as_guess(value: object) -> InitialGuess | None:
    """Accept a guess, a sequence with one guess a phase, an earlier solution or None.

    Raises
    ------
    InputError
        Any other value.
    """
    if value is None or isinstance(value, InitialGuess):
        return value
    if is_solution(value):
        return FromSolution(value)
    if isinstance(value, Sequence) and value and all(isinstance(entry, InitialGuess) for entry in value):
        from robotraj.guess.guess import EachPhase

        return EachPhase(value)
    raise InputError(
        "guess= must be None, a guess such as rt.guess.StraightLine(), a sequence with one guess a phase, or a "
        f"Solution; got {type(value).__name__}."
    )
