"""The 3D scene of a replay: one animated node per joint, meshes fixed under it, ground and traces."""

from __future__ import annotations

import re
from collections.abc import Sequence

import meshcat
import numpy as np
import pinocchio as pin
from meshcat.animation import Animation, AnimationClip
from meshcat.path import Path as NodePath
from trimesh import creation

from robotraj._util.arrays import Array
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.replay_page.clearance import clearance_scene
from robotraj.replay_page.colors import rgb
from robotraj.replay_page.contacts import contact_scene
from robotraj.replay_page.footholds import contact_frames
from robotraj.replay_page.scene.ground import GroundView, ground_of
from robotraj.replay_page.scene.hull import hull_of, stature_of
from robotraj.replay_page.scene.motion import SceneMotion, centre_of_mass, keys, motion_of
from robotraj.replay_page.scene.obstacles import draw_obstacles, surroundings
from robotraj.replay_page.scene.part import Color, weld
from robotraj.replay_page.scene.shapes import shape_part, tube
from robotraj.replay_page.scene.visuals import Visual, visuals_of
from robotraj.replay_page.scene.window import PackedTrack, RecordingWindow, draw
from robotraj.robot.collision.robot_spheres import robot_spheres
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of
from robotraj.solution.cycles.gait_cycles import GaitCycles

GROUND_COLOR = (0.80, 0.82, 0.78, 1.0)
WALL_COLOR = (0.80, 0.82, 0.78, 0.4)
"""A wall may stand between the camera and the robot."""
STILL = 1e-9
"""Change of a pose [m, and unitless quaternion] below which a joint has no track."""
COLLISION_COLOR: Color = (0.84, 0.37, 0.0, 0.35)
SPHERES_COLOR: Color = (0.35, 0.20, 0.75, 0.22)
MOST_TRIANGLES = 1500
"""Largest number of triangles of a drawn collision mesh; vertices of a larger one are merged in cells."""


def scenes_of(
    robots: Sequence[Robot | None], cycles: Sequence[GaitCycles], fps: int, traces: Sequence[str] | None
) -> tuple[list[dict[str, object] | None], bytes]:
    """Record the motions of several solutions as meshcat commands.

    Parameters
    ----------
    robots : sequence of Robot or None
        None for a system, which has no scene.
    cycles : sequence of GaitCycles
    fps : int
        Animation keys per second; more are added where the motion is curved.
    traces : sequence of str or None
        Frames whose path is drawn. By default those of the contacts, or without contacts the tip of the longest chain.

    Returns
    -------
    scenes : list of dict or None
        For the page's script: node path of each joint, outermost points, ground, traces, centre of mass, contacts.
    commands : bytes
        The commands, gzip.
    """
    window = RecordingWindow()
    animation = Animation(default_framerate=fps)
    start = min(own.phases[0].t0 for own in cycles)
    scenes: list[dict[str, object] | None] = []
    for k, (robot, own) in enumerate(zip(robots, cycles, strict=True)):
        tint = k if len(robots) > 1 else None
        root = f"solution {k + 1}"
        scene = None if robot is None else _scene(window, animation, root, robot, own, fps, traces, start, tint)
        scenes.append(scene)
    window.send(meshcat.commands.SetAnimation(animation, play=False, repetitions=1))
    return scenes, window.packed()


def _scene(
    window: RecordingWindow,
    animation: Animation,
    root: str,
    robot: Robot,
    cycles: GaitCycles,
    fps: int,
    traces: Sequence[str] | None,
    start: float,
    tint: int | None,
) -> dict[str, object]:
    """Record one solution below the node ``root``.

    Frames of the animation count from ``start`` [s]. ``tint`` is the number of the colour of its traces, if they have
    one.
    """
    model = robot.model
    feet = list(contact_frames(cycles).values())
    names = (feet or [tip_frame(model)]) if traces is None else list(traces)
    frames = [robot.frame(name) for name in names]
    motion = motion_of(model, cycles, fps)
    visuals = visuals_of(model, robot.visual_model)
    viewer = meshcat.Visualizer(window=window)[root]
    paths = joint_paths(model)
    for joint in range(1, model.njoints):
        viewer[paths[joint]].set_transform(_matrix(motion.position[0, joint], motion.quaternion[0, joint]))
    _draw_shapes(viewer, paths, "visual", visuals)
    _draw_shapes(viewer, paths, "collision", collision_shapes(robot.collision_model))
    _draw_shapes(viewer, paths, "spheres", collision_spheres(robot, cycles))
    hull = hull_of(visuals, motion.world)
    low, high = hull.min(axis=0), hull.max(axis=0)
    ground = ground_of(cycles, low, high)
    if ground.surface is not None:
        draw(viewer["ground"], ground.surface, GROUND_COLOR, shininess=0.0)
    for number, wall in enumerate(ground.walls):
        draw(viewer["walls"][str(number)], wall, WALL_COLOR, shininess=0.0)
    size = float(np.linalg.norm(high - low))
    # A contact's trace has the contact's colour, and one of several solutions has the solution's.
    colors = [feet.index(name) if name in feet else len(feet) + k for k, name in enumerate(names)]
    if tint is not None:
        colors = [tint] * len(names)
    pairs = zip(frames, colors, strict=True)
    drawn = [_trace(viewer, root, motion, model.frames[frame], k, rgb(c), size) for k, (frame, c) in enumerate(pairs)]
    clips = _clips(motion, paths, fps, start) | draw_obstacles(viewer, robot, cycles, paths, motion.times, fps, start)
    animation.clips |= {NodePath(("meshcat", root)).append(path): clip for path, clip in clips.items()}
    stature = stature_of(visuals, motion.world[0])
    return _description(model, root, motion, paths, hull, ground, drawn) | {
        "body": root_of(robot.root).joints[-1] if robot.root != "fixed" else None,
        "stature": round(stature, 4),
        "surroundings": np.round(surroundings(robot, cycles, motion.world, motion.times, low, high), 4).tolist(),
        "center": centre_of_mass(model, motion),
        "contacts": contact_scene(cycles, robot, stature),
        "clearance": clearance_scene(cycles),
    }


def _draw_shapes(viewer: meshcat.Visualizer, paths: list[str], kind: str, shapes: Sequence[Visual]) -> None:
    for number, shape in enumerate(shapes):
        node = viewer[f"{paths[shape.joint]}/{kind} {number} {_safe(shape.name)}"]
        node.set_transform(shape.placement)
        for k, (part, color) in enumerate(shape.parts):
            draw(node[f"part {k}"], part, color)


def joint_paths(model: pin.Model) -> list[str]:
    """Path of each joint's node below the solution's, parents before children; entry 0 is the world's."""
    paths = ["robot"]
    for joint in range(1, model.njoints):
        paths.append(f"{paths[model.parents[joint]]}/{joint} {_safe(model.names[joint])}")
    return paths


def tip_frame(model: pin.Model) -> str:
    """Last frame of the joint with the longest chain of joints behind it."""
    depth = [0] * model.njoints
    for joint in range(1, model.njoints):
        depth[joint] = depth[model.parents[joint]] + 1
    last = max(range(model.njoints), key=lambda joint: (depth[joint], joint))
    names = [frame.name for frame in model.frames if frame.parentJoint == last]
    return str(names[-1])


def _description(
    model: pin.Model,
    root: str,
    motion: SceneMotion,
    paths: list[str],
    hull: Array,
    ground: GroundView,
    traces: Sequence[object],
) -> dict[str, object]:
    return {
        "root": ["meshcat", root],
        "joints": {model.names[j]: f"meshcat/{root}/{paths[j]}".split("/") for j in range(1, model.njoints)},
        "hull": np.round(hull, 4).tolist(),
        "ground": {"level": ground.level, "surface": ground.surface is not None},
        "traces": [trace for trace in traces if trace is not None],
    }


def _safe(name: str) -> str:
    """Keep a name to one node: the slash separates nodes."""
    return re.sub(r"[/<>]", "_", name)


def _matrix(position: Array, quaternion: Array) -> Array:
    return np.asarray(pin.XYZQUATToSE3(np.concatenate([position, quaternion])).homogeneous)


def _clips(motion: SceneMotion, paths: list[str], fps: int, start: float) -> dict[str, AnimationClip]:
    """Return one clip for each joint that moves, with tracks of its position and orientation if they change."""
    clips = {}
    frames = (motion.times - start) * fps
    for joint in range(1, len(paths)):
        position, quaternion = motion.position[:, joint], motion.quaternion[:, joint]
        chosen = keys(position, quaternion)
        clip = AnimationClip(fps=fps)
        for name, kind, values in (
            ("position", "vector3", position),
            ("quaternion", "quaternion", quaternion),
        ):
            if np.ptp(values, axis=0).max() > STILL:
                clip.tracks[name] = PackedTrack(name, kind, frames[chosen], values[chosen])
        if clip.tracks:
            clips[paths[joint]] = clip
    return clips


def _trace(
    viewer: meshcat.Visualizer,
    root: str,
    motion: SceneMotion,
    frame: pin.Frame,
    number: int,
    color: tuple[float, float, float],
    size: float,
) -> dict[str, object] | None:
    """Draw a frame's path as a thin tube; None if the frame does not move."""
    world = motion.world[:, frame.parentJoint]
    points = world[:, :3, :3] @ np.array(frame.placement.translation) + world[:, :3, 3]
    spacing, kept = 2e-3 * size, [0]
    for k in range(1, len(points)):
        if np.linalg.norm(points[k] - points[kept[-1]]) > spacing:
            kept.append(k)
    if len(kept) < 3:
        return None
    part = tube(points[kept], 1.6e-3 * size)
    path = f"traces/{number} {_safe(frame.name)}"
    draw(viewer[path]["ahead"], part, (*color, 0.22), shininess=0.0)
    draw(viewer[path]["past"], part, (*color, 1.0), shininess=0.0)
    times = [float(f"{t:.7g}") for t in motion.times[kept]]
    return {
        "frame": frame.name,
        "path": f"meshcat/{root}/{path}/past".split("/"),
        "times": times,
        "color": [round(255 * c) for c in color],
    }


def collision_shapes(geometry: pin.GeometryModel | None) -> tuple[Visual, ...]:
    """Return the shapes that Pinocchio's collision model has, each fixed to its joint; unknown kinds are left out."""
    found = []
    for thing in geometry.geometryObjects if geometry is not None else ():
        placement = np.array(thing.placement.homogeneous)
        try:
            part = shape_part(thing.geometry, MOST_TRIANGLES)
        except LookupError:
            continue
        if part is not None:
            found.append(Visual(int(thing.parentJoint), str(thing.name), placement, ((part, COLLISION_COLOR),)))
    return tuple(found)


def collision_spheres(robot: Robot, cycles: GaitCycles) -> tuple[Visual, ...]:
    """Return a visual of the spheres of each link; none where no phase imposes ``CollisionFree``."""
    every = [constraint for result in cycles.phases for constraint in result.phase.constraints]
    if not any(isinstance(constraint, CollisionFree) for constraint in every):
        return ()
    spheres, ball = robot_spheres(robot), creation.icosphere(subdivisions=2)
    found = []
    for number, link in enumerate(spheres.links):
        own = np.flatnonzero(spheres.link == number)
        vertices = np.concatenate([spheres.centre[i] + spheres.radius[i] * ball.vertices for i in own])
        faces = np.concatenate([k * len(ball.vertices) + ball.faces for k in range(len(own))])
        part = weld(vertices, faces)
        if part is not None:
            found.append(Visual(int(spheres.joint[own[0]]), link, np.eye(4), ((part, SPHERES_COLOR),)))
    return tuple(found)
