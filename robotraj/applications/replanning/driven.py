"""The motion that a control loop followed: the first piece of every plan, joined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from robotraj._util.curves.polynomials import lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj.applications.replanning.replan import Replan
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

SITES = 5
"""Values of each piece: a polynomial of degree four represents an interval of Hermite-Simpson exactly."""


def driven(replans: Sequence[Replan], until: float) -> Solution:
    """Join the plans of a control loop to the motion that it followed, for ``rt.replay``, plots and exports.

    Plan k is followed from its step until the next one. Where a disturbance moved the robot off its plan, the motion
    jumps there to the measured state.

    Parameters
    ----------
    replans : sequence of Replan
        At least two, in the order of their steps.
    until : float
        End of the last piece [s].

    Returns
    -------
    Solution
        One phase from the first step to ``until``. Its status is ``Status.NOT_PROVED`` and its objective NaN, since it
        does not solve one problem.

    Raises
    ------
    InputError
        Fewer than two steps, times that do not ascend, or plans of a gait, whose contacts change.
    """
    times = np.array([*(replan.t for replan in replans), float(until)])
    if len(replans) < 2 or not np.all(np.diff(times) > 0.0):
        raise InputError(
            f"driven() got {len(replans)} plans with times {times[:-1].tolist()} and until={until}; give at least two "
            "plans whose times ascend up to until."
        )
    if any(replan.later for replan in replans):
        raise InputError(
            "driven() joins plans of one phase, but those of a gait change their contacts; keep each plan."
        )
    sites = lobatto_sites(SITES)
    curves = []
    for name in ("x", "z", "u"):
        values = [
            getattr(replan.motion.trajectory, name)(replan.within(begin + sites * (end - begin)))
            for replan, (begin, end) in zip(replans, pairwise(times), strict=True)
        ]
        curves.append(PiecewisePolynomial(times, [sites] * len(values), values))
    first = replans[0].motion
    length = float(times[-1] - times[0])
    phase = replace(first.phase, duration=length, start=None, end=None, objective=None)
    mesh = Mesh(tuple(((times - times[0]) / length).tolist()), HermiteSimpson())
    points = np.unique(np.concatenate([times, times[:-1] + 0.5 * np.diff(times)]))
    trajectory = PhaseTrajectory(
        float(times[0]), length, curves[0], curves[1], curves[2], points, first.trajectory.parameters
    )
    seconds = {"solve": sum(replan.seconds for replan in replans)}
    iterations = sum(replan.iterations for replan in replans)
    return Solution(
        Problem([phase]),
        (PhaseSolution(phase, mesh, trajectory),),
        Status.NOT_PROVED,
        f"driven by {len(replans)} plans of rt.Replanner",
        np.nan,
        iterations,
        seconds,
    )
