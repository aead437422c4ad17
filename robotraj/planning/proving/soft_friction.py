"""Continuation in the softness of dry friction.

Dry friction F tanh(v / v_s) changes its sign within v_s. From a guess without reversals, a solver ends in a poor local
optimum, or takes hundreds of iterations. The problem is first solved with

    F v / sqrt(v^2 + (c v_s)^2)

at falling c, each solution the guess of the next, and then with the robot's own friction. Below c = 1 the curve becomes
tanh (``robotraj.dynamics.motors_and_friction``). The slope of this one falls as v^-3 beside the reversal, that of tanh
exponentially. A Newton step can therefore shift the time of a reversal by a share of its distance from the optimum.
With tanh it shifts by the width of the reversal alone.

On a mesh, friction is seen at the collocation points alone. The effort falls by steps where a reversal passes a point,
so that reversals get stuck between points. They move on with every finer mesh, and the objective does not settle. Soft
friction is therefore averaged over a share of an interval (``robotraj.dynamics.motors_and_friction``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj.dynamics.kinematics import Kinematics
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.fixed_mesh.sizes.shares import shares_of
from robotraj.guess.ends import ends_of, guessed_duration
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.tangent import floats
from robotraj.solution.solution import Solution
from robotraj.transcription.schemes.mesh import Mesh

SOFTEST = 1.0 / 8.0
"""Speed c v_s of the first solve, relative to the largest mean speed of a joint with friction."""
LAST, FALL = 0.5, 3.5
"""The last factor c, and the largest ratio of one factor to the next.

With larger steps fewer plans are proved, smaller ones take longer (``benchmarks/friction.md``).
"""
SMALLEST_FALL = 1.2
"""Least ratio of one factor to the next one after a failed plan; below it, the next plan would hardly differ."""
AVERAGED = 0.1
"""Half the time over which soft friction is averaged, relative to the mean interval of the mesh."""


def softening_of(problem: Problem, near: Solution | None = None) -> tuple[float, ...]:
    """Return the factors c on v_s for the first solves, each on a finer mesh.

    There are none where joints do not stick and slide, or friction is wide enough.

    Parameters
    ----------
    problem : Problem
    near : Solution, optional
        A proved plan of the same motion with wider friction. Softer friction begins at its width.
    """
    rough = [k for k, phase in enumerate(problem.phases) if _has_reversals(phase)]
    if not rough or not shares_of(problem).sticking:
        return ()
    wider = [None if near is None else near.problem.phases[k].robot for k in rough]
    first = max(_softest_factor(problem.phases[k], robot) for k, robot in zip(rough, wider, strict=True))
    if first <= LAST:
        return ()
    steps = int(np.ceil(np.log(first / LAST) / np.log(FALL)))
    return tuple((LAST * (first / LAST) ** (1.0 - np.arange(steps + 1) / steps)).tolist())


def nearer(failed: float, solved: InitialGuess | Solution | None) -> float | None:
    """Return the factor halfway, in its logarithm, from a solution with softer friction to one that failed from it.

    Friction of light joints is steep: from a near solution a solver takes ten iterations, from a distant one it fails.

    Returns
    -------
    float or None
        None where the guess was no solution with soft friction, or the step was small.
    """
    factor = factor_of(solved)
    return float(np.sqrt(factor * failed)) if factor > failed * SMALLEST_FALL**2 else None


def factor_of(guess: InitialGuess | Solution | None) -> float:
    """Return the factor c of a solution with soft friction, 0 of any other guess."""
    if not isinstance(guess, Solution):
        return 0.0
    return max(float(getattr(phase.dynamics, "softening", 0.0)) for phase in guess.problem.phases)


def softest(problem: Problem) -> Problem:
    """Return the problem of the first solve: with the softest friction where joints stick and slide."""
    softening = softening_of(problem)
    return softened(problem, softening[0], (0.0,) * len(problem.phases)) if softening else problem


def _softest_factor(phase: Phase, wider: Robot | None = None) -> float:
    """Return the factor c of the first solve of a phase."""
    robot = phase.robot
    assert robot is not None
    if wider is not None:
        return LAST * wider.friction_speed / robot.friction_speed
    first, last = ends_of(phase)
    way = np.abs(last - first)[: robot.nq][robot.friction > 0.0]
    return SOFTEST * float(way.max()) / guessed_duration(phase, None) / robot.friction_speed


def softened(problem: Problem, softening: float, averaging: Sequence[float]) -> Problem:
    """Return a problem whose robots have the soft friction of c = ``softening``, averaged by e = ``averaging``."""
    phases = zip(problem.phases, averaging, strict=True)
    return Problem([_softer(phase, softening, time) for phase, time in phases], problem.links)


def averaging_times(problem: Problem, meshes: Sequence[Mesh], found: Solution | None) -> tuple[float, ...]:
    """Return e for the soft friction of each phase on these meshes [s].

    A free duration is that of the last solution; e is 0 before the first one.
    """
    if found is not None:
        durations = [part.duration for part in found.phases]
    else:
        durations = [low if low == high else 0.0 for low, high in (phase.duration_bounds for phase in problem.phases)]
    return tuple(AVERAGED * duration / mesh.count for duration, mesh in zip(durations, meshes, strict=True))


def _softer(phase: Phase, softening: float, averaging: float) -> Phase:
    dynamics = phase.dynamics
    if not _has_reversals(phase) or isinstance(dynamics, Kinematics):
        return phase
    if isinstance(dynamics, InverseDynamics):
        return replace(phase, dynamics=replace(dynamics, softening=softening, averaging=averaging))
    return replace(phase, dynamics=replace(dynamics, softening=softening))


def _has_reversals(phase: Phase) -> bool:
    """Whether a plan chooses where the joints of an arm with friction reverse; a given path does."""
    return has_friction(phase) and phase.path is None and phase.robot is not None and phase.robot.root == "fixed"


def has_friction(phase: Phase) -> bool:
    """Whether a robot on a fixed or planar root moves against dry friction; a free root keeps the smooth law."""
    robot = phase.robot
    if robot is None or floats(robot.model) or isinstance(phase.dynamics, Kinematics):
        return False
    return bool(np.any(robot.friction > 0.0))
