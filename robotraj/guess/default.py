"""What ``rt.plan(guess=...)`` accepts, and the guess where none is given."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from robotraj._util.errors import InputError
from robotraj.guess.along_path import AlongPath, follows_path
from robotraj.guess.base import InitialGuess
from robotraj.guess.from_solution import FromSolution, is_solution
from robotraj.guess.straight_line import StraightLine

if TYPE_CHECKING:
    from robotraj.problem.problem import Problem


def default_guess(problem: Problem, branch: int = 0) -> InitialGuess:
    """Return an inverted pendulum for one robot with a free root on contacts, a given path, else a straight line.

    Parameters
    ----------
    problem : Problem
    branch : int
        Rank of the branches of inverse kinematics at ends that constraints decide; see ``rt.guess.StraightLine``.
    """
    robots = {id(phase.robot) for phase in problem.phases}
    robot = problem.phases[0].robot
    footed = any(contact.anchors for phase in problem.phases for contact in phase.bound_contacts)
    if len(robots) == 1 and robot is not None and robot.root != "fixed" and footed:
        from robotraj.guess.legs.inverted_pendulum import InvertedPendulum

        return InvertedPendulum()
    line = StraightLine(branch=branch)
    if any(follows_path(phase) for phase in problem.phases):
        from robotraj.guess.guess import EachPhase

        return EachPhase([AlongPath() if follows_path(phase) else line for phase in problem.phases])
    return line


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
