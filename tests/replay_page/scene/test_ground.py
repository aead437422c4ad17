from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.replay_page.scene.ground import ground_of

LOW, HIGH = np.array([-0.5, -0.5, 0.0]), np.array([0.5, 0.5, 1.0])


def solution(*constraints, contacts=()):
    phase = SimpleNamespace(constraints=constraints, contacts=contacts)
    return SimpleNamespace(phases=[SimpleNamespace(phase=phase)])


def clearance(ground):
    return rt.GroundClearance("tip", 0.0, ground)


def test_a_clearance_brings_its_ground():
    ground = ground_of(solution(SimpleNamespace(), clearance(rt.terrain.Flat(0.2))), LOW, HIGH)
    assert ground.level == pytest.approx(0.2)
    assert ground.surface is None


def test_a_clearance_at_the_end_alone_brings_its_ground_too():
    assert ground_of(solution(rt.AtEnd(clearance(rt.terrain.Flat(-0.3)))), LOW, HIGH).level == -0.3


def test_what_the_robot_stands_on_comes_before_what_it_clears():
    stands = SimpleNamespace(ground=rt.terrain.Flat(0.1))
    assert ground_of(solution(clearance(rt.terrain.Flat(-0.3)), contacts=[stands]), LOW, HIGH).level == 0.1


HILLS = rt.terrain.HeightMap(0.1 * np.random.default_rng(1).standard_normal((6, 8)), (0.5, 0.4), (-1.3, -1.4))
STEPS = rt.terrain.Steps([-0.2, 0.3], [0.0, 0.15, 0.05], 0.03)


@pytest.mark.parametrize(
    "ground",
    [rt.terrain.Slope(0.3, -0.1, 0.1), STEPS, HILLS, lambda x, y: 0.1 + 0.3 * ca.sin(x) - 0.1 * y],
    ids=["slope", "steps", "height map", "function"],
)
def test_ground_that_is_not_level_is_drawn_as_a_surface(ground):
    drawn = ground_of(solution(clearance(ground)), LOW, HIGH)
    vertices, faces = drawn.surface.vertices, drawn.surface.faces
    height = rt.terrain.HeightFunction(ground).height if callable(ground) else ground.height
    np.testing.assert_allclose(vertices[:, 2], height(vertices[:, 0], vertices[:, 1]), atol=2e-4)
    assert np.all(vertices[:, :2].min(axis=0) < LOW[:2])
    assert np.all(vertices[:, :2].max(axis=0) > HIGH[:2])
    assert drawn.level == pytest.approx(vertices[:, 2].min(), abs=1e-4)
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    assert np.all(np.cross(b - a, c - a)[:, 2] > 0)


def test_steps_are_drawn_with_their_edges():
    vertices = ground_of(solution(clearance(STEPS)), LOW, HIGH).surface.vertices
    for edge, height in ((-0.2, 0.15), (0.3, 0.15)):
        at = np.isclose(vertices[:, 0], edge, atol=1e-4)
        np.testing.assert_allclose(vertices[at, 2], height, atol=1e-4)
        assert at.sum() >= 49


def test_ground_without_a_height_is_a_hole():
    pond = ground_of(solution(clearance(lambda x, y: ca.sqrt(x))), LOW, HIGH).surface.vertices
    assert np.isfinite(pond).all()
    assert pond[:, 0].min() >= 0.0


def test_without_one_the_ground_is_zero_or_below_the_robot():
    assert ground_of(solution(), LOW, HIGH).level == 0.0
    assert ground_of(solution(), LOW + [0, 0, 0.4], HIGH).level == 0.0
    assert -0.9 < ground_of(solution(), LOW - [0, 0, 0.8], HIGH).level < -0.8
