"""Spheres among shapes: distances in closed form, motions that are proved free, and paths."""

import numpy as np
import pytest

from robotraj.native.build import load_native

SphereTree = load_native().SphereTree

BOX, CYLINDER, CAPSULE, HALF_SPACE, MESH = 1, 2, 3, 4, 5
REACH = 0.05


def integers(*values):
    return np.array(values, dtype=np.int64)


def tree_of(lengths, shapes=(), corners=(), slides=False):
    """Arms in the plane: joints about z with links along x, or one body that slides along x, y and z."""
    count = 3 if slides else len(lengths)
    joints = []
    for i in range(count):
        axis = np.eye(3)[i] if slides else (0, 0, 1)
        offset = (lengths[i - 1], 0, 0) if i and not slides else (0, 0, 0)
        joints.append([*axis, *np.eye(3).ravel(), *offset])
    groups = [count - 1] if slides else list(range(count))
    centres = [(0.0,)] if slides else [np.linspace(0.0, length, 6) for length in lengths]
    spheres = [(x, 0, 0, REACH) for line in centres for x in line]
    group_of = [g for g, line in enumerate(centres) for _ in line]
    pairs = [] if slides else [(a, b) for a in groups for b in groups if b > a + 1]
    numbers = [
        [*np.ravel(rotation), *position, *size, *[0] * (4 - len(size))] for _, rotation, position, size in shapes
    ]
    return SphereTree(
        integers(*range(-1, count - 1)),
        integers(*[0 if slides else 1] * count),
        np.array(joints, dtype=float).ravel(),
        integers(*groups),
        integers(*group_of),
        np.array(spheres, dtype=float).ravel(),
        np.array(pairs, dtype=np.int64).ravel(),
        integers(*[shape[0] for shape in shapes]),
        np.array(numbers, dtype=float).ravel(),
        integers(*[len(corners) if shape[0] == MESH else 0 for shape in shapes]),
        np.array(corners, dtype=float).ravel(),
    )


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


CUBE = [
    [[(1, 1, 1), (1, -1, -1), (1, 1, -1)], [(1, 1, 1), (1, -1, 1), (1, -1, -1)]],
    [[(-1, 1, 1), (-1, 1, -1), (-1, -1, -1)], [(-1, 1, 1), (-1, -1, -1), (-1, -1, 1)]],
]
CUBE = np.array([t for face in CUBE for t in face], dtype=float)
CUBE = np.concatenate([CUBE, np.roll(CUBE, 1, axis=2), np.roll(CUBE, 2, axis=2)])


@pytest.mark.parametrize(
    ("kind", "size", "point", "distance"),
    [
        (BOX, (1, 2, 3), (2, 0, 4), np.sqrt(2)),
        (BOX, (1, 2, 3), (0.5, 0, 0), -0.5),
        (CYLINDER, (1, 2), (4, 0, 6), 5.0),
        (CYLINDER, (1, 2), (0, 0.8, 0), -0.2),
        (CAPSULE, (1, 2), (0, 3, 6), 4.0),
        (CAPSULE, (1, 2), (0, 3, 1), 2.0),
        (HALF_SPACE, (0, 0.6, 0.8, 1), (5, 3, 4), 4.0),
        (MESH, (0,), (2, 2, 2), np.sqrt(3)),
        (MESH, (0,), (0.5, 0, 3), 2.0),
        (MESH, (0,), (0.2, 0.9, 0), -0.1),
        (0, (2,), (3, 4, 0), 3.0),
    ],
)
def test_distances_of_closed_form(kind, size, point, distance):
    rotation, position = turned(0.7), np.array([0.3, -0.2, 0.5])
    tree = tree_of((), [(kind, rotation, position, size)], CUBE, slides=True)
    found = tree.clearances(rotation @ np.array(point, dtype=float) + position)
    np.testing.assert_allclose(found, distance - REACH, atol=1e-12)


def scene():
    """An arm of four links among three shapes."""
    shapes = [
        (BOX, turned(0.3), (0.6, 0.55, 0.0), (0.1, 0.15, 0.2)),
        (0, np.eye(3), (-0.7, 0.5, 0.05), (0.15,)),
        (CAPSULE, turned(1.0), (0.1, -0.8, 0.0), (0.1, 0.2)),
    ]
    return tree_of((0.4, 0.35, 0.3, 0.25), shapes)


def test_motions_that_are_proved_free_are_free_and_others_come_near():
    rng, tree, proved = np.random.default_rng(1), scene(), 0
    resolution = 1e-3
    for _ in range(300):
        a = rng.uniform(-2, 2, 4)
        b = a + rng.uniform(-1, 1, 4)
        least = tree.clearances((a + np.linspace(0, 1, 1001)[:, None] * (b - a)).ravel()).min()
        free = tree.motion_free(a, b, 0.0, resolution)
        assert least > 0.0 if free else least < resolution + 2e-3
        proved += free
    assert 50 < proved < 250


def test_rrt_connect_finds_a_free_path_that_shortcuts_shorten():
    tree, speeds, bound = scene(), np.ones(4), np.full(4, 2.8)
    start, goal = np.array([-0.3, 0, 0, 0.0]), np.array([1.9, 0, 0, 0.0])
    assert not tree.motion_free(start, goal, 0.0, 1e-3)

    def found(seed, shortcuts=0):
        return tree.connect(start, goal, -bound, bound, speeds, 0.5, seed, 20000, 60.0, shortcuts, 0.0, 1e-3)

    raw = found(3)
    np.testing.assert_array_equal(raw, found(3))
    assert not np.array_equal(raw, found(4))
    path = found(3, 200)
    for points in (raw.reshape(-1, 4), path.reshape(-1, 4)):
        np.testing.assert_array_equal(points[[0, -1]], [start, goal])
        assert all(tree.motion_free(a, b, 0.0, 1e-4) for a, b in zip(points[:-1], points[1:], strict=True))
    length = [np.linalg.norm(np.diff(p.reshape(-1, 4), axis=0), axis=1).sum() for p in (raw, path)]
    assert length[1] < 0.9 * length[0]


def test_no_path_where_the_goal_is_enclosed():
    wall = (BOX, np.eye(3), (0.0, 0.0, 0.0), (0.02, 5.0, 5.0))
    tree = tree_of((), [wall], slides=True)
    bound = np.ones(3)
    start, goal = np.array([-0.5, 0, 0]), np.array([0.5, 0, 0])
    assert tree.connect(start, goal, -bound, bound, bound, 0.3, 0, 500, 60.0, 0, 0.0, 1e-3).size == 0
    assert tree.connect(start, goal, -6 * bound, 6 * bound, bound, 2.0, 0, 5000, 60.0, 0, 0.0, 1e-3).size > 0


def test_wrong_arrays_are_refused():
    none = np.zeros(0)
    with pytest.raises(ValueError, match="numbers of the joints"):
        SphereTree(integers(-1), integers(1), none, *[integers()] * 2, none, *[integers()] * 2, none, integers(), none)


BALL = (0, np.eye(3), (3.0, 0.0, 0.0), (0.5,))


def test_arrays_that_do_not_fit_are_refused():
    """Each of these once read memory outside an array, or never returned."""
    one = tree_of([1.0], [BALL])
    with pytest.raises(ValueError, match="every sphere needs its group"):
        SphereTree(
            integers(-1),
            integers(1),
            np.array([0, 0, 1, *np.eye(3).ravel(), 0, 0, 0.0]),
            integers(0),
            integers(0),
            np.ones(8),
            *(integers(), integers(), np.zeros(0), integers(), np.zeros(0)),
        )
    # Six spheres and one shape: the second index is that of a shape for the first `against` pairs alone.
    assert one.distances(np.zeros(1), integers(0), integers(5), 0).size == 1
    for second, against in ((5, 1), (6, 0), (-1, 0), (1, 7)):
        with pytest.raises(ValueError, match="out of range"):
            one.distances(np.zeros(1), integers(0), integers(second), against)
    for counts in (integers(2**62), integers(-1), integers(1, 1, 1)):
        with pytest.raises(ValueError, match="more coefficients than there are"):
            one.shortfalls(np.zeros(2), counts, 0.0)
    with pytest.raises(ValueError, match="not finite"):
        one.shortfalls(np.array([0.0, np.nan]), integers(2), 0.0)
    assert not one.motion_free(np.zeros(1), np.array([np.nan]), 0.0, 1e-3)
    with pytest.raises(ValueError, match="unknown kind"):
        tree_of([1.0], [(6, np.eye(3), (3, 0, 0), (0.5,))])


@pytest.mark.parametrize("resolution", [0.0, -1.0, np.nan, 5e-324])
def test_a_motion_that_touches_ends_at_any_resolution(resolution):
    """The tip is at x = 1 + REACH at the middle of the motion, and the ball begins there."""
    touching = tree_of([1.0], [(0, np.eye(3), (1.0 + REACH + 0.5, 0.0, 0.0), (0.5,))])
    assert not touching.motion_free(np.array([-1.0]), np.array([1.0]), 0.0, resolution)
    assert touching.motion_free(np.array([1.0]), np.array([2.0]), 0.0, max(resolution, 1e-6))


def test_a_range_that_is_lost_in_rounding_ends():
    walled = tree_of([1.0], [(1, np.eye(3), (1.0, 0.0, 0.0), (0.2, 0.2, 0.2))])
    ends = np.array([-1.5]), np.array([1.5]), np.array([-2.0]), np.array([2.0]), np.ones(1)
    with pytest.raises(ValueError, match="the range is not positive"):
        walled.connect(*ends, 0.0, 0, 50, 5.0, 5, 0.0, 1e-3)
    assert walled.connect(*ends, 1e-300, 0, 50, 5.0, 5, 0.0, 1e-3).size == 0
