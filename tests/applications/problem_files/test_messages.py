"""A fault of a problem file is reported with its line, its key and near names."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import pytest

import robotraj as rt

EXAMPLES = Path(__file__).parents[3] / "examples"

UR5 = (EXAMPLES / "05_ur5.toml").read_text()
PICK = (EXAMPLES / "23_pick_and_place.toml").read_text()
WALK = (EXAMPLES / "11_five_link_walking.toml").read_text()

FAULTS = [
    (UR5, 'source = "ur5"', 'source = "ur55"', "robot.source", "There is no robot named 'ur55'. Did you mean 'ur5'"),
    (UR5, "source =", "sorce =", "robot.sorce", "There is no key of load named 'sorce'. Did you mean 'source'"),
    (UR5, "[robot]", "[robto]", "robto", "There is no table named 'robto'. Did you mean 'robot'"),
    (UR5, "-0.6, 1.2], v", "-0.6], v", "phases[0].end.q", "The end position has 5 values; it needs 6"),
    (UR5, "1.2], v = 0 }", "99], v = 0 }", "phases[0].end.q", "outside its position limit"),
    (UR5, '"tool0"]\nheight', '"tool1"]\nheight', "phases[0].constraints[0].frames[2]", "Did you mean 'tool0'"),
    (UR5, '"GroundClearance"', '"GroundClearence"', "phases[0].constraints[0].type", "Did you mean 'GroundClearance'"),
    (UR5, "height =", "hight =", "phases[0].constraints[0].hight", "Did you mean 'height'"),
    (UR5, "height = 0.05", 'height = "high"', "phases[0].constraints[0].height", "the height is high"),
    (UR5, "duration = 1.0", "duration = -1.0", "phases[0].duration", "give seconds above 0"),
    (UR5, "duration = 1.0", "", "phases[0]", "Phase lacks 'duration'"),
    (UR5, '"Effort"', '"Efort"', "phases[0].objective", "Did you mean 'Effort'"),
    (UR5, '"Effort"', '[{ type = "Effort", weight = "a" }]', "phases[0].objective[0].weight", "a finite number"),
    (UR5, '"Effort"', '{ type = "Effort", weights = { elbow = 1 } }', "phases[0].objective.weights.elbow", "elbow_jo"),
    (UR5, "intervals = 50", "intervals = 50.5", "plan.mesh.intervals", "takes a whole number or a list of numbers"),
    (UR5, "intervals = 50", "intervals = 0", "plan.mesh.intervals", "a whole number from 1"),
    (UR5, '"HermiteSimpson"', '"Hermite"', "plan.mesh.scheme", "Did you mean 'HermiteSimpson'"),
    (UR5, "[plan]", '[plan]\ntolerance = "small"', "plan.tolerance", "takes a number or 'none'; got 'small'"),
    (UR5, "[plan]", "[plan]\ncheck = false", "plan.check", "There is no key of plan named 'check'"),
    (
        UR5,
        "objective",
        "limits = { velocity = { elbow = 2.0 } }\nobjective",
        "phases[0].limits.velocity.elbow",
        "elbow_",
    ),
    (UR5, "end = { q", "end = { w", "phases[0].end.w", "There is no key of State named 'w'"),
    (UR5, "q = [1.1, -0.8", "q = [nan, -0.8", "phases[0].end.q", "is NaN"),
    (UR5, "q = [1.1,", "q = [{ between = [2, 1] },", "phases[0].end.q[0].between", "the lower bound lies above"),
    (UR5, "q = [1.1,", "q = [{ between = 2 },", "phases[0].end.q[0].between", "takes [lower, upper]; got 2"),
    (UR5, "[[phases.constraints]]", "[phases.constraints]", "phases[0].constraints", "takes a list of Constraint"),
    (UR5, "html =", "htm =", "output.htm", "Did you mean 'html'"),
    (UR5, "traces =", "trace =", "replay.trace", "Did you mean 'traces'"),
    (UR5, 'traces = ["tool0"', 'traces = ["tool1"', "replay.traces[0]", "Did you mean 'tool0'"),
    (UR5, "traces =", "fps = 0\ntraces =", "replay.fps", "must be a whole number"),
    (UR5, 'name = "ur5', 'robot = "x"\nname = "ur5', "phases[0].robot", "There is no robot named 'x'"),
    (PICK, '["post"]', '["psot"]', "define.clear.obstacles[0]", "Did you mean 'post'"),
    (PICK, "second = 2", "second = 7", "links[1]", "the problem has phases 0 to 2"),
    (PICK, "mass = 2.0", "mass = -2.0", "robots.loaded.payload[0].mass", "it must be finite and above 0"),
    (PICK, '"loaded"', '"laoded"', "phases[1].robot", "Did you mean 'loaded'"),
    (PICK, 'robot = "loaded"', "", "phases[1]", "names its robot: robot = one of 'empty', 'loaded'"),
    (PICK, 'frame = "tool0", mass', 'frame = "tool7", mass', "robots.loaded.payload[0].frame", "Did you mean 'tool0'"),
    (PICK, "sides = [0.1, 0.1, 0.3]", "sides = [0.1, 0.1]", "define.post.sides", "give 3 finite numbers"),
    (WALK, '"walk"', '"wlak"', "gait.type", "Did you mean 'walk'"),
    (WALK, "clearance = 0.0", "clearance = -1.0", "gait.clearance", "give metres from 0 on"),
    (WALK, "clearance = 0.0", "double_support = 2.0", "gait.double_support", "from 0 to less than 1"),
    (WALK, "friction = 2.0", "friction = -2.0", "gait.contact.friction", "give a positive number"),
    (WALK, "clearance = 0.0", 'feet = ["a", "left_foot"]', "gait.feet[0]", "There is no frame named 'a'"),
]


def message_of(text: str, folder: Path) -> str:
    path = folder / "problem.toml"
    path.write_text(text)
    with pytest.raises(rt.InputError) as caught:
        rt.load_problem(path)
    return str(caught.value)


@pytest.mark.parametrize(("text", "old", "new", "key", "message"), FAULTS, ids=[f"{f[3]} {f[2]}" for f in FAULTS])
def test_a_fault_is_reported_with_line_and_key(
    text: str, old: str, new: str, key: str, message: str, tmp_path: Path
) -> None:
    assert old in text
    wrong = text.replace(old, new, 1)
    found = message_of(wrong, tmp_path)
    match = re.match(r"problem\.toml, line (\d+), (.*?): (.*)", found, re.DOTALL)
    assert match and match[2] == key, found
    assert message in match[3]
    line = wrong.splitlines()[int(match[1]) - 1]
    # The reported line is that of the change, or the header of the table that lacks a key.
    last = re.sub(r"\[\d+\]$", "", key).rpartition(".")[2]
    assert last in line or (new and new.splitlines()[-1] in line), line


def test_an_unknown_joint_is_found_at_its_own_end_beside_near_names_of_the_other(tmp_path: Path) -> None:
    start, end = (
        "shoulder_pan_joint = 0.0, shoulder_lift_joint = 0.0",
        "shoulder_pan_joint = 1, shoulder_lift_jiont = 1",
    )
    text = UR5.replace("[-1.1, -1.8, 1.6, -1.2, -1.57, 0]", f"{{ {start} }}")
    text = text.replace("[1.1, -0.8, 0.6, -0.6, -0.6, 1.2]", f"{{ {end} }}")
    assert start in text and end in text
    found = message_of(text, tmp_path)
    assert ", phases[0].end.q.shoulder_lift_jiont: There is no joint named 'shoulder_lift_jiont'" in found


def test_a_file_that_is_no_toml_is_reported_with_its_line(tmp_path: Path) -> None:
    assert message_of(UR5.replace("[[phases]]", "[[phases"), tmp_path).startswith(
        "problem.toml, line 6: this is no TOML"
    )


def test_values_of_other_languages_are_named(tmp_path: Path) -> None:
    true = message_of(UR5.replace("drift = 1e-3", "drift = None"), tmp_path)
    assert true.endswith(' TOML writes true and false in small letters; None is "none" in a problem file.')
    lines = message_of(UR5.replace("drift = 1e-3", "drift = { a = 1,\n b = 2 }"), tmp_path)
    assert lines.endswith(" A table in braces stands in one line.")


def test_a_file_without_a_robot_or_a_motion_says_what_is_missing(tmp_path: Path) -> None:
    assert "names no robot: add [robot]" in message_of("[plan]\n", tmp_path)
    assert "states no motion: add [[phases]]" in message_of('[robot]\nsource = "block"\n', tmp_path)
    assert "line 5, gait: a problem has either [[phases]] or a [gait]" in message_of(
        '[robot]\nsource = "block"\n[[phases]]\nduration = 1.0\n[gait]\ntype = "walk"\n', tmp_path
    )


def test_a_time_limit_of_no_time_is_found_in_its_line(tmp_path: Path) -> None:
    found = message_of(UR5.replace("[plan]", "[plan]\ntime_limit = -5"), tmp_path)
    assert "plan.time_limit: time_limit must be a number above 0 s" in found


def test_a_file_of_another_encoding_is_reported_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "problem.toml").write_bytes('[robot]\nsource = "größe.urdf"\n'.encode("latin-1"))
    with pytest.raises(rt.InputError, match=r"problem\.toml, line 2: this is no UTF-8 text"):
        rt.load_problem(tmp_path / "problem.toml")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match=r"none\.toml' does not exist"):
        rt.load_problem(tmp_path / "none.toml")


@pytest.mark.parametrize(
    "solver",
    ['{ type = "Ipopt", options = { hsllib = "x.so" } }', '{ type = "Compiled", compiler = "sh" }'],
)
def test_a_file_runs_no_command_and_loads_no_library(solver: str, tmp_path: Path) -> None:
    key = "engine" if "Compiled" in solver else "solver"
    assert f"plan.{key}" in message_of(UR5.replace("[plan]", f"[plan]\n{key} = {solver}"), tmp_path)


@pytest.mark.parametrize("value", ["3", '{ type = "Box", sides = [1, 1, 1] }'])
@pytest.mark.parametrize("guess", ['type = "Perturbed", seed = 1, guess', 'type = "GeometricPath", planner'])
def test_a_part_of_a_guess_has_the_kind_that_its_class_states(guess: str, value: str, tmp_path: Path) -> None:
    message = message_of(UR5.replace("[plan]", f"[plan]\nguess = {{ {guess} = {value} }}"), tmp_path)
    assert "plan.guess." in message and "takes " in message


@pytest.mark.parametrize(
    ("added", "message"),
    [
        ("x = " + "9" * 5000, "no TOML"),
        ("x = " + "9" * 30, "whole number is above"),
        ("x = " + "[" * 5000 + "]" * 5000, "nested more than|no TOML"),
        ("x = " + "[" * 40 + "]" * 40, "nested more than 32 deep"),
        ("x = [" + "1, " * 200_000 + "]", "more than 100000 values"),
        ('x = "' + "y" * 5000 + '"', "5000 letters"),
        ('x = "a\\u001b[2J"', "control characters"),
        ("#" * 3_000_000, "3.0 MB, above 2.0 MB"),
        ('[define]\na = "b"\nb = "a"\n', "is defined by itself: a names b names a"),
        ('[define]\na = ["b", "b"]\nb = ["a", "a"]\n', "is defined by itself: a names b names a"),
        (
            "[define]\na = ["
            + '"a1", ' * 10
            + "]\n"
            + "".join(f"a{i} = [" + f'"a{i + 1}", ' * 10 + "]\n" for i in range(1, 9))
            + 'a9 = "Effort"\n',
            "more than 10000 times",
        ),
        ("[[phases]]\nduration = 1.0\n" * 300, "has 301 phases; a file has at most 200"),
        ("".join(f'[robots.r{i}]\nsource = "ur5"\n' for i in range(300)), "has 301 robots; a file has at most 50"),
        ("[plan]\nmesh = { intervals = 100000 }", "mesh has 100000 intervals; a file has at most 5000"),
        ("x." + "a." * 20_000 + "b = 1", "line 1: a key has more than 32 parts"),
        ("x = { a" + ' . "a.b"' * 40 + " = 1 }", "line 1: a key has more than 32 parts"),
    ],
)
def test_a_file_is_bounded(added: str, message: str, tmp_path: Path) -> None:
    text = (
        '[robot]\nsource = "pendulum"\n[[phases]]\nduration = 1.0\nstart = { q = 0, v = 0 }\nend = { q = 1, v = 0 }\n'
    )
    text += "objective = " + repr("a" if "[define]" in added else "Effort") + "\n"
    path = tmp_path / "problem.toml"
    path.write_text(f"{added}\n{text}" if added.startswith("x") else f"{text}{added}\n")
    began = time.process_time()
    with pytest.raises(rt.InputError, match=message):
        rt.load_problem(path)
    assert time.process_time() - began < 8.0


def test_a_pipe_or_a_device_is_no_problem_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", Path("/dev/zero"), tmp_path, tmp_path / "missing.toml"):
        with pytest.raises(rt.InputError, match="The problem file"):
            rt.load_problem(path)
