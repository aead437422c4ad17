"""A value of a file equals the value that a script makes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt

PHASE = """
[robot]
source = "ur5"

[define]
ball = { type = "Sphere", radius = 0.1, position = [0.9, 0, 0.5] }
box = { z = { between = [-1, 1] } }

[[phases]]
duration = 1.0
start = { q = 0, v = 0 }
end = { q = 0.1, v = 0 }
"""

FIELDS = [
    ("objective", '"Effort"', rt.Effort()),
    ("objective", '[{ type = "Effort", weight = 2 }, "Duration"]', 2 * rt.Effort() + rt.Duration()),
    ("objective", '{ type = "Effort", weights = { elbow_joint = 2.0 } }', rt.Effort({"elbow_joint": 2.0})),
    ("duration", "[0.5, inf]", [0.5, np.inf]),
    ("duration", "{ between = [1.0, 3] }", rt.between(1.0, 3)),
    ("limits", '"none"', None),
    ("dynamics", '"ForwardDynamics"', rt.dynamics.ForwardDynamics()),
    ("end", "{ q = { elbow_joint = { between = [0, 1] } } }", rt.State(q={"elbow_joint": rt.between(0, 1)})),
    ("end", '{ q = ["none", 0, 0, 0, 0, 0.5], v = "none" }', rt.State(q=[None, 0, 0, 0, 0, 0.5])),
    ("parameters", "{ mass = { between = [1, 2] }, k = 3.0 }", {"mass": rt.between(1, 2), "k": 3.0}),
    (
        "constraints",
        '[{ type = "AtEnd", constraint = { type = "FramePosition", frame = "tool0", position = "box" } }]',
        (rt.AtEnd(rt.FramePosition("tool0", {"z": rt.between(-1, 1)})),),
    ),
    (
        "constraints",
        '[{ type = "GroundClearance", frames = [["tool0", [0, 0, 0.1]], "wrist_1_link"], height = -1.0 }]',
        (rt.GroundClearance([["tool0", [0, 0, 0.1]], "wrist_1_link"], -1.0),),
    ),
    (
        "constraints",
        '[{ type = "CollisionFree", obstacles = ["ball"], self_collision = false }]',
        (rt.CollisionFree([rt.obstacles.Sphere(0.1, [0.9, 0, 0.5])], self_collision=False),),
    ),
    (
        "constraints",
        '[{ type = "JointVelocity", bounds = { elbow_joint = { between = [-1, 1] } } }]',
        (rt.constraints.JointVelocity({"elbow_joint": rt.between(-1, 1)}),),
    ),
]


def load(text: str, folder: Path) -> rt.applications.ProblemFile:
    (folder / "problem.toml").write_text(text)
    return rt.load_problem(folder / "problem.toml")


@pytest.mark.parametrize(("field", "text", "value"), FIELDS, ids=[f"{field} {text}"[:70] for field, text, _ in FIELDS])
def test_a_field_of_a_phase(field: str, text: str, value: object, tmp_path: Path) -> None:
    lines = [line for line in PHASE.splitlines() if not line.startswith(f"{field} =")]
    phase = load("\n".join([*lines, f"{field} = {text}"]), tmp_path).problem.phases[0]
    found = getattr(phase, field)
    assert repr(found) == repr(value) and type(found) is type(value)


def test_limits_of_a_phase_are_changes_of_the_robots(tmp_path: Path) -> None:
    phase = load(f"{PHASE}limits = {{ velocity = 1.5, effort = {{ elbow_joint = inf }} }}", tmp_path).problem.phases[0]
    limits = phase.robot.limits.with_(velocity=1.5, effort={"elbow_joint": np.inf})
    np.testing.assert_array_equal(phase.limits.velocity, limits.velocity)
    np.testing.assert_array_equal(phase.limits.effort, limits.effort)


def test_options_of_the_plan(tmp_path: Path) -> None:
    text = """
[plan]
mesh = [{ intervals = 5, scheme = { type = "LobattoIIIA", points = 4 } }]
solver = { type = "Ipopt", tolerance = 1e-9 }
goals = { error = 1e-5 }
restarts = { count = 0 }
interval_limits = "BernsteinBounds"
[plan.guess]
type = "Keyframes"
fractions = [0, 1]
states = [{ q = 0, v = 0 }, { q = 1, v = 0 }]
[validate]
drift = "none"
"""
    file = load(PHASE + text, tmp_path)
    assert dict(file.options) == {
        "mesh": [rt.Mesh(5, rt.schemes.LobattoIIIA(points=4))],
        "solver": rt.Ipopt(tolerance=1e-9),
        "goals": rt.solution.Goals(error=1e-5),
        "restarts": rt.planning.Restarts(count=0),
        "interval_limits": rt.interval_limits.BernsteinBounds(),
        "guess": rt.guess.Keyframes([0, 1], [rt.State(q=0, v=0), rt.State(q=1, v=0)]),
    }
    assert dict(file.validation) == {"drift": None}


def test_robots_are_joined_and_carry_bodies(tmp_path: Path) -> None:
    text = """
[robots.arm]
source = "two_link_arm"
payload = [{ frame = "tip", mass = 0.5 }]
[robots.pair]
type = "join"
robots = { left = "arm", right = "arm" }
at = { right = [[2.5, 0, 0], [0, 0, 1, 0]] }
[[phases]]
robot = "pair"
duration = 1.0
"""
    robot = load(text, tmp_path).problem.phases[0].robot
    arm = rt.robot.carrying(rt.load("two_link_arm"), rt.robot.CarriedBody("tip", 0.5))
    expected = rt.robot.join({"left": arm, "right": arm}, at={"right": ((2.5, 0, 0), (0, 0, 1, 0))})
    assert robot.joint_names == expected.joint_names and robot.mass == expected.mass
    assert robot.model.inertias[1] == expected.model.inertias[1]


def test_an_earlier_solution_is_a_guess_named_from_the_folder_of_the_file(tmp_path: Path) -> None:
    block = PHASE.replace('"ur5"', '"block"').replace("0.1, v", "1.0, v").replace("duration = 1.0", "duration = 4.0")
    first = load(f"{block}[plan]\nmesh = {{ intervals = 5 }}\n", tmp_path).plan()
    first.save(tmp_path / "first.npz")
    guess = load(f'{block}[plan]\nguess = "first.npz"\n', tmp_path).options["guess"]
    assert guess.objective == first.objective


def test_postures_and_objectives_of_gaits_get_the_robot(tmp_path: Path) -> None:
    text = """
[robot]
source = "solo12"
root = "floating"
[define]
standing = { type = "stand" }
foot = { type = "PointContact", frame = "FL_FOOT", friction = 0.5 }
[gait]
type = "trot"
step_length = 0.06
duration = 0.2
contact = { type = "PointContact", friction = 0.5, cone = { type = "Linearised", faces = 4 } }
objective = [
  { type = "gait_objective", standing = "standing" },
  { type = "Lagrange", weight = 1e-5, expression = { type = "SquaredAccelerations", first = 6 } },
]
repeat = "Periodic"
"""
    problem = load(text, tmp_path).problem
    robot = rt.load("solo12", root="floating")
    standing = rt.gait.stand(robot)
    terms = problem.phases[0].objective.terms
    expected = rt.gait.gait_objective(robot, standing).terms
    assert [str(term) for _, term in terms[:-1]] == [str(term) for _, term in expected]
    assert terms[-1][0] == 1e-5 and len(problem.phases) == 2
    assert isinstance(problem.phases[0].contacts[0].cone, rt.contacts.Linearised)
    copied = load(text.replace("contact = { type", 'contact = "foot" #'), tmp_path).problem
    assert copied.phases[0].contacts[0].friction == 0.5


def test_a_file_is_frozen_and_prints_its_problem(tmp_path: Path) -> None:
    file = load(PHASE, tmp_path)
    assert str(file) == str(file.problem) and repr(file).startswith("ProblemFile(")
    with pytest.raises(AttributeError):
        file.problem = None  # type: ignore[misc]
