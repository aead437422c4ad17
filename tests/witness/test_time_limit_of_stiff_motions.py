"""The time limit of a validation holds where a simulation takes a thousand implicit steps."""

from __future__ import annotations

import time
import warnings

import pytest

import robotraj as rt


@pytest.mark.slow
def test_a_stiff_stance_ends_at_the_limit() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = rt.load("monopod")
        foot = next(name for name in robot.frame_names if "foot" in name)
        stand = rt.Phase(robot, 0.3, objective=rt.Effort(), contacts=[rt.PointContact(foot, friction=0.7)])
        solution = rt.plan(stand, mesh=rt.Mesh(3), check=False, progress=False)
        rt.validate(solution, time_limit=0.01)  # what is read once: shapes and modules
        for limit in (0.5, 1.0):
            began = time.process_time()
            report = rt.validate(solution, time_limit=limit)
            assert time.process_time() - began < limit + 1.0
            assert any("time limit" in each for each in report.unchecked)
