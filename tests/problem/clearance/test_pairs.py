"""Pairs of shapes: their distances, names, bounds on their rates, and what is refused before planning."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

Q = np.random.default_rng(0).uniform(-1.5, 1.5, size=(20, 6))


@pytest.fixture(scope="module")
def arm() -> rt.Robot:
    return rt.load("ur5")


def obstacles() -> list[rt.obstacles.Obstacle]:
    return [
        rt.obstacles.Box((0.2, 0.3, 0.4), (0.6, 0.1, 0.3), name="crate"),
        rt.obstacles.Sphere(0.1, lambda t: (0.5 - t, 0.4, 0.6)),
        rt.obstacles.Cylinder(0.05, 0.4, (-0.4, 0.2, 0.5), (0.5, 0.5, 0.5, 0.5)),
    ]


def test_distances_of_all_pairs_are_those_of_single_pairs(arm: rt.Robot) -> None:
    pairs = rt.CollisionFree(obstacles()).pairs(arm)
    times = np.linspace(0, 1, len(Q))
    every = pairs.distances(Q, times)
    chosen = np.random.default_rng(1).integers(len(pairs), size=len(Q))
    np.testing.assert_allclose(pairs.distances_of(chosen, Q, times), every[np.arange(len(Q)), chosen], atol=1e-12)


def test_the_base_is_a_pair_with_obstacles_that_move_only(arm: rt.Robot) -> None:
    pairs = rt.CollisionFree(obstacles(), self_collision=False).pairs(arm)
    beside_base = {pairs.names(pair)[1] for pair in range(len(pairs)) if pairs.names(pair)[0] == "base_link"}
    assert beside_base == {"sphere"}
    assert {pairs.names(pair)[1] for pair in range(len(pairs))} == {"crate", "sphere", "cylinder"}


def test_no_distance_changes_faster_than_its_bound(arm: rt.Robot) -> None:
    pairs = rt.CollisionFree([obstacles()[0], obstacles()[2]]).pairs(arm)
    rng, step = np.random.default_rng(2), 1e-6
    q, v = rng.uniform(-3, 3, size=(300, 6)), rng.normal(size=(300, 6))
    still = np.zeros(300)
    rates = np.abs(pairs.distances(q + step * v, still) - pairs.distances(q - step * v, still)) / (2 * step)
    bounds = np.abs(v) @ pairs.speed_factors.T
    assert (rates <= bounds + 1e-6).all()
    assert np.max(rates / bounds) > 0.5  # the bound is within a factor of two of a motion


def test_speeds_of_moving_obstacles_are_bounded() -> None:
    import casadi as ca

    box = rt.obstacles.Box((0.2, 0.2, 0.2), lambda t: (ca.sin(3 * t), t**2, 0), lambda t: (0, 0, ca.sin(t), ca.cos(t)))
    breaks = np.linspace(0, 2, 9)
    bounds = box.speed_bounds(breaks)
    corner = np.array([0.1, 0.1, 0.1])
    for k, bound in enumerate(bounds):
        times = np.linspace(breaks[k], breaks[k + 1], 200)
        positions, rotations = box.poses(times)
        speeds = np.linalg.norm(np.diff(positions + rotations @ corner, axis=0), axis=1) / (times[1] - times[0])
        assert speeds.max() <= bound <= 2.0 * speeds.max() + 1.0
    with pytest.raises(rt.InputError, match="bounded"):
        rt.obstacles.Sphere(1.0, lambda t: (ca.sinh(t), 0, 0)).speed_bounds(breaks)


def test_an_obstacle_on_a_frame_belongs_to_the_robot(arm: rt.Robot) -> None:
    held = rt.obstacles.Box((0.05, 0.05, 0.05), (0, 0, 0.05), frame="tool0", name="held")
    pairs = rt.CollisionFree([obstacles()[0], held]).pairs(arm)
    names = {pairs.names(pair) for pair in range(len(pairs))}
    assert ("held", "crate") in names
    others = {name for pair in names if "held" in pair for name in pair} - {"held", "crate"}
    assert "base_link" in others and not others & {"ee_link", "wrist_3_link", "wrist_2_link"}
    with pytest.raises(rt.InputError, match="unbounded"):
        rt.CollisionFree([rt.obstacles.HalfSpace((0, 0, 1), frame="tool0")]).pairs(arm)


def test_ends_in_collision_are_refused_by_name(arm: rt.Robot) -> None:
    def phase(box: rt.obstacles.Box) -> rt.Phase:
        ends = (rt.State(q=[0, -1.5, 1, -1, -1.5, 0], v=0), rt.State(q=[1, -1.5, 1, -1, -1.5, 0], v=0))
        free = rt.CollisionFree([box], self_collision=False)
        return rt.Phase(arm, 1.0, *ends, constraints=[free], name="reach")

    with pytest.raises(rt.InputError, match=r"'reach': at the start upper_arm_link and wall overlap"):
        phase(rt.obstacles.Box((0.1, 0.5, 0.5), (-0.1, 0, 0.3), name="wall"))
    far = phase(rt.obstacles.Box((0.1, 0.1, 0.1), (0, 0, 3.0), name="lamp"))
    assert "links and lamp" in str(far)


def test_what_is_no_obstacle_or_robot_is_refused(arm: rt.Robot) -> None:
    for make in (
        lambda: rt.CollisionFree(["box"]),
        lambda: rt.CollisionFree(margin=-0.1),
        lambda: rt.CollisionFree(srdf=[("a",)]),
        lambda: rt.CollisionFree().pairs(rt.load("two_link_arm")) and rt.CollisionFree(srdf="missing.srdf"),
    ):
        with pytest.raises(rt.InputError):
            make()
    slider = rt.System(states=["x"], controls=["u"], dynamics=lambda point: [point.u["u"]])
    with pytest.raises(rt.InputError, match="needs a robot"):
        rt.Phase(slider, 1.0, constraints=[rt.CollisionFree()])


def test_links_that_are_always_nearer_than_a_margin_need_not_keep_it() -> None:
    """The flange of a ur3 is 7 mm from its second wrist at all angles: a margin of 1 cm is about all other pairs."""
    arm = rt.load("ur3")
    touching, apart = (rt.CollisionFree(margin=margin).pairs(arm) for margin in (0.0, 0.01))
    near = {frozenset(touching.names(k)) for k in range(len(touching))} - {
        frozenset(apart.names(k)) for k in range(len(apart))
    }
    assert near == {frozenset(("wrist_2_link", "ee_link"))}
    home, away = np.array([0.0, -1.2, 1.4, -1.5, -1.57, 0.0]), np.array([1.0, -0.9, 1.0, -1.0, -1.2, 0.5])
    ends = rt.State(q=home, v=0), rt.State(q=away, v=0)
    plan = rt.plan(rt.Phase(arm, (0.1, 10), *ends, rt.Duration(), [rt.CollisionFree(margin=0.01)]))
    assert plan.proof.holds and rt.validate(plan).passed
