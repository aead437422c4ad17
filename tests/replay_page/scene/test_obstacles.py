"""A replay shows the obstacles of a plan; those that move have tracks."""

from __future__ import annotations

import gzip
import re
from pathlib import Path

import numpy as np

import robotraj as rt


def planned() -> rt.Solution:
    robot = rt.load("ur5")
    obstacles = [
        rt.obstacles.Box((0.1, 0.1, 0.1), (0.5, 0.5, 1.2)),
        rt.obstacles.Sphere(0.1, lambda t: (0.6 - 0.1 * t, -0.5, 1.2)),
        rt.obstacles.Capsule(0.02, 0.05, (0, 0, 0.04), frame="tool0"),
    ]
    free = rt.CollisionFree(obstacles, self_collision=False)
    ends = rt.State(q=[0, -1.5, 1, -1, -1.5, 0], v=0), rt.State(q=[0.3, -1.5, 1, -1, -1.5, 0], v=0)
    return rt.plan(rt.Phase(robot, 1.0, *ends, rt.Effort(), constraints=[free]), mesh=rt.Mesh(6))


def test_obstacles_are_drawn_where_they_are() -> None:
    from robotraj.replay_page.scene.scene import scenes_of
    from robotraj.solution.cycles.gait_cycles import gait_cycles

    solution = planned()
    _, packed = scenes_of([solution.phases[0].phase.robot], [gait_cycles(solution, 1)], 30, None)
    commands = gzip.decompress(packed)
    for path in (b"obstacles/obstacle 0", b"obstacles/obstacle 1", b"obstacle 2"):
        assert path in commands
    # The one on the tool is below the tool's joint.
    assert b"wrist_3_joint/obstacle 2" in commands


def scene_of(obstacles: list, self_collision: bool = False) -> tuple[dict, bytes]:
    """Return the scene of a still arm among obstacles, and its commands."""
    from robotraj.replay_page.scene.scene import scenes_of
    from robotraj.solution.cycles.gait_cycles import gait_cycles

    robot = rt.load("ur5")
    ends = rt.State(q=[0, -1.5, 1, -1, -1.5, 0], v=0), rt.State(q=[0.3, -1.5, 1, -1, -1.5, 0], v=0)
    constraints = [rt.CollisionFree(obstacles, self_collision=self_collision)] if obstacles else []
    phase = rt.Phase(robot, 1.0, *ends, rt.Effort(), constraints, self_collision=False)
    (scene,), packed = scenes_of([robot], [gait_cycles(rt.plan(phase, mesh=rt.Mesh(3)), 1)], 30, None)
    assert scene is not None
    return scene, gzip.decompress(packed)


def test_the_camera_frames_obstacles_near_the_robot_alone() -> None:
    near, far = rt.obstacles.Box((0.2, 0.2, 0.2), (0.5, 0.5, 1.2)), rt.obstacles.Box((1, 1, 1), (30, 0, 0))
    scene, _ = scene_of([near, far, rt.obstacles.HalfSpace((0, 0, 1), -0.5)])
    points = np.array(scene["surroundings"])
    assert len(points) == 8
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], [[0.4, 0.4, 1.1], [0.6, 0.6, 1.3]], atol=1e-4)


def test_the_camera_cuts_off_what_reaches_far_away() -> None:
    scene, _ = scene_of([rt.obstacles.Box((40, 40, 0.1), (0, 0, -0.2))])
    hull, points = np.array(scene["hull"]), np.array(scene["surroundings"])
    size = np.linalg.norm(np.ptp(hull, axis=0))
    np.testing.assert_allclose(points[:, 0].max() - hull[:, 0].max(), 0.5 * size, atol=1e-3)


def test_the_spheres_that_messages_name_are_drawn_where_the_plan_avoids_collisions() -> None:
    _, without = scene_of([])
    _, among = scene_of([rt.obstacles.Box((0.2, 0.2, 0.2), (0.5, 0.9, 0.4))])
    assert b"/spheres " not in without
    assert all(re.search(rb"/spheres \d " + link, among) for link in (b"upper_arm_link", b"forearm_link"))


def test_a_plan_among_obstacles_is_saved_and_loaded(tmp_path: Path) -> None:
    robot = rt.load("ur5")
    mesh = rt.obstacles.ConvexMesh(np.random.default_rng(0).normal(size=(12, 3)) * 0.05, (0.5, 0.5, 1.2))
    free = rt.CollisionFree([rt.obstacles.Box((0.1, 0.1, 0.1), (0.5, 0.5, 1.2)), mesh], 0.01, srdf=[("a", "b")])
    ends = rt.State(q=[0, -1.5, 1, -1, -1.5, 0], v=0), rt.State(q=[0.3, -1.5, 1, -1, -1.5, 0], v=0)
    phase = rt.Phase(
        robot, 1.0, *ends, rt.Effort(), constraints=[free.__class__(free.obstacles, 0.01, False, free.srdf)]
    )
    rt.plan(phase, mesh=rt.Mesh(6)).save(tmp_path / "among.npz")
    again = rt.load_solution(tmp_path / "among.npz").phases[0].phase
    (kept,) = again.constraints
    assert kept.margin == 0.01 and kept.srdf == (("a", "b"),) and not kept.self_collision
    assert kept.obstacles[0] == free.obstacles[0]
    np.testing.assert_array_equal(kept.obstacles[1].vertices, mesh.vertices)
