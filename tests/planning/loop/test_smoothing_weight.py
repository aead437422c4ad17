"""Smoothing weighs more where the limit of a frame determines the time, in proportion to how much of it is used."""

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.loop.smoothing_weight import smoothing_weight
from robotraj.transcription.refinement.objective_quadrature import squares_cost

FIRST, LAST = np.array([0, -1.2, 1.4, -1.5, -1.57, 0.0]), np.array([1.4, -0.8, 0.9, -1.2, -1.2, 0.5])


def planned(*limits):
    ends = rt.State(q=FIRST, v=0), rt.State(q=LAST, v=0)
    return rt.plan(rt.Phase(rt.load("ur5"), (0.05, 20), *ends, rt.Duration(), limits), rt.Mesh(12), smoothing=5e-3)


def test_without_a_limit_of_a_frame_or_far_within_it_nothing_changes():
    assert smoothing_weight(5e-3, planned().phases) == 5e-3
    far = planned(rt.constraints.FrameSpeed("tool0", linear=1e6)).phases
    assert smoothing_weight(5e-3, far) == pytest.approx(5e-3, rel=1e-3)


def test_at_the_limit_smoothing_is_its_share_of_the_duration():
    slow = planned(rt.constraints.FrameSpeed("tool0", linear=0.1))
    part = slow.phases[0]
    weight = smoothing_weight(5e-3, slow.phases)
    cost = squares_cost(part.phase, part.trajectory, part.mesh.schemes, weight)
    assert 0.9 * 5e-3 < cost / part.duration <= 5e-3 * (1 + 1e-9)


def test_what_is_added_is_proportional_to_the_share_of_the_limit_that_a_motion_uses():
    part = planned().phases[0]

    def added(limit):
        limited = part.phase.with_(constraints=[rt.constraints.FrameSpeed("tool0", linear=limit)])
        return smoothing_weight(5e-3, [replace(part, phase=limited)]) - 5e-3

    assert added(20.0) > 0.0
    assert added(20.0) / added(40.0) == pytest.approx(2.0, rel=1e-6)


def test_an_effort_is_not_smoothed():
    ends = rt.State(q=FIRST, v=0), rt.State(q=LAST, v=0)
    limit = rt.constraints.FrameSpeed("tool0", linear=2.0)
    effort = rt.plan(rt.Phase(rt.load("ur5"), 3.0, *ends, rt.Effort(), [limit]), rt.Mesh(12))
    assert smoothing_weight(5e-3, effort.phases) == 5e-3
