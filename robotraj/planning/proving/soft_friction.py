"""Continuation in the speed at which dry friction saturates.

Dry friction F tanh(v / v_s) changes its sign within v_s. From a guess without reversals, a solver ends in a poor local
optimum, or takes hundreds of iterations. The problem is first solved with larger v_s, each solution the guess of the
next, and then with the v_s of the robot.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj.problem.objectives.base import Integral
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot

SPEEDS = (10.0, 4.0, 2.0)
"""Factors on v_s for the first meshes."""


def softened(problem: Problem, factor: float) -> Problem:
    """Return a problem whose robots have ``factor`` times their ``friction_speed``."""
    phases = [
        replace(phase, subject=_softer(phase.robot, factor)) if phase.robot and _has_friction(phase) else phase
        for phase in problem.phases
    ]
    return Problem(phases, problem.links)


def needs_softening(problem: Problem) -> bool:
    """Whether a robot with a fixed root and dry friction minimises an integral; in least time no joint rests."""
    return any(_has_friction(phase) and _integrates(phase) for phase in problem.phases)


def _has_friction(phase: Phase) -> bool:
    robot = phase.robot
    return robot is not None and robot.root == "fixed" and bool(np.any(robot.friction > 0.0))


def _integrates(phase: Phase) -> bool:
    return phase.objective is not None and any(isinstance(term, Integral) for _, term in phase.objective.terms)


def _softer(robot: Robot, factor: float) -> Robot:
    return replace(robot, friction_speed=factor * robot.friction_speed)
