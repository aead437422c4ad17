"""Problems without a solution, each with what a correct answer names: the row, the joint, sometimes the time."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
from motions import ENDS, LOCKED

import robotraj as rt


@dataclass(frozen=True)
class Infeasible:
    """A problem without a solution.

    Attributes
    ----------
    build : callable
        Returns the problem; may raise the error itself.
    names : tuple of str
        Words of the row and the joint that the first cause must contain; alternatives are separated by "|".
    needed : (float, float) or None
        Interval of the value that suffices, if the answer must give one.
    """

    build: Callable[[], rt.Phase | rt.Problem]
    names: tuple[str, ...]
    needed: tuple[float, float] | None = None


def reach(
    name: str, duration: object = 2.0, objective: rt.objectives.Objective | None = None, **more: object
) -> rt.Phase:
    """Move an arm between the configurations of the proven motions; ``limits`` are replaced by quantity."""
    start, end = ENDS[name]
    robot = rt.load(name, locked=LOCKED.get(name))
    limits = robot.limits.with_(**more.pop("limits", {}))
    fields = {"start": rt.State(q=start, v=0), "end": rt.State(q=end, v=0), "limits": limits, "name": name}
    return rt.Phase(robot, duration, objective=objective or rt.Effort(), **(fields | more))


def to_place(name: str, frame: str, place: Sequence[float], duration: object = 2.0, **more: object) -> rt.Phase:
    """Move a frame of an arm to a place."""
    rows = [rt.AtEnd(rt.FramePosition(frame, place)), *more.pop("constraints", [])]
    return reach(name, duration, end=rt.State(v=0), constraints=rows, **more)


def to_pose(name: str, frame: str, q: Sequence[float], turn: float, **more: object) -> rt.Phase:
    """Move a frame of an arm to the pose that it has at q, turned about the vertical."""
    robot = rt.load(name, locked=LOCKED.get(name))
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, np.array(q, dtype=float))
    pose = data.oMf[robot.frame(frame)]
    rotation = pin.AngleAxis(turn, np.array([0.0, 0.0, 1.0])).toRotationMatrix() @ pose.rotation
    row = rt.AtEnd(rt.FramePose(frame, (pose.translation, rotation)))
    return reach(name, 2.0, end=rt.State(v=0), constraints=[row], **more)


def block(duration: object = (0.1, 20.0), **more: object) -> rt.Phase:
    """Push a mass of 1 kg along a line by at most 1 N."""
    dynamics = more.pop("dynamics", lambda point: [point.x["v"], point.u["u"]])
    system = rt.System(["x", "v"], ["u"], dynamics, name="block")
    fields = {
        "start": rt.State([0, 0]),
        "end": rt.State([1, 0]),
        "objective": rt.Duration(),
        "controls": {"u": rt.between(-1, 1)},
    }
    return rt.Phase(system, duration, **(fields | more))


def swing(name: str, start: Sequence[float], end: Sequence[float], duration: object, **more: object) -> rt.Phase:
    """Move a small robot from rest to rest."""
    robot = rt.load(name)
    limits = robot.limits.with_(**more.pop("limits", {}))
    ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
    return rt.Phase(robot, duration, *ends, more.pop("objective", rt.Effort()), limits=limits, **more)


def three_moves() -> rt.Problem:
    """Move in three phases of 1 s at most 1 m/s: the end of the last one, 4 m away, is too far."""

    def part(name: str, **ends: rt.State) -> rt.Phase:
        free = {"start": None, "end": None, "objective": None, "controls": {}}
        return block(1.0, states={"v": rt.between(-1, 1)}, name=name, **(free | ends))

    parts = [part("go", start=rt.State([0, 0])), part("on", start=None), part("stop", end=rt.State([4, 0]))]
    return rt.Problem(parts, [rt.Continuity(0, 1), rt.Continuity(1, 2)])


def fixed_apart() -> rt.Problem:
    """End the first phase at 1 m; after a rest, the third one must start at 3 m."""
    free = {"objective": None, "controls": {}}
    parts = [
        block(1.0, name="go", **free),
        block(1.0, name="rest", start=None, end=None, states={"v": 0.0}, **free),
        block(1.0, name="back", start=rt.State({"x": 3.0}), end=rt.State([0, 0]), **free),
    ]
    return rt.Problem(parts, [rt.Continuity(0, 1), rt.Continuity(1, 2)])


def arm_in_two_phases() -> rt.Problem:
    """Give the elbow less speed than the end of the second phase needs."""
    robot = rt.load("ur5")
    start, end = ENDS["ur5"]
    first = rt.Phase(robot, 1.0, rt.State(q=start, v=0), rt.State(v=0), rt.Effort(), name="first")
    slow = robot.limits.with_(velocity={"elbow_joint": 0.5})
    second = rt.Phase(robot, 1.0, rt.State(), rt.State(q=end, v=0), rt.Effort(), limits=slow, name="second")
    first = first.with_(limits=slow)
    return rt.Problem([first, second], [rt.Continuity(0, 1)])


def mirrored_knees() -> rt.Problem:
    """Mirror a step whose mirror image needs the right knee where its limit forbids it."""
    robot = rt.load("five_link", root="planar")
    problem = rt.gait.walk(robot, step_length=0.5, duration=0.7, clearance=0.05)
    limits = robot.limits.with_(position={"left_knee": (0.6, 0.9), "right_knee": (0.1, 0.3)})
    return rt.Problem([phase.with_(limits=limits) for phase in problem.phases], problem.links)


def long_step() -> rt.Problem:
    """Step over 2 m with legs that are 0.8 m long."""
    return rt.gait.walk(rt.load("five_link", root="planar"), step_length=2.0, duration=0.7, clearance=0.05)


def far_foothold() -> rt.Problem:
    """Put a foot on a foothold out of reach, and back again."""
    robot = rt.load("solo12", root="floating")
    feet = tuple(n for n in rt.gait.limb_ends(robot) if n.endswith("FOOT"))
    home = rt.gait.stand(robot, feet)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, home)
    at = {f: data.oMf[robot.frame(f)].translation[:2] for f in feet}
    far = {feet[0]: tuple(at[feet[0]] + [0.9, 0.0])}
    return rt.gait.steps(robot, [far, {feet[0]: tuple(at[feet[0]])}], feet=feet)


def weak_legs() -> rt.Phase:
    """Stand on motors too weak for the robot's weight."""
    robot = rt.load("solo12", root="floating")
    feet = tuple(n for n in rt.gait.limb_ends(robot) if n.endswith("FOOT"))
    q = rt.gait.stand(robot, feet)
    limits = robot.limits.with_(effort=0.1)
    rest = rt.State(q=q, v=0)
    contacts = [rt.PointContact(f, friction=0.7) for f in feet]
    return rt.Phase(robot, 0.5, rest, rest, rt.Effort(), contacts=contacts, limits=limits, name="stand")


def steep_trot() -> rt.Problem:
    """Trot up a slope that is steeper than the friction of the feet."""
    contact = partial(rt.PointContact, friction=0.3)
    ground = rt.terrain.Slope(0.6)
    robot = rt.load("solo12", root="floating")
    return rt.gait.trot(robot, step_length=0.05, duration=0.2, contact=contact, ground=ground)


FOLDER = tempfile.TemporaryDirectory()
"""Where URDFs are written; it is removed when the process ends."""

URDF = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 0.25"/><mass value="{upper}"/>
    <inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower">{lower}</link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="{effort}" velocity="5"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="20" velocity="5"/></joint>
</robot>"""
LOWER = """<inertial><origin xyz="0 0 0.2"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>"""


def own_arm(**numbers: object) -> rt.Phase:
    """Move an arm whose URDF is written above."""
    path = Path(FOLDER.name) / "arm.urdf"
    path.write_text(URDF.format(**({"upper": 1.0, "i": 0.01, "lower": LOWER, "effort": 40} | numbers)))
    return rt.Phase(rt.load(path), 1.0, rt.State(q=0, v=0), rt.State(q=[1, 0.5], v=0), rt.Effort())


def speed_at_rest(point: object) -> ca.SX:
    """Return the length of v, whose derivative does not exist at rest."""
    return ca.norm_2(point.v)


FAST = rt.PathConstraint(lambda p: p.x["v"], lower=0.8, name="fast", unit="m/s")
SLOW = rt.PathConstraint(lambda p: p.x["v"], upper=0.5, name="slow", unit="m/s")

PROBLEMS: Mapping[str, Infeasible] = {
    # poses out of reach
    "ur5, place too far": Infeasible(lambda: to_place("ur5", "tool0", [1.5, 0, 0.3]), ("frame position", "tool0")),
    "panda, place too high": Infeasible(
        lambda: to_place("panda", "panda_hand_tcp", [0.2, 0.0, 1.7]), ("frame position", "panda_hand_tcp")
    ),
    "kinova, place too far": Infeasible(
        lambda: to_place("kinova", "j2s6s200_end_effector", [0.9, 0.9, 0.6]),
        ("frame position", "j2s6s200_end_effector"),
    ),
    "z1, place behind its limit": Infeasible(
        lambda: to_place("z1", "gripperMover", [-0.5, 0.0, 0.1], limits={"position": {"joint1": (-1.5, 1.5)}}),
        ("gripperMover", "position limit, joint"),
    ),
    "ur10, pose with a locked wrist": Infeasible(
        lambda: to_pose(
            "ur10",
            "tool0",
            ENDS["ur10"][1],
            0.5,
            limits={"position": {"wrist_3_joint": (-0.1, 1.3), "wrist_2_joint": (-1.6, -0.55)}},
        ),
        ("tool0", "frame"),
    ),
    "xarm7, place within the reach of no elbow": Infeasible(
        lambda: to_place(
            "xarm7",
            "link_eef",
            [0.9, 0.0, 0.3],
            start=rt.State(q=[0, -0.5, 0, 1.4, 0, 1.2, 0], v=0),
            limits={"position": {"joint4": (1.3, 3.9)}},
        ),
        ("link_eef", "position limit, joint4|frame position"),
    ),
    # torques that cannot hold an end
    "ur5, weak shoulder": Infeasible(
        lambda: reach("ur5", limits={"effort": {"shoulder_lift_joint": 20.0}}),
        ("shoulder_lift_joint", "effort|torque|N m"),
        (40.0, 60.0),
    ),
    "ur10, weak elbow": Infeasible(
        lambda: reach("ur10", 4.0, limits={"effort": {"elbow_joint": 5.0, "shoulder_lift_joint": 200.0}}),
        ("elbow_joint", "effort|N m"),
        (16.0, 80.0),
    ),
    "panda, weak joint 2, least time": Infeasible(
        lambda: reach("panda", (0.1, 2.0), rt.Duration(), limits={"effort": {"panda_joint2": 5.0}}),
        ("panda_joint2", "effort|N m"),
        (16.0, 60.0),
    ),
    "xarm7, weak joint 4": Infeasible(
        lambda: reach("xarm7", 1.0, limits={"effort": {"joint4": 2.0}}), ("joint4", "effort|N m"), (3.1, 20.0)
    ),
    "kinova, weak joint 2": Infeasible(
        lambda: reach("kinova", 4.0, limits={"effort": {"j2s6s200_joint_2": 5.0}}),
        ("j2s6s200_joint_2", "effort|N m"),
        (5.1, 30.0),
    ),
    "z1, weak joint 2": Infeasible(
        lambda: reach("z1", 1.0, limits={"effort": {"joint2": 1.0}}), ("joint2", "effort|N m"), (3.1, 20.0)
    ),
    "pendulum, weak motor, short": Infeasible(
        lambda: swing("pendulum", [0], [np.pi], 0.8, limits={"effort": 1.0}), ("pivot", "effort|N m"), (1.1, 20.0)
    ),
    "solo12, weak motors": Infeasible(weak_legs, ("HFE|KFE|HAA", "effort"), (0.101, 2.0)),
    # durations below speed and acceleration bounds
    "ur3, speed": Infeasible(lambda: reach("ur3", 0.8), ("shoulder_pan_joint", "velocity", "1.0")),
    "ur3, acceleration": Infeasible(
        lambda: reach("ur3", 1.5, limits={"acceleration": 2.0}), ("shoulder_pan_joint", "acceleration"), (4.4, 4.6)
    ),
    "panda, acceleration, free time": Infeasible(
        lambda: reach("panda", (0.1, 1.0), rt.Duration(), limits={"acceleration": {"panda_joint1": 3.0}}),
        ("panda_joint1", "acceleration"),
    ),
    "ur5, jerk": Infeasible(
        lambda: reach("ur5", 1.0, constraints=[rt.constraints.JointJerk(rt.between(-10, 10))]),
        ("shoulder_pan_joint", "jerk limit"),
    ),
    "panda, torque rate": Infeasible(
        lambda: reach("panda", 1.5, constraints=[rt.constraints.JointTorqueRate(rt.between(-5, 5))]),
        ("panda_joint", "torque rate limit"),
    ),
    "panda, slow tool": Infeasible(
        lambda: reach("panda", 1.5, constraints=[rt.constraints.FrameSpeed("panda_hand_tcp", linear=0.1)]),
        ("linear speed", "panda_hand_tcp", "m/s"),
    ),
    "ur5, place too soon": Infeasible(
        lambda: to_place(
            "ur5", "tool0", [0.4, -0.5, 0.4], 0.4, start=rt.State(q=[-2.6, -1.8, 1.6, -1.2, -1.57, 0], v=0)
        ),
        ("duration|velocity|effort",),
    ),
    "block, 10 m in 3 s": Infeasible(lambda: block((0.1, 3.0), end=rt.State([10, 0])), ("u|duration",)),
    "cart-pole, 0.6 s": Infeasible(
        lambda: swing("cartpole", [0, 0], [1, np.pi], 0.6), ("slider", "effort"), (21.0, 500.0)
    ),
    "ur5, too late to brake": Infeasible(
        lambda: reach(
            "ur5",
            start=rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=[0, 0, 2.0, 0, 0, 0]),
            limits={"position": {"elbow_joint": (-1.7, 1.7)}, "acceleration": 5.0},
        ),
        ("elbow_joint", "position|acceleration"),
    ),
    # models
    "moving link without mass": Infeasible(lambda: own_arm(lower=""), ("elbow", "mass|inertia")),
    "1000 N m on 2 kg": Infeasible(lambda: own_arm(effort=1000), ("shoulder", "1000", "Implausible")),
    # mirrors, footholds and fixed ends phases later
    "five_link, mirrored knees": Infeasible(mirrored_knees, ("knee", "position limit", "Touchdown|mirror")),
    "five_link, step of 2 m": Infeasible(long_step, ("foot", "step_length", "would do")),
    "solo12, slope without friction": Infeasible(steep_trot, ("friction", "slope"), (0.59, 0.7)),
    "solo12, foothold out of reach": Infeasible(far_foothold, ("FL_FOOT", "step 1", "would do")),
    "three phases, end too far": Infeasible(three_moves, ("v", "state bound"), (1.3, 2.5)),
    "phases fixed apart": Infeasible(fixed_apart, ("state bound, v", "phase 'rest'")),
    "ur5, end a phase later": Infeasible(arm_in_two_phases, ("elbow_joint", "velocity"), (0.51, 1.0)),
    # path constraints and clearance
    "fast and slow": Infeasible(
        lambda: block(start=None, end=rt.State({"x": 1}), constraints=[FAST, SLOW]), ("fast|slow",)
    ),
    "ur5, end below its clearance": Infeasible(
        lambda: to_place("ur5", "tool0", [0.5, 0.2, 0.1], constraints=[rt.GroundClearance("tool0", 0.25)]),
        ("ground clearance", "tool0"),
    ),
    "pendulum, through the ground": Infeasible(
        lambda: swing(
            "pendulum",
            [2.0],
            [-2.0],
            2.0,
            limits={"position": 2.5},
            constraints=[rt.GroundClearance("tip", 0.3)],
        ),
        ("clearance", "tip"),
    ),
    "two_link_arm, tip kept away": Infeasible(
        lambda: swing(
            "two_link_arm",
            [0.5, 0.2],
            [-0.5, -0.2],
            3.0,
            constraints=[
                rt.PathConstraint(lambda p: p.frame("tip").position[0], upper=0.05, name="keep away", unit="m")
            ],
        ),
        ("keep away",),
    ),
    # NaN
    "NaN at the start, objective": Infeasible(
        lambda: block(objective=rt.Lagrange(lambda p: ca.sqrt(p.x["x"] - 0.5))),
        ("objective", "sqrt(-0.5)", "t = 0 s, where x = 0"),
    ),
    "NaN at rest, derivative": Infeasible(
        lambda: reach("ur5", objective=rt.Lagrange(speed_at_rest)), ("objective", "derivative", "t = 0 s")
    ),
    "NaN in a constraint": Infeasible(
        lambda: block(
            constraints=[rt.PathConstraint(lambda p: ca.log(p.x["x"] + 0.1 * p.u["u"]), upper=1.0, name="height")]
        ),
        ("height", "log(0)", "t = 0 s"),
    ),
    "NaN in a Mayer term": Infeasible(
        lambda: block(objective=rt.Duration() + rt.Mayer(lambda a, b: ca.sqrt(a.x["x"] - b.x["x"]))),
        ("Mayer|objective", "sqrt"),
    ),
    "NaN in the equations": Infeasible(
        lambda: block(dynamics=lambda p: [p.x["v"], p.u["u"] / p.x["x"]]), ("rate of 'v'", "t = 0 s", "0 / 0")
    ),
}
"""Problems by name; each is written out when it is called."""
