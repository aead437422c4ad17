"""The guess that is made where none is given."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotraj.guess.guess import Guess, StraightLine

if TYPE_CHECKING:
    from robotraj.problem.problem import Problem


def default_guess(problem: Problem) -> Guess:
    """Choose the guess: an inverted pendulum for one robot with a free root on contacts, else a straight line."""
    robots = {id(phase.robot) for phase in problem.phases}
    robot = problem.phases[0].robot
    footed = any(contact.anchors for phase in problem.phases for contact in phase.bound_contacts)
    if len(robots) == 1 and robot is not None and robot.root != "fixed" and footed:
        from robotraj.guess.legs.inverted_pendulum import InvertedPendulum

        return InvertedPendulum()
    return StraightLine()
