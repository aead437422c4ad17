import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.native.build import load_native
from robotraj.problem.clearance.end_checks import clearances_of
from robotraj.transcription.clearance.distance_functions import constants_of, function_of, key_of
from robotraj.transcription.clearance.nearest_planes import NearestPlanes

BALL = rt.obstacles.Sphere(0.1, lambda t: (0.6 + 0.1 * ca.sin(3.0 * t), 0.2, 0.4))
BOX = rt.obstacles.Box((0.3, 0.2, 0.4), (-0.5, 0.5, 0.2), (0.0, 0.0, np.sin(0.3), np.cos(0.3)))


def grouped(pairs):
    groups = {}
    for pair in range(len(pairs)):
        groups.setdefault(key_of(pairs, pair, plane=True), []).append(pair)
    return [np.array(each) for each in groups.values() if function_of(pairs, each[0], plane=True).positions.size]


@pytest.mark.parametrize("name", ["ur5", "panda", "kinova"])
def test_planes_touch_the_distances_of_the_nearest_pairs(name):
    robot = rt.load(name)
    (pairs,) = clearances_of([rt.CollisionFree([BALL, BOX], margin=0.01)], robot)
    rng = np.random.default_rng(3)
    q = robot.neutral + np.zeros((5, robot.nq))
    if robot.nq == robot.nv:
        q = rng.uniform(-1.0, 1.0, (5, robot.nq))
    times = np.linspace(0.0, 1.0, 5)
    groups = grouped(pairs)
    counts = [min(2, len(group)) for group in groups]
    found = NearestPlanes(pairs, groups, counts).along(q, times)
    distances = pairs.distances(q, times)
    known = np.concatenate(groups)
    np.testing.assert_allclose(found.first_distances[known], distances[0, known], atol=1e-12)
    for group, count, chosen, planes in zip(groups, counts, found.pairs, found.planes, strict=True):
        nearest = np.take_along_axis(distances, chosen, axis=1)
        np.testing.assert_allclose(nearest, np.sort(distances[:, group], axis=1)[:, :count], atol=1e-12)
        stage = function_of(pairs, int(group[0]), plane=True)
        for k in range(count):
            constants = np.column_stack([constants_of(pairs, chosen[:, k]), planes[:, k]])
            values = stage.stage.evaluate("function", q[:, stage.positions].T, constants.T)[0]
            np.testing.assert_allclose(values, nearest[:, k], atol=1e-9)


def test_wrong_arrays_are_refused():
    none, numbers = np.zeros(0, dtype=np.int64), np.zeros(0)
    ball, eye = np.array([0.0, 0.0, 0.0, 0.1] * 2), np.eye(3).ravel()

    def made(joints=(1, 1), first=(0,), second=(1,), group=(1, 1, 1, 0)):
        given = (np.array(each, dtype=np.int64) for each in (joints, first, second, group))
        joints, first, second, group = given
        return load_native().NearestPlanes(joints, ball, none, numbers, none, numbers, first, second, group, eye)

    planes = made()
    places = np.tile(np.append(eye, np.zeros(3)), 2)
    assert planes.find(places, numbers, 1)[1].tolist() == [0]
    for wrong in (
        {"joints": (1,)},
        {"second": (2,)},
        {"first": (-1,)},
        {"group": (1, 2, 1, 0)},
        {"group": (2, 1, 1, 0)},
        {"group": (1, 1, 0, 0)},
    ):
        with pytest.raises(ValueError):
            made(**wrong)
    with pytest.raises(ValueError, match="without a place"):
        planes.find(places[:12], numbers, 1)
    with pytest.raises(ValueError, match="poses"):
        planes.find(places, np.zeros(12), 1)
