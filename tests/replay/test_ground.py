from types import SimpleNamespace

import numpy as np
import pytest

from robotraj.replay.ground import ground_of

LOW, HIGH = np.array([-0.5, -0.5, 0.0]), np.array([0.5, 0.5, 1.0])


def solution(*constraints):
    return SimpleNamespace(phases=[SimpleNamespace(phase=SimpleNamespace(constraints=constraints))])


def clearance(height):
    return SimpleNamespace(ground=SimpleNamespace(height=height))


def test_a_clearance_brings_its_ground():
    ground = ground_of(solution(SimpleNamespace(), clearance(lambda x, y: 0.2 + 0.0 * x)), LOW, HIGH)
    assert ground.level == pytest.approx(0.2)
    assert ground.surface is None


def test_a_clearance_at_the_end_alone_brings_its_ground_too():
    assert ground_of(solution(SimpleNamespace(constraint=clearance(lambda x, y: -0.3))), LOW, HIGH).level == -0.3


def test_a_slope_or_a_plain_function_is_drawn_as_a_surface():
    slope = lambda x, y: 0.1 + 0.3 * x - 0.1 * y  # noqa: E731
    for constraint in (clearance(slope), SimpleNamespace(ground=slope)):
        vertices = ground_of(solution(constraint), LOW, HIGH).surface.vertices
        np.testing.assert_allclose(vertices[:, 2], slope(vertices[:, 0], vertices[:, 1]), atol=1e-4)
        assert np.all(vertices[:, :2].min(axis=0) < LOW[:2])
        assert np.all(vertices[:, :2].max(axis=0) > HIGH[:2])


def test_without_one_the_ground_is_zero_or_below_the_robot():
    assert ground_of(solution(), LOW, HIGH).level == 0.0
    assert ground_of(solution(), LOW + [0, 0, 0.4], HIGH).level == 0.0
    assert -0.9 < ground_of(solution(), LOW - [0, 0, 0.8], HIGH).level < -0.8
