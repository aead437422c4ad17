"""Obstacles in millimetres and quaternions with w first are warned of, and plausible ones are not."""

import warnings

import numpy as np
import pytest

import robotraj as rt

Q = [0.0, -1.2, 1.4, -1.6, -1.5, 0.0]
C, S = np.cos(np.pi / 12), np.sin(np.pi / 12)
box = rt.obstacles.Box


def phase(*obstacles: rt.obstacles.Obstacle) -> rt.Phase:
    away = rt.State(q=[2.5, *Q[1:]], v=0)
    free = rt.CollisionFree(obstacles, self_collision=False)
    return rt.Phase(rt.load("ur5"), 1.0, rt.State(v=0), away, rt.Effort(), constraints=[free], name="reach")


@pytest.mark.parametrize(
    ("obstacle", "message"),
    [
        (box((100, 50, 200), position=(600, 0, 300), name="part"), "reach'.*'part' is 5.* m away.*500 mm are 0.5 m"),
        (rt.obstacles.Sphere(0.05, position=(600, 0, 300)), "'sphere' is 670.* m away"),
        (rt.obstacles.Sphere(60, position=(600, 0, 300), frame="tool0"), "'sphere' is 6.* m away"),
        (rt.obstacles.HalfSpace((0, 0, 1), -300.0), "'half space' is 300.* m away"),
    ],
)
def test_lengths_in_millimetres_are_warned_of(obstacle, message):
    with pytest.warns(UserWarning, match=message) as caught:
        phase(obstacle)
    assert len(caught) == 1


def test_a_shape_that_swallows_the_robot_is_warned_of_before_it_is_refused():
    with (
        pytest.warns(UserWarning, match="solid for 250 m around its centre"),
        pytest.raises(rt.InputError, match="overlap by 250 m"),
    ):
        phase(box((500, 500, 500), position=(0.1, 0, 0.2)))


def test_one_warning_names_how_many_obstacles_are_doubtful():
    far = [rt.obstacles.Sphere(50, position=(700, y, 300)) for y in (0, 200, 400)]
    with pytest.warns(UserWarning, match="and 2 more") as caught:
        phase(*far)
    assert len(caught) == 1


@pytest.mark.parametrize(
    ("quaternion", "turn"),
    [
        ((C, 0, 0, S), "about z by 30"),
        ((C, 0, 0, -S), "about z by 30"),
        ((C, S, 0, 0), "about x"),
        ((C, 0, S, 0), "about y"),
    ],
)
@pytest.mark.parametrize(
    "shape", [lambda **k: box((0.1, 0.2, 0.3), **k), lambda **k: rt.obstacles.Capsule(0.05, 0.2, **k)]
)
def test_w_first_is_warned_of(shape, quaternion, turn):
    with pytest.warns(UserWarning, match=f"{turn}.*put w last") as caught:
        phase(shape(position=(-0.6, 0, 0.4), quaternion=quaternion))
    assert len(caught) == 1


@pytest.mark.parametrize(
    "obstacle",
    [
        box((100, 100, 0.1), position=(0, 0, -0.5), name="floor of a hall"),
        box((4, 0.1, 3), position=(0, 5, 1.5), name="wall"),
        box((10, 10, 10), position=(0, 0, -5.5), name="ground"),
        rt.obstacles.HalfSpace((0, 0, 1), -0.5),
        box((0.1, 0.2, 0.3), position=(-0.6, 0, 0.4), quaternion=(1, 0, 0, 0), name="half turn of a symmetric shape"),
        box((0.1, 0.2, 0.3), position=(-0.6, 0, 0.4), quaternion=(0, 0, S, C), name="turn about z"),
        box((0.1, 0.2, 0.3), position=(-0.6, 0, 0.4), quaternion=(S, 0, 0, C), name="ramp"),
        box((0.1, 0.2, 0.3), position=(-0.6, 0, 0.4), quaternion=(np.sqrt(0.5), 0, 0, np.sqrt(0.5)), name="lying"),
        box((0.1, 0.2, 0.3), position=(-0.6, 0, 0.4), quaternion=(0.8, 0.4, 0.4, 0.2), name="from a camera"),
        rt.obstacles.Sphere(0.1, position=(-0.6, 0, 0.4), quaternion=(C, 0, 0, S)),
    ],
    ids=lambda obstacle: obstacle.label,
)
def test_plausible_obstacles_are_not_warned_of(obstacle):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        phase(obstacle)


def test_a_robot_that_drives_may_meet_distant_obstacles():
    hall = rt.robot.on_wheels(rt.load("ur5"), mass=50.0, inertia=2.0)
    free = rt.CollisionFree([rt.obstacles.Box((1, 1, 1), position=(80, 0, 0))], self_collision=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rt.Phase(hall, 1.0, rt.State(v=0), None, rt.Effort(), constraints=[free])


def test_a_margin_beyond_the_robot_is_doubted():
    far = rt.obstacles.Sphere(0.1, position=(0, 0, 20))
    with pytest.warns(UserWarning, match="the margin of CollisionFree is 10 m.* 10 mm are 0.01 m"):
        rt.Phase(rt.load("ur5"), 1.0, constraints=[rt.CollisionFree([far], margin=10, self_collision=False)])


def test_pairs_of_another_robot_are_doubted():
    def free(*pairs):
        return rt.Phase(rt.load("ur5"), 1.0, constraints=[rt.CollisionFree(srdf=pairs)])

    with pytest.warns(UserWarning, match="srdf= names no link of 'ur5'.* It names foo, bar; the links are world"):
        free(("foo", "bar"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        free(("foo", "bar"), ("forearm_link", "wrist_2_link"))
