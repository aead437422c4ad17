"""Errors over short windows of time bound those of the simulation in ``rt.validate``."""

from __future__ import annotations

import numpy as np

import robotraj as rt
from robotraj.transcription.refinement.assess import errors_of
from robotraj.transcription.refinement.linear_controls import LINES
from robotraj.transcription.refinement.window_errors import SHARE


def test_errors_over_windows_bound_those_of_the_simulation_where_short_intervals_follow_each_other() -> None:
    # Torques that are lines are wrong to one side where the motion bends, and the errors of intervals add up.
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[2.0, 1.0], v=0)
    swing = rt.Phase(rt.load("two_link_arm"), 0.2, *ends, rt.Effort(), limits=None)
    solution = rt.plan(swing, mesh=rt.Mesh(60, LINES), check=False)
    part = solution.phases[0]
    alone = errors_of(part.phase, part.trajectory, part.mesh)
    windows = errors_of(part.phase, part.trajectory, part.mesh, windows=True)
    local = rt.validate(solution).local.worst.relative
    assert np.all(windows >= alone)
    assert windows.max() > 2.0 * alone.max()
    assert local < 2.0 * windows.max() / SHARE
