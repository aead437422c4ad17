"""A first problem file of a robot, with comments: a motion from rest to rest, or the step of a gait."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.printing import plain
from robotraj.gait.feet import feet_of
from robotraj.gait.mirroring.foot_groups import foot_groups
from robotraj.gait.standing import stand
from robotraj.robot.robot import Robot

ASKED_LIMITS = "# limits = { velocity = 2.0 } # in place of the URDF's [rad/s, m/s]\n"
GIVEN_LIMITS = "\n[robot.limits] # the URDF's limits lock these joints; inf lifts a limit\n"
STRIDE = {"rad": 0.6, "m": 0.2}
"""Distance that a joint moves at most in the first motion, by its unit."""
TURNS = 2
"""Most of these distances that a joint moves to a side, for a start above the base."""
SHARE = 0.4
"""Largest part of the way to a limit that a joint moves."""
MUCH = 100.0
"""Room to a limit that counts as unlimited [rad, m]."""
PACE = 3.0
"""Duration of the first motion, relative to that at the velocity limits."""
LOAD = 0.8
"""Part of an effort limit that the first motion uses at most."""
LONGEST = 60.0
"""Duration that is not exceeded [s]."""
GAITS = {2: "walk", 4: "trot"}
"""Gait by the number of feet; others walk where their feet alternate, or jump on all of them."""
STEP = 0.2
"""Length of a step, and rise of a jump, relative to the height of the centre of mass."""

HEAD = """\
# A first motion of {robot}
#
# Plan it, prove it and write its replay:  robotraj plan {name}
# What else may stand here:                robotraj schema, or docs/problem-files.md

[robot]
source = {source} # a name that 'robotraj robots' lists, or the path of a URDF file
{root}# gravity = [0.0, 0.0, -9.81] # [m/s^2]
# Also: actuated and locked joints, a payload, the pose of the base.
{limits}"""

MOTION = """
[[phases]]
name = {label}
duration = {duration} # [s]; [{least}, {most}] leaves it free between these
objective = "Effort" # the integral of the squared torques
# objective = [{{ type = "Effort" }}, {{ type = "Duration", weight = 10.0 }}] # a weighted sum
# limits = {{ velocity = 2.0, effort = {{ {joint} = 50.0 }} }} # of this phase alone

[phases.start]
v = 0.0 # at rest

[phases.start.q] # [rad, m]; joints that are not named are free
{start}

[phases.end]
v = 0.0

[phases.end.q]
{end}

# What must hold throughout. AtStart and AtEnd hold a constraint at one end only.
# [[phases.constraints]]
# type = "FrameSpeed"
# frame = {frame}
# linear = 1.0 # [m/s]

# [[phases.constraints]]
# type = "CollisionFree"
# margin = 0.01 # [m]
# obstacles = [{{ type = "Box", sides = [0.1, 0.1, 0.1], position = [5.0, 5.0, 5.0] }}]

# A second phase begins with [[phases]]; it is joined to the first one by [[links]] of type "Continuity".
"""

STEPS = """\
step_length = {length} # [m]
duration = {duration} # [s] of a step
clearance = {clearance} # lift of a swinging foot [m]
"""

LEAP = """\
height = {length} # rise of the centre of mass [m]
length = 0.0 # displacement along x [m]
"""

GAIT = """
[gait]
type = {gait} # a function of rt.gait: walk, run, trot, crawl, jump, stairs ...
feet = [{feet}] # frames of the feet
{sizes}contact = {{ type = "PointContact", friction = 0.6 }} # FlatFoot for soles: length and width [m]
"""

TAIL = """
[plan]
# Left open, the mesh is refined until the motion is proved between its points.
# mesh = {{ intervals = 40, scheme = "HermiteSimpson" }} # this mesh, nothing proved
# tolerance = 1e-6 # of the error between the knots
time_limit = {limit} # processor seconds

[output]
html = {page} # the replay; save = "x.npz" keeps the solution, plot = "x.png" draws the curves
"""


def starter(
    robot: Robot,
    source: str,
    name: str = "problem.toml",
    package_dirs: Sequence[str] = (),
    trust_paths: bool = False,
) -> str:
    """Write a problem file that plans as it stands.

    A robot with a fixed root moves from rest to rest, from its neutral configuration to one nearby. Where the
    neutral one reaches below the base, it starts higher; joints move to the side on which the lowest link is higher.
    Joints without motors start at their neutral position and end anywhere. A robot with a moving root walks on two
    feet, trots on four, walks on six or more that alternate, and jumps on another number.

    Parameters
    ----------
    robot : Robot
    source : str
        Name or path that ``rt.load`` read, as the file will state it.
    name : str
        Name of the file, for its comments.
    package_dirs : sequence of str
    trust_paths : bool
        Options of ``rt.load`` for the meshes, as the file will state them.

    Raises
    ------
    InputError
        The root moves, and no frame is named like a foot.
    """
    fixed, locked = robot.root == "fixed", robot.limits.faults(robot.actuated)
    free = _lifted(robot, locked)
    robot = replace(robot, limits=robot.limits.override(free))
    limits = GIVEN_LIMITS + "".join(_limit(name, values) for name, values in free.items()) if locked else ASKED_LIMITS
    joint = _key(robot.joint_names[0])
    root = "" if fixed else f'root = "{robot.root}" # "fixed", "planar" or "floating"\n'
    root += f"package_dirs = {json.dumps(list(package_dirs))}\n" if package_dirs else ""
    root += "trust_paths = true\n" if trust_paths else ""
    head = HEAD.format(
        robot=plain(" ".join(robot.name.split())), name=name, source=json.dumps(source), root=root, limits=limits
    )
    middle = _motion(robot, joint) if fixed else _gait(robot)
    page = json.dumps(re.sub(r"\W+", "_", robot.name) + ".html")
    return head + middle + TAIL.format(limit=60.0 if fixed else 600.0, page=page)


def _lifted(robot: Robot, locked: Mapping[str, Mapping[str, str]]) -> dict[str, dict[str, float | list[float]]]:
    """Return limits in place of those that lock joints: half a turn or 1 m to both sides, and no others."""
    units = dict(zip(robot.velocity_names, robot.units, strict=True))
    free: dict[str, dict[str, float | list[float]]] = {}
    for joint, faults in locked.items():
        side = round(math.pi, 4) if units[joint] == "rad" else 1.0
        for quantity in faults:
            free.setdefault(quantity, {})[joint] = [-side, side] if quantity == "position" else math.inf
    return free


def _limit(quantity: str, values: Mapping[str, object]) -> str:
    """Write limits of one quantity; JSON has no infinity, and TOML writes it as inf."""
    pairs = ", ".join(f"{_key(joint)} = {str(value)}" for joint, value in values.items())
    return f"{quantity} = {{ {pairs} }}\n"


def _motion(robot: Robot, joint: str) -> str:
    names = robot.position_names
    driven = [i for i, each in enumerate(names) if each in robot.actuated]
    home = _home(robot, driven)
    end = _nearby(robot, home, driven)
    duration = math.ceil(10.0 * _duration(robot, home, end, driven)) / 10.0
    frame = robot.end_effector or robot.frame_names[-1]
    return MOTION.format(
        label=json.dumps(f"first motion of {robot.name}"),
        duration=duration,
        least=0.5 * duration,
        most=5.0 * duration,
        joint=joint,
        start=_pairs(names, home, range(len(names))),
        end=_pairs(names, end, driven),
        frame=json.dumps(frame),
    )


def _home(robot: Robot, driven: Sequence[int]) -> Array:
    """Return the neutral configuration, or one near it whose links stand higher where those reach below the base.

    Joints turn one after the other, each to the nearest of a few positions at which the lowest frame is highest.
    """
    q, limits, data = robot.neutral.copy(), robot.limits, robot.model.createData()
    if _lowest(robot, data, q) >= 0.0:
        return q
    for i in driven:
        stride = STRIDE.get(robot.units[i], STRIDE["m"])
        heights: list[tuple[float, float, float]] = []
        for k in range(-TURNS, TURNS + 1):
            there = q.copy()
            there[i] = np.clip(q[i] + k * stride, limits.position_lower[i], limits.position_upper[i])
            heights.append((round(_lowest(robot, data, there), 3), -abs(k), there[i]))
        q[i] = max(heights)[2]
    return q


def _lowest(robot: Robot, data: pin.Data, q: Array) -> float:
    """Return the height of the lowest frame that a joint moves, above the root link [m]."""
    pin.framesForwardKinematics(robot.model, data, q)
    return min(
        (float(data.oMf[i].translation[2]) for i, frame in enumerate(robot.model.frames) if frame.parentJoint > 0),
        default=0.0,
    )


def _nearby(robot: Robot, home: Array, driven: Sequence[int]) -> Array:
    """Return a configuration whose driven joints are moved, each to the side on which the lowest frame is higher.

    Where both sides are as high, a joint moves towards its farther limit. The strides are halved until the motors can
    hold the configuration.
    """
    limits, data = robot.limits, robot.model.createData()
    for halved in range(6):
        end = home.copy()
        for i in driven:
            up, down = limits.position_upper[i] - home[i], home[i] - limits.position_lower[i]
            stride = STRIDE.get(robot.units[i], STRIDE["m"]) / 2.0**halved
            sides: list[tuple[float, float, float]] = []
            for room, sign in ((up, 1.0), (down, -1.0)):
                there = end.copy()
                there[i] = round(home[i] + sign * min(stride, SHARE * room), 4)
                sides.append((round(_lowest(robot, data, there), 3), min(room, MUCH) + sign * 1e-6, there[i]))
            end[i] = max(sides)[2]
        held = pin.computeGeneralizedGravity(robot.model, data, end) + robot.resistance(end, np.zeros(robot.nv))
        if _can_push(robot, held, driven):
            break
    return end


def _duration(robot: Robot, home: Array, end: Array, moved: Sequence[int]) -> float:
    """Return a duration of at least 1 s in which a smooth motion stays well within the limits [s]."""
    way, speeds, data = end - home, robot.limits.sides("velocity"), robot.model.createData()
    duration = 1.0
    for i in moved:
        speed = float(speeds[1][i] if way[i] > 0.0 else -speeds[0][i])
        if 0.0 < speed < math.inf:
            duration = max(duration, PACE * abs(way[i]) / speed)
    while duration < LONGEST and not _within(robot, data, home, way, duration, moved):
        duration *= 1.25
    return duration


def _within(robot: Robot, data: pin.Data, home: Array, way: Array, duration: float, moved: Sequence[int]) -> bool:
    """Whether the motors can follow the path q0 + way (10 s^3 - 15 s^4 + 6 s^5), s = t / duration."""
    for s in np.linspace(0.0, 1.0, 21):
        place = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        rate = 30.0 * s**2 * (1.0 - s) ** 2 / duration
        second = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
        q, v = home + place * way, rate * way
        tau = pin.rnea(robot.model, data, q, v, second * way) + robot.resistance(q, np.zeros(robot.nv))
        tau = tau + robot.damping * v + robot.friction * np.sign(way)
        if not _can_push(robot, tau, moved):
            return False
    return True


def _can_push(robot: Robot, tau: Array, joints: Sequence[int]) -> bool:
    """Whether torques (nv,) of some joints are well within their limits; joints without an effort do not count."""
    lower, upper = robot.limits.sides("effort")
    return all(LOAD * lower[i] <= tau[i] <= LOAD * upper[i] for i in joints if lower[i] < upper[i])


def _gait(robot: Robot) -> str:
    feet = feet_of(robot, None)
    standing = stand(robot, feet)
    height = float(pin.centerOfMass(robot.model, robot.model.createData(), standing)[2])
    gait = GAITS.get(len(feet)) or ("walk" if foot_groups(robot, feet, None) else "jump")
    sizes = (LEAP if gait == "jump" else STEPS).format(
        length=round(STEP * height, 3),
        duration=round(1.3 * math.sqrt(height / 9.81), 2),
        clearance=round(0.1 * height, 3),
    )
    return GAIT.format(gait=json.dumps(gait), feet=", ".join(json.dumps(foot) for foot in feet), sizes=sizes)


def _pairs(names: tuple[str, ...], values: Array, chosen: list[int] | range) -> str:
    return "\n".join(f"{_key(names[i])} = {float(values[i]):.10g}" for i in chosen)


def _key(name: str) -> str:
    """Write a name as a TOML key."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name)
