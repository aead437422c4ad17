"""Continuation in the softness of dry friction.

Dry friction F tanh(v / v_s) changes its sign within v_s. From a guess without reversals, a solver ends in a poor local
optimum, or takes hundreds of iterations. The problem is first solved with

    F v / sqrt(v^2 + (c v_s)^2)

at falling c, each solution the guess of the next, and then with the robot's own friction. The slope of this curve falls
as v^-3 beside the reversal, that of tanh exponentially. A Newton step can therefore shift the time of a reversal by a
share of its distance from the optimum. With tanh it shifts by the width of the reversal alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj.dynamics.kinematics import Kinematics
from robotraj.problem.objectives.base import Integral
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem

SOFTENING = (10.0, 4.0, 2.0, 1.2)
"""Factors c on v_s for the first solves, each on a finer mesh.

Fewer factors are faster, and fewer plans are proved (``benchmarks/barrier.md``).
"""


def softened(problem: Problem, softening: float) -> Problem:
    """Return a problem whose robots have the soft friction of c = ``softening``."""
    return Problem([_softer(phase, softening) for phase in problem.phases], problem.links)


def needs_softening(problem: Problem) -> bool:
    """Whether an arm with dry friction minimises an integral.

    In least time no joint rests. Legs lose little to friction, and their motions need no guess by softer one.
    """
    return any(_has_friction(phase) and _integrates(phase) for phase in problem.phases)


def _softer(phase: Phase, softening: float) -> Phase:
    dynamics = phase.dynamics
    if not _has_friction(phase) or isinstance(dynamics, Kinematics):
        return phase
    return replace(phase, dynamics=replace(dynamics, softening=softening))


def _has_friction(phase: Phase) -> bool:
    robot = phase.robot
    if robot is None or robot.root != "fixed" or isinstance(phase.dynamics, Kinematics):
        return False
    return bool(np.any(robot.friction > 0.0))


def _integrates(phase: Phase) -> bool:
    return phase.objective is not None and any(isinstance(term, Integral) for _, term in phase.objective.terms)
